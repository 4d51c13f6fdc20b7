//! Instructions per step, counted by valgrind.

use std::env;
use std::path::PathBuf;
use std::process::{Command, Stdio};

use crate::cases::Case;

/// Counter that runs the program `steps` under callgrind.
#[derive(Debug)]
pub struct Counter {
    steps: PathBuf,
}

impl Counter {
    /// Finds valgrind, and `steps` in the folder of this program. Returns nothing if one is
    /// missing.
    #[must_use]
    pub fn find() -> Option<Self> {
        let mut version = Command::new("valgrind");
        version.arg("--version").stdout(Stdio::null());
        let steps = env::current_exe().ok()?.with_file_name("steps");
        let runs = version.status().is_ok_and(|status| status.success());
        (runs && steps.exists()).then_some(Self { steps })
    }

    /// Counts the instructions per step over the case's span: the difference of two runs, so
    /// that set-up does not count.
    ///
    /// # Errors
    ///
    /// There is no such case, or it does not run under valgrind.
    pub fn count(&self, case: &Case) -> Result<f64, String> {
        let span = case.span()?;
        let few = span.min(20);
        let difference = self.run(case, few + span)? - self.run(case, few)?;
        Ok(difference / span as f64)
    }

    fn run(&self, case: &Case, steps: u64) -> Result<f64, String> {
        let run = Command::new("valgrind")
            .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
            .arg(&self.steps)
            .args([&case.name, &case.size.to_string(), &steps.to_string()])
            .output()
            .map_err(|error| format!("cannot run valgrind: {error}"))?;
        let said = String::from_utf8_lossy(&run.stderr);
        let collected = said
            .lines()
            .find_map(|line| line.split_once("Collected : "))
            .and_then(|(_, count)| count.trim().parse().ok());
        match collected {
            Some(count) if run.status.success() => Ok(count),
            _ => Err(said.into_owned()),
        }
    }
}
