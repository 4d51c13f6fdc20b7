//! Messages to the host by category.

use std::cell::Cell;

use super::state::Version;
use super::status::Status;

/// A log category, declared in the model description.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Category {
    /// Every message.
    All,
    /// Advice, remarks on the mechanism, and reasons of discarded calls.
    Warning,
    /// Messages of a call that returns `fmi2Discard`.
    Discard,
    /// Messages of a call that returns `fmi2Error`.
    Error,
    /// Messages of a call that returns `fmi2Fatal`.
    Fatal,
    /// Initialization, reset, termination, FMU states, change points, stops and friction.
    Events,
    /// Iterations and sub-steps of each step.
    Solver,
}

impl Category {
    /// All categories with their descriptions, in the order of the model description.
    pub const ALL: [(Self, &'static str); 7] = [
        (Self::All, "every message"),
        (Self::Warning, "advice, and reasons of discarded calls"),
        (Self::Discard, "discarded calls"),
        (Self::Error, "refused and failed calls"),
        (Self::Fatal, "defects of biela"),
        (
            Self::Events,
            "initialization, reset, termination, FMU states, change points, stops, friction, sources of rates",
        ),
        (Self::Solver, "iterations and sub-steps of each step"),
    ];

    /// Returns the name in the model description and in the logger callback.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::All => "logAll",
            Self::Warning => "logStatusWarning",
            Self::Discard => "logStatusDiscard",
            Self::Error => "logStatusError",
            Self::Fatal => "logStatusFatal",
            Self::Events => "logEvents",
            Self::Solver => "logNonlinearSystems",
        }
    }

    fn by_name(name: &str) -> Option<Self> {
        let mut all = Self::ALL.into_iter().map(|(category, _)| category);
        all.find(|category| category.name() == name)
    }

    /// Returns whether the host of an FMI 2.0 instance gets messages of this category with any
    /// settings.
    pub(super) fn always(self) -> bool {
        matches!(self, Self::Error | Self::Fatal)
    }

    /// Returns the bits of the categories that it switches.
    fn bits(self) -> u8 {
        match self {
            Self::All => u8::MAX,
            other => 1 << other as u8,
        }
    }
}

/// Kind of advice on wrong use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Advice {
    /// A driver is beyond its limits.
    Limits,
    /// An angle jumps, as one does that the host wraps.
    WrappedAngle,
    /// Given rates contradict the motion, or are missing in model exchange.
    Rates,
    /// A singular position is near: a dead point may follow.
    SingularPosition,
    /// Parts overlap.
    Overlap,
    /// A function is called beyond its points.
    Points,
}

impl Advice {
    fn bit(self) -> u8 {
        1 << self as u8
    }
}

/// Receiver of messages: the host's logger callback.
pub trait Sink {
    /// Takes one message.
    fn write(&self, status: Status, category: Category, message: &str);
}

/// Decides which messages reach the host.
pub struct Logger {
    sink: Box<dyn Sink + Send>,
    enabled: u8,
    /// Whether errors, reasons of discarded calls and advice on wrong use reach the host with any
    /// settings: in FMI 3.0 they do not (2.3.1).
    insistent: bool,
    /// Kinds of advice that the host got in this run, one bit each.
    advised: Cell<u8>,
    /// Kinds of advice given since [`take_warning`](Self::take_warning), one bit each.
    warned: Cell<u8>,
}

impl std::fmt::Debug for Logger {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Logger")
            .field("enabled", &self.enabled)
            .finish_non_exhaustive()
    }
}

impl Logger {
    pub(super) fn new(sink: Box<dyn Sink + Send>, logging_on: bool, version: Version) -> Self {
        let enabled = if logging_on { Category::All.bits() } else { 0 };
        Self {
            sink,
            enabled,
            insistent: version == Version::Fmi2,
            advised: Cell::new(0),
            warned: Cell::new(0),
        }
    }

    /// Returns whether the host gets messages of this category. Callers ask before they format one.
    #[must_use]
    pub fn wants(&self, category: Category) -> bool {
        self.insistent && category.always() || self.enabled & category.bits() != 0
    }

    /// Returns whether the host has switched any category on.
    pub(super) fn is_on(&self) -> bool {
        self.enabled != 0
    }

