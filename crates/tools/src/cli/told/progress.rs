//! Progress of a long run, on a terminal.

use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};

/// A line on stderr with the progress of a run; only on a terminal, and only in a long run.
pub(in crate::cli) struct Progress {
    /// Start of the run; `None` if the line is never shown.
    since: Option<Instant>,
    shown: Option<Instant>,
    total: u64,
}

/// Duration of a run before the line appears.
const PATIENCE: Duration = Duration::from_millis(700);
const REFRESH: Duration = Duration::from_millis(100);
const WIDTH: usize = 30;

impl Progress {
    /// Returns the line for a run of `total` rows; `hidden` if the terminal shows the rows.
    pub(in crate::cli) fn new(total: u64, hidden: bool) -> Self {
        let seen = !hidden && std::io::stderr().is_terminal();
        Self {
            since: seen.then(Instant::now),
            shown: None,
            total,
        }
    }

    /// Updates the line after `rows` rows.
    pub(in crate::cli) fn done(&mut self, rows: u64) {
        let Some(since) = self.since else { return };
        let elapsed = since.elapsed();
        let fresh = self.shown.is_some_and(|shown| shown.elapsed() < REFRESH);
        if elapsed < PATIENCE || fresh {
            return;
        }
        // A closed terminal is no error.
        let mut stderr = std::io::stderr();
        let _ = write!(stderr, "\r{}", line(rows, self.total, elapsed));
        let _ = stderr.flush();
        self.shown = Some(Instant::now());
    }

    /// Clears the line, before another message.
    pub(in crate::cli) fn clear(&mut self) {
        if self.shown.take().is_some() {
            let _ = write!(std::io::stderr(), "\r\x1b[K");
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.clear();
    }
}

fn line(rows: u64, total: u64, elapsed: Duration) -> String {
    let part = rows as f64 / total.max(1) as f64;
    let filled = (part * WIDTH as f64) as usize;
    let left = elapsed.as_secs_f64() * (1.0 / part.max(1e-9) - 1.0);
    format!(
        "[{:<WIDTH$}] {:3.0} %, {left:.0} s left ",
        "#".repeat(filled.min(WIDTH)),
        100.0 * part
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_tells_part_and_time() {
        assert_eq!(
            line(250, 1000, Duration::from_secs(2)),
            "[#######                       ]  25 %, 6 s left "
        );
        assert_eq!(
            line(1000, 1000, Duration::from_secs(2)),
            "[##############################] 100 %, 0 s left "
        );
    }
}
