//! What is told on standard error while the work goes on.

use crate::terminal::printable;
use groimp::Report;
use indicatif::{HumanDuration, ProgressBar, ProgressState, ProgressStyle};
use std::fmt;
use std::io::{self, IsTerminal, Write};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Where messages go: to standard error, or nowhere.
#[derive(Clone, Copy, Debug)]
pub struct Messages {
    /// Say nothing.
    pub quiet: bool,
}

impl Messages {
    /// Says one thing.
    pub fn line(&self, text: &str) {
        let text = printable(text);
        tracing::info!(target: crate::log::SAID, "{text}");
        if !self.quiet {
            // Work is not given up because nobody listens.
            let _ = writeln!(io::stderr(), "{text}");
        }
    }

    /// Says what the reader left out or was unsure of.
    pub fn report(&self, report: &Report) {
        for skipped in &report.skipped {
            self.line(&format!("not drawn: {skipped}"));
        }
        for warning in &report.warnings {
            self.line(&format!("warning: {warning}"));
        }
    }

    /// Begins to follow a rendering of `total` samples.
    pub fn follow(self, total: u64) -> RenderProgress {
        // A bar redraws its line, which fills a log file with rubbish.
        let as_bar = !self.quiet && io::stderr().is_terminal();
        RenderProgress {
            messages: self,
            total: total.max(1),
            tenths: AtomicU64::new(0),
            bar: as_bar.then(|| progress_bar(total)),
        }
    }
}

/// Shows how far a rendering is: as a bar with the time left on a terminal, else as a line every 10 %.
pub struct RenderProgress {
    messages: Messages,
    total: u64,
    /// The last tenth that a line was printed for.
    tenths: AtomicU64,
    bar: Option<ProgressBar>,
}

impl RenderProgress {
    /// Takes note of the number of samples done; called from any thread, in any order.
    pub fn update(&self, done: u64) -> ControlFlow<()> {
        match &self.bar {
            Some(bar) => {
                // Reports of several threads may overtake each other; the bar does not go back.
                if done > bar.position() {
                    bar.set_position(done);
                }
            }
            None => {
                if let Some(percent) = self.next_line(done) {
                    self.messages.line(&format!("rendered {percent} %"));
                }
            }
        }
        ControlFlow::Continue(())
    }

    /// The percentage to print, if another tenth is complete.
    fn next_line(&self, done: u64) -> Option<u64> {
        // In 128 bits: pictures of 65536 x 65536 pixels with many samples come near 64.
        let tenth = (u128::from(done.min(self.total)) * 10 / u128::from(self.total)) as u64;
        (tenth > self.tenths.fetch_max(tenth, Ordering::Relaxed)).then_some(tenth * 10)
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

impl Drop for RenderProgress {
    fn drop(&mut self) {
        // Also after a failure, so that the error message gets a line of its own.
        self.finish();
    }
}

fn progress_bar(total: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("rendering {wide_bar} {percent:>3} %{left}")
        .unwrap_or_else(|_| ProgressStyle::default_bar())
        .with_key("left", |state: &ProgressState, text: &mut dyn fmt::Write| {
            // Before the first report there is nothing to reckon from.
            if state.pos() > 0 {
                // A bar with a piece missing is no reason to stop.
                let _ = write!(text, ", {} left", HumanDuration(state.eta()));
            }
        });
    let bar = ProgressBar::new(total).with_style(style);
    // A slow device reports seldom; the time left counts down in between.
    bar.enable_steady_tick(Duration::from_millis(500));
    bar
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_for_every_tenth_and_no_line_twice() {
        let progress = RenderProgress {
            messages: Messages { quiet: true },
            total: 1000,
            tenths: AtomicU64::new(0),
            bar: None,
        };
        let lines: Vec<_> = [0, 99, 100, 150, 350, 340, 399, 1000, 1000, 2000]
            .into_iter()
            .filter_map(|done| progress.next_line(done))
            .collect();
        assert_eq!(lines, [10, 30, 100]);
    }

    #[test]
    fn the_largest_pictures_do_not_overflow() {
        let progress = Messages { quiet: true }.follow(u64::MAX);
        assert_eq!(progress.next_line(u64::MAX / 2 + 1), Some(50));
        assert_eq!(progress.update(u64::MAX), ControlFlow::Continue(()));
    }
}