    /// Returns whether advice of this kind would reach the host. Callers ask before they search for a
    /// cause.
    #[inline]
    #[must_use]
    pub fn wants_advice(&self, kind: Advice) -> bool {
        self.insistent && self.advised.get() & kind.bit() == 0 || self.wants(Category::Warning)
    }

    /// Gives advice on wrong use. That of the first call in a run which gives this kind has the status
    /// `fmi2Warning`, which the call returns, and reaches an FMI 2.0 host with any settings; all other
    /// advice is [remarks](Self::remark). In FMI 3.0 nothing is logged while the category is off (2.3.1), and the
    /// call then returns `fmi3OK`: a status without its reason helps nobody.
    pub fn advise(&self, kind: Advice, message: impl FnOnce() -> String) {
        if self.warned.get() & kind.bit() != 0 {
            self.warn(&message());
        } else if self.advised.get() & kind.bit() != 0 {
            self.remark(message);
        } else if self.wants_advice(kind) {
            self.advised.set(self.advised.get() | kind.bit());
            self.warned.set(self.warned.get() | kind.bit());
            self.warn(&message());
        }
    }

    /// Returns whether advice was given since the last question.
    #[inline]
    pub(super) fn take_warning(&self) -> bool {
        self.warned.replace(0) != 0
    }

    /// Begins a run, in which each kind of advice is given anew.
    pub(super) fn begin_run(&self) {
        self.advised.set(0);
    }

    /// Sends a remark to the host if the category of warnings is on. Its status is `fmi2OK`.
    pub fn remark(&self, message: impl FnOnce() -> String) {
        if self.wants(Category::Warning) {
            self.sink.write(Status::Ok, Category::Warning, &message());
        }
    }

    /// Sends a warning, such as the reason why the mechanism cannot go on: in FMI 2.0 with any
    /// settings.
    pub(super) fn warn(&self, message: &str) {
        if self.insistent || self.wants(Category::Warning) {
            self.sink.write(Status::Warning, Category::Warning, message);
        }
    }

    /// Sends a message to the host if the category is on.
    pub fn write(&self, status: Status, category: Category, message: &str) {
        if self.wants(category) {
            self.sink.write(status, category, message);
        }
    }

    /// Switches the named categories on or off; an empty list switches all.
    ///
    /// # Errors
    ///
    /// The first name that is no category; all switches stay.
    pub(super) fn switch<'a>(&mut self, on: bool, categories: &[&'a str]) -> Result<(), &'a str> {
        let mut bits = 0;
        for name in categories {
            bits |= Category::by_name(name).ok_or(*name)?.bits();
        }
        if categories.is_empty() {
            bits = u8::MAX;
        }
        if on {
            self.enabled |= bits;
        } else {
            self.enabled &= !bits;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Nowhere;

    impl Sink for Nowhere {
        fn write(&self, _: Status, _: Category, _: &str) {}
    }

    #[test]
    fn one_category_goes_off_while_the_others_stay_on() {
        let mut logger = Logger::new(Box::new(Nowhere), true, Version::Fmi2);
        assert!(logger.wants(Category::Solver) && logger.wants(Category::Events));
        logger.switch(false, &["logNonlinearSystems"]).unwrap();
        assert!(!logger.wants(Category::Solver) && logger.wants(Category::Events));
        logger.switch(false, &["logAll"]).unwrap();
        assert!(!logger.wants(Category::Events) && !logger.wants(Category::Warning));
        assert!(logger.wants(Category::Error) && logger.wants(Category::Fatal));
        logger.switch(true, &["logEvents"]).unwrap();
        assert!(!logger.wants(Category::Solver) && logger.wants(Category::Events));
        let switched = logger.switch(true, &["logNonlinearSystems", "logX"]);
        assert_eq!(switched, Err("logX"));
        assert!(!logger.wants(Category::Solver));
    }

    /// FMI 3.0, 2.3.1: no category that is off reaches the host.
    #[test]
    fn nothing_is_logged_in_fmi_3_while_logging_is_off() {
        let mut logger = Logger::new(Box::new(Nowhere), false, Version::Fmi3);
        for (category, _) in Category::ALL {
            assert!(!logger.wants(category), "{category:?}");
        }
        logger.switch(true, &["logStatusError"]).unwrap();
        assert!(logger.wants(Category::Error) && !logger.wants(Category::Fatal));
    }
}
