//! How large a film may be that must be in memory as a whole.

use crate::{FilmSums, Goal, RenderError, RenderSettings};
use kernels::records::kernel::FilmPixel;

/// Taken where the system does not tell how much memory is free.
const USUAL: u64 = 4 << 30;

/// Bytes that films in memory may take: three quarters of the memory that can be had now. A process in a control
/// group, as batch systems start them, gets no more than its group.
pub fn film_limit() -> u64 {
    let free = std::fs::read_to_string("/proc/meminfo").ok().and_then(|text| available(&text));
    let group = std::fs::read_to_string("/proc/self/cgroup").ok().and_then(|text| group_limit(&text));
    let limits = [free, group].into_iter().flatten().min();
    limits.map_or(USUAL, |bytes| bytes / 4 * 3)
}

fn available(meminfo: &str) -> Option<u64> {
    let line = meminfo.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kibibytes.checked_mul(1024)
}

/// What the unified hierarchy of Linux grants the group of this process, less what it has already.
fn group_limit(cgroup: &str) -> Option<u64> {
    let path = cgroup.lines().find_map(|line| line.strip_prefix("0::"))?;
    let number = |name: &str| -> Option<u64> {
        let file = format!("/sys/fs/cgroup{}/{name}", path.trim_end_matches('/'));
        std::fs::read_to_string(file).ok()?.trim().parse().ok()
    };
    // `max` is no number: no limit.
    Some(number("memory.max")?.saturating_sub(number("memory.current").unwrap_or(0)))
}

/// Bytes of the film of a picture that is rendered pass by pass.
pub fn film_bytes(settings: &RenderSettings) -> u64 {
    let window = settings.window();
    let pixels = u64::from(window.width) * u64::from(window.height);
    pixels * u64::from(FilmSums::most_films(settings.samples)) * size_of::<FilmPixel>() as u64
}

/// Samples that are expected where nobody knows their number beforehand.
const EXPECTED_SAMPLES: u32 = 4096;

/// Whether the film of a picture that is rendered as far as `goal` fits into memory.
///
/// # Errors
/// [`RenderError::FilmTooLarge`] if it does not.
pub fn check_kept(settings: &RenderSettings, goal: Goal) -> Result<(), RenderError> {
    let samples = match goal {
        Goal::Samples(_) => settings.samples,
        Goal::Rule(rule) => rule.most_samples.min(EXPECTED_SAMPLES),
    };
    check_film(film_bytes(&RenderSettings { samples, ..settings.clone() }))
}

/// Whether a film of so many bytes fits.
///
/// # Errors
/// [`RenderError::FilmTooLarge`] if it does not.
pub(crate) fn check_film(needed: u64) -> Result<(), RenderError> {
    let limit = film_limit();
    if needed > limit {
        return Err(RenderError::FilmTooLarge { needed, limit });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn free_memory_is_read_in_bytes() {
        assert_eq!(available("MemTotal: 9 kB\nMemAvailable:   2048 kB\n"), Some(2 << 20));
        assert_eq!(available("MemTotal: 9 kB\n"), None);
        assert_eq!(group_limit("1:memory:/old\n"), None);
    }

    #[test]
    fn an_impossible_film_is_refused_with_the_figure() {
        let settings =
            RenderSettings { width: 65536, height: 65536, samples: 65, ..RenderSettings::default() };
        assert_eq!(film_bytes(&settings), 65536 * 65536 * 64);
        let message = check_film(u64::MAX).unwrap_err().to_string();
        assert!(message.contains("GB of memory"), "{message}");
    }
}
