//! Poses along time or a driver, after which the mechanism is where it was.

use super::outcome::Outcome;
use super::session::Session;
use biela::dynamics::Event;
use biela::kinematics::DriverPath;
use biela::mechanism::DriverId;

/// The variable along which a motion is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    /// Time, from the simulation's start to its end.
    Time,
    /// The range of a driver that is an input.
    Driver(DriverId),
}

impl Session {
    /// Returns what `read` finds at `samples` points along time or a driver, each behind its time or
    /// value, and the events of a free motion. It ends where the mechanism stops. The pose is
    /// unchanged. The time of a free motion begins where it was let go, or here if that is more than
    /// the simulation's time ago.
    pub(super) fn along<T>(
        &mut self,
        over: Over,
        samples: usize,
        read: impl Fn(&Self) -> T,
    ) -> (Vec<(f64, T)>, Vec<Event>) {
        let pass = |session: &mut Self| {
            session.events = Some(Vec::new());
            let rows = session.pass(over, samples, &read);
            (rows, session.events.take().unwrap_or_default())
        };
        match over {
            Over::Time => self.apart(pass),
            Over::Driver(_) => self.apart_by_hand(pass),
        }
    }

    fn pass<T>(&mut self, over: Over, samples: usize, read: &impl Fn(&Self) -> T) -> Vec<(f64, T)> {
        let here = self.pose().clone();
        let mut rows = Vec::new();
        let Some([low, high]) = self.ends(over) else {
            return rows;
        };
        let last = samples.clamp(2, 10_000) - 1;
        let point = |k: usize| low + (high - low) * (k as f64 / last as f64);
        match over {
            Over::Time => {
                if self.pose().time > low && self.return_to_start().is_err() {
                    return rows;
                }
                self.sample(over, (0..=last).map(point), read, &mut rows);
            }
            Over::Driver(driver) => {
                let value = here.drivers[driver.index()];
                let below = (0..=last).rev().map(point).filter(|x| *x < value);
                self.sample(over, below, read, &mut rows);
                rows.reverse();
                self.motion.solver.restore(&here);
                let above = (0..=last).map(point).filter(|x| *x >= value);
                self.sample(over, above, read, &mut rows);
            }
        }
        if self.motion.free().is_none() {
            self.motion.solver.restore(&here);
            self.refresh();
        }
        rows
    }

    /// Returns first and last value of time or of a driver; none of one that is no input.
    fn ends(&self, over: Over) -> Option<[f64; 2]> {
        let Over::Driver(driver) = over else {
            return Some(self.span());
        };
        let range = self.ranges.get(driver.index())?.as_ref()?;
        let [low, high] = range.ends;
        if !range.turns {
            return Some([low, high]);
        }
        // A crank may have turned away from its first turn.
        let turns = ((self.pose().drivers[driver.index()] - low) / (high - low)).floor();
        Some([low, high].map(|end| end + turns * (high - low)))
    }

    /// Returns start and end of the simulation; for freedoms, of as long a time from where they were
    /// let go, or from here if that is over.
    fn span(&self) -> [f64; 2] {
        let simulation = &self.mechanism().simulation;
        let [start, stop] = [simulation.start, simulation.stop];
        if self.motion.free().is_none() {
            return [start, stop];
        }
        let (first, now) = (self.start.pose.time, self.pose().time);
        let low = if now > first + (stop - start) {
            now
        } else {
            first
        };
        [low, low + (stop - start)]
    }

    /// Moves on to each point and adds what is read there, until the mechanism stops, where it is read
    /// last.
    fn sample<T>(
        &mut self,
        over: Over,
        points: impl Iterator<Item = f64>,
        read: &impl Fn(&Self) -> T,
        rows: &mut Vec<(f64, T)>,
    ) {
        for x in points {
            let path = self.path_here();
            match over {
                Over::Time => path.duration = x - path.start,
                Over::Driver(driver) => {
                    if let DriverPath::Input { position, .. } = path.driver_paths[driver.index()] {
                        path.driver_paths[driver.index()] = DriverPath::held(x, position);
                    }
                }
            }
            let outcome = if over == Over::Time && self.motion.free().is_some() {
                self.fly(x)
            } else {
                self.follow(|_| true)
            };
            self.refresh();
            let x = match over {
                Over::Time => self.pose().time,
                Over::Driver(driver) => self.pose().drivers[driver.index()],
            };
            rows.push((x, read(self)));
            if outcome != Outcome::Reached {
                break;
            }
        }
    }
}
