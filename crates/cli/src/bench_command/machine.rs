//! What a measurement was made on, and when.

use serde::{Deserialize, Serialize};
use std::fmt::{self, Display};
use std::time::{SystemTime, UNIX_EPOCH};

/// A machine.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MachineRecord {
    /// Model of the processor.
    pub processor: String,
    /// Threads that rendered on it.
    pub threads: u32,
    /// Graphics cards that were found, in the order of their numbers; none if only the processor was measured, as nobody
    /// looked for them.
    pub graphics_cards: Vec<GraphicsCard>,
    /// Operating system.
    pub system: String,
}

/// A graphics card, or a program that plays one.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct GraphicsCard {
    /// Name that the driver gives it.
    pub name: String,
    /// Vulkan, Metal or DirectX 12.
    pub backend: String,
    /// Driver and its version.
    pub driver: String,
}

impl MachineRecord {
    /// This machine; `threads` as asked for. Looking for graphics cards loads their drivers, which take memory.
    pub fn this(threads: Option<u32>, with_cards: bool) -> Self {
        let all = || std::thread::available_parallelism().map_or(1, usize::from);
        let cards = if with_cards { render::list_gpus() } else { Vec::new() };
        MachineRecord {
            processor: processor(),
            threads: threads.unwrap_or_else(|| u32::try_from(all()).unwrap_or(u32::MAX)),
            graphics_cards: cards
                .into_iter()
                .map(|gpu| GraphicsCard { name: gpu.name, backend: gpu.backend, driver: gpu.driver })
                .collect(),
            system: system(),
        }
    }
}

impl MachineRecord {
    /// Whether two records are of the same machine, as far as they tell.
    pub fn is_same(&self, other: &MachineRecord) -> bool {
        let cards = [&self.graphics_cards, &other.graphics_cards];
        let key =
            |machine: &MachineRecord| (machine.processor.clone(), machine.threads, machine.system.clone());
        key(self) == key(other) && (cards[0] == cards[1] || cards.iter().any(|cards| cards.is_empty()))
    }
}

impl Display for MachineRecord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let plural = if self.threads == 1 { "" } else { "s" };
        write!(f, "{}, {} thread{plural}", self.processor, self.threads)?;
        for card in &self.graphics_cards {
            write!(f, ", {} ({} {})", card.name, card.backend, card.driver)?;
        }
        write!(f, ", {}", self.system)
    }
}

/// Model of the processor where the system tells, else its architecture.
fn processor() -> String {
    let told = std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| model_name(&text));
    let told = told.or_else(|| std::env::var("PROCESSOR_IDENTIFIER").ok());
    told.or_else(apple_processor).unwrap_or_else(|| std::env::consts::ARCH.to_owned())
}

fn model_name(cpuinfo: &str) -> Option<String> {
    let line = cpuinfo.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned()).filter(|name| !name.is_empty())
}

fn apple_processor() -> Option<String> {
    if !cfg!(target_os = "macos") {
        return None;
    }
    let mut asked = std::process::Command::new("sysctl");
    let output = asked.args(["-n", "machdep.cpu.brand_string"]).output().ok()?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned()).filter(|name| !name.is_empty())
}

/// The operating system with its version where there are files that tell.
fn system() -> String {
    let release = std::fs::read_to_string("/etc/os-release").unwrap_or_default();
    let name = release.lines().find_map(|line| line.strip_prefix("PRETTY_NAME="));
    let name = name.map_or(std::env::consts::OS, |name| name.trim_matches('"'));
    match std::fs::read_to_string("/proc/sys/kernel/osrelease") {
        Ok(kernel) => format!("{name}, kernel {}", kernel.trim()),
        Err(_) => name.to_owned(),
    }
}

/// Date and time of now in universal time, as `2008-09-30T12:00:00Z`.
pub fn now() -> String {
    date(SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs()))
}

/// From seconds since the beginning of 1970; days are converted as in H. Hinnant, "chrono-Compatible Low-Level Date
/// Algorithms" (2013): years begin in March, so that the leap day comes last.
fn date(seconds: u64) -> String {
    let (days, second) = (seconds / 86_400 + 719_468, seconds % 86_400);
    let (era, day_of_era) = (days / 146_097, days % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * from_march + 2) / 5 + 1;
    let month = if from_march < 10 { from_march + 3 } else { from_march - 9 };
    let year = era * 400 + year_of_era + u64::from(month <= 2);
    let (hour, minute, second) = (second / 3600, second / 60 % 60, second % 60);
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates() {
        assert_eq!(date(0), "1970-01-01T00:00:00Z");
        assert_eq!(date(951_782_399), "2000-02-28T23:59:59Z");
        assert_eq!(date(951_782_400), "2000-02-29T00:00:00Z");
        assert_eq!(date(1_222_776_000), "2008-09-30T12:00:00Z");
    }

    #[test]
    fn processors() {
        let text = "processor\t: 0\nmodel name\t: Some CPU @ 2 GHz\nflags\t: x\n";
        assert_eq!(model_name(text).as_deref(), Some("Some CPU @ 2 GHz"));
        assert_eq!(model_name("Features : fp\n"), None);
    }
}
