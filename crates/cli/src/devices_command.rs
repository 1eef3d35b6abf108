//! `sunshine devices`: what can render here.

use render::{GpuInfo, automatic_gpu, list_gpus};
use std::fmt::Write;

/// Looks for devices and describes them.
pub fn run() -> String {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    listing(threads, &list_gpus())
}

fn listing(threads: usize, gpus: &[GpuInfo]) -> String {
    let automatic = automatic_gpu(gpus);
    let mut text = String::new();
    let mut row = |option: &str, what: &str, is_automatic: bool| {
        let mark = if is_automatic { "  <- auto" } else { "" };
        // Writing to a string does not fail.
        let _ = writeln!(text, "{option:<8}{what}{mark}");
    };
    let plural = if threads == 1 { "" } else { "s" };
    row("cpu", &format!("CPU ({threads} thread{plural})"), automatic.is_none());
    for gpu in gpus {
        row(&format!("gpu:{}", gpu.index), &describe(gpu), automatic == Some(gpu.index));
    }
    if gpus.is_empty() {
        text.push_str("no graphics card with a driver for Vulkan, Metal or Direct3D 12 was found\n");
    }
    text.push_str("\nGive the name in the first column to `sunshine render --device`.\n");
    text
}

fn describe(gpu: &GpuInfo) -> String {
    let mut text = format!("{} ({}", gpu.name, gpu.backend);
    let kind = if gpu.is_software { "software, slower than cpu" } else { &gpu.kind };
    for detail in [kind, &gpu.driver] {
        if !detail.is_empty() {
            text.push_str(", ");
            text.push_str(detail);
        }
    }
    text.push(')');
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gpu(index: usize, name: &str, kind: &str, driver: &str) -> GpuInfo {
        GpuInfo {
            index,
            name: name.to_owned(),
            backend: "Vulkan".to_owned(),
            driver: driver.to_owned(),
            kind: kind.to_owned(),
            is_software: kind == "software",
        }
    }

    #[test]
    fn the_automatic_choice_is_marked() {
        let gpus = [gpu(0, "llvmpipe", "software", "Mesa 25.0"), gpu(1, "Arc", "discrete", "")];
        let text = listing(8, &gpus);
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(lines[0], "cpu     CPU (8 threads)");
        assert_eq!(lines[1], "gpu:0   llvmpipe (Vulkan, software, slower than cpu, Mesa 25.0)");
        assert_eq!(lines[2], "gpu:1   Arc (Vulkan, discrete)  <- auto");
    }

    #[test]
    fn without_a_card_the_cpu_is_automatic() {
        let text = listing(1, &[]);
        assert!(text.starts_with("cpu     CPU (1 thread)  <- auto\nno graphics card"), "{text}");
    }
}
