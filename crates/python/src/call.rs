//! Calls of the module: their work goes on without the interpreter's lock, on all cores where there are
//! many variants, until Ctrl-C ends it; a panic in it becomes an exception.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook};
use std::process;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, Once, PoisonError};
use std::time::{Duration, Instant};

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::error::Failure;

/// Time between two questions whether Ctrl-C was pressed: nobody notices the delay. A question takes some
/// microseconds, more while other threads of Python compute; twice as many cost nothing yet.
const PERIOD: Duration = Duration::from_millis(50);

/// Place of the last panic in the sources.
static PLACE: Mutex<String> = Mutex::new(String::new());

/// Does the work of a call without the interpreter's lock. All functions that compute call it, so that a
/// panic in any of them becomes an exception of the package.
///
/// # Errors
///
/// Those of the work; [`Failure::Defect`] where it panics.
pub(crate) fn apart<T: Send>(
    py: Python<'_>,
    work: impl FnOnce() -> Result<T, Failure> + Send,
) -> Result<T, Failure> {
    note_panics();
    py.detach(|| {
        let done = catch_unwind(AssertUnwindSafe(work));
        done.unwrap_or_else(|payload| Err(Failure::Defect(describe(&*payload))))
    })
}

/// Notes the places of panics instead of printing them. The module has a copy of std of its own, so that no
/// other panic in the process is silenced.
fn note_panics() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        set_hook(Box::new(|panic| {
            let place = panic.location().map(ToString::to_string);
            *PLACE.lock().unwrap_or_else(PoisonError::into_inner) = place.unwrap_or_default();
        }));
    });
}

/// Describes a panic: what was wrong, and where.
fn describe(payload: &(dyn Any + Send)) -> String {
    let message = payload.downcast_ref::<String>().map(String::as_str);
    let message = message.or_else(|| payload.downcast_ref::<&str>().copied());
    let place = PLACE.lock().unwrap_or_else(PoisonError::into_inner);
    format!("{} ({place})", message.unwrap_or("no message"))
}

/// The cause that ends a call before its work is done.
pub(crate) enum Interrupt<'a> {
    /// Ctrl-C, for which the thread of the call has asked at this time.
    Asked(Instant),
    /// A flag of the thread that asks, for those that work for it.
    Told(&'a AtomicBool),
}

impl Interrupt<'_> {
    /// Returns that of the thread of a call.
    pub(crate) fn of_call() -> Self {
        Self::Asked(Instant::now())
    }

    /// Asks whether the call has to end, unless it has just done so. The thread is [apart](apart).
    ///
    /// # Errors
    ///
    /// [`Failure::Raised`] with the exception of Python's handler of the signal; [`Failure::Ended`] where
    /// another thread has it.
    pub(crate) fn check(&mut self) -> Result<(), Failure> {
        match self {
            Self::Asked(last) if last.elapsed() < PERIOD => Ok(()),
            Self::Asked(last) => {
                *last = Instant::now();
                Python::attach(|py| py.check_signals()).map_err(Failure::Raised)
            }
            Self::Told(flag) if flag.load(Ordering::Relaxed) => Err(Failure::Ended),
            Self::Told(_) => Ok(()),
        }
    }
}

/// The threads that run variants.
pub(crate) struct Cores {
    pool: Arc<ThreadPool>,
}

impl Cores {
    /// Returns the threads of this process. A forked child has none of its parent's and gets its own.
    ///
    /// # Errors
    ///
    /// [`Failure::Defect`] where the system gives no threads.
    pub(crate) fn of_process(_locked: Python<'_>) -> Result<Self, Failure> {
        /// The pool, and the process in which its threads run. Who holds the lock holds the interpreter's
        /// too, as who forks: no child finds it locked.
        static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);
        let mut known = POOL.lock().unwrap_or_else(PoisonError::into_inner);
        let process = process::id();
        if let Some((_, pool)) = known.as_ref().filter(|(owner, _)| *owner == process) {
            let pool = Arc::clone(pool);
            return Ok(Self { pool });
        }
        let pool = ThreadPoolBuilder::new().build();
        let pool = Arc::new(pool.map_err(|error| Failure::Defect(error.to_string()))?);
        let parents = known.replace((process, Arc::clone(&pool)));
        // To drop the parent's would wait for threads that do not exist here.
        std::mem::forget(parents);
        Ok(Self { pool })
    }

    /// Does work on the threads, which ask before each variant and row whether they are
    /// [told](Interrupt::Told) to stop.
    ///
    /// # Errors
    ///
    /// Those of the work; [`Failure::Raised`] after Ctrl-C.
    pub(crate) fn run<T: Send>(
        &self,
        work: impl FnOnce(&AtomicBool) -> Result<T, Failure> + Send,
    ) -> Result<T, Failure> {
        let stop = AtomicBool::new(false);
        let (sender, receiver) = channel();
        self.pool.in_place_scope(|scope| {
            scope.spawn(|_| {
                // The receiver waits until the work has ended.
                let _ = sender.send(work(&stop));
            });
            loop {
                match receiver.recv_timeout(PERIOD) {
                    Ok(done) => return done,
                    Err(RecvTimeoutError::Timeout) => {
                        let asked = Python::attach(|py| py.check_signals());
                        if let Err(exception) = asked {
                            stop.store(true, Ordering::Relaxed);
                            return Err(Failure::Raised(exception));
                        }
                    }
                    // The scope, at its end, goes on with the panic of the work.
                    Err(RecvTimeoutError::Disconnected) => {
                        return Err(Failure::Defect("the work has panicked".to_owned()));
                    }
                }
            }
        })
    }
}
