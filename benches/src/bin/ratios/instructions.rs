//! Instructions a step, counted by valgrind.

use std::path::PathBuf;
use std::process::{Command, Stdio};

/// Runs the program `steps` under callgrind.
pub(crate) struct Counter {
    steps: PathBuf,
}

impl Counter {
    /// Nothing if valgrind or the program is not there.
    pub(crate) fn find() -> Option<Self> {
        let mut version = Command::new("valgrind");
        version.arg("--version").stdout(Stdio::null());
        let steps = std::env::current_exe().ok()?.with_file_name("steps");
        let runs = version.status().is_ok_and(|status| status.success());
        (runs && steps.exists()).then_some(Self { steps })
    }

    /// Instructions a step: the difference of two runs, without what set-up takes.
    pub(crate) fn count(&self, case: &str, size: usize) -> f64 {
        let few = 20_u64;
        let many = few + (4_000 / size as u64).max(20);
        let difference = self.run(case, size, many) - self.run(case, size, few);
        difference / (many - few) as f64
    }

    fn run(&self, case: &str, size: usize, steps: u64) -> f64 {
        let run = Command::new("valgrind")
            .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
            .arg(&self.steps)
            .args([case, &size.to_string(), &steps.to_string()])
            .output()
            .expect("valgrind runs");
        let said = String::from_utf8_lossy(&run.stderr);
        let collected = said
            .lines()
            .find_map(|line| line.split_once("Collected : "))
            .and_then(|(_, count)| count.trim().parse().ok());
        match collected {
            Some(count) if run.status.success() => count,
            _ => panic!("callgrind of {case} {size}: {said}"),
        }
    }
}
