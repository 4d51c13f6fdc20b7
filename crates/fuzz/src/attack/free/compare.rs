//! Two motions that have to be the same, as far as the motion itself is not chaotic.
//!
//! A motion is followed with the numbers of its file, and with numbers that are
//! [nudged](super::text::NUDGE). Where a nudge moves a place or an instant by d, the errors of an
//! integration with the tolerance tol, which are nudges of their own, move it by about d tol/nudge. From
//! the time on at which a nudge has grown to [`CHAOS`], or at which the nudged motions have other events,
//! nothing is compared.

use biela::dynamics::EventKind;

use super::align::{Alignment, Happening, SLOW, row_of_bounces};
use super::case::Truth;
use super::run::{AT_REST, Record, Row};
use super::text::NUDGE;
use crate::attack::distance;

/// Errors of an integration in a nudge of the same size: errors of many steps, and directions that
/// the nudges do not have.
const ERRORS: f64 = 100.0;
/// Errors that are there without any growth, in tolerances.
const LEAST: f64 = 300.0;
/// Differences of nudged motions from which on nothing is compared \[m or rad\], and those of rates.
const CHAOS: [f64; 2] = [1e-4, 1e-3];
/// A contact that opens, or friction that slides, for this part of the motion is rounding.
const SHORT: f64 = 1e-5;
/// Error of the instant of rest after bounces, as part of the motion: the last ones, of less than rounding,
/// are foreseen with the acceleration of that moment.
const REST: f64 = 1e-4;
/// Rounding of places in parts of their size, with what an instant and a speed make of it: at some hundred
/// turns it is more than the tolerance.
const ROUNDING: f64 = 1e-12;

/// Differences allowed between a motion and one with other errors.
#[derive(Debug)]
pub struct Sensitivity<'a> {
    base: &'a Record,
    duration: f64,
    /// Moves of each event by nudges \[s\], and the speed of an impact.
    moved: Vec<[f64; 2]>,
    /// Largest differences of places and of rates up to each row.
    grown: Vec<[f64; 2]>,
    /// Time up to which motions are compared \[s\].
    pub horizon: f64,
}

impl<'a> Sensitivity<'a> {
    /// Compares a motion with nudged ones.
    pub fn new(base: &'a Record, nudged: &[Record], duration: f64) -> Self {
        let mut sensitivity = Self {
            base,
            duration,
            moved: vec![[0.0; 2]; base.events.len()],
            grown: Vec::new(),
            horizon: duration,
        };
        for other in nudged {
            let alignment = sensitivity.align(&other.events);
            for [own, there] in alignment.pairs {
                let (event, other) = (&base.events[own], &other.events[there]);
                let moved = &mut sensitivity.moved[own];
                moved[0] = moved[0].max((event.time - other.time).abs());
                if let [
                    EventKind::Impact { speed },
                    EventKind::Impact { speed: there },
                ] = [event.kind, other.kind]
                {
                    moved[1] = moved[1].max((speed - there).abs());
                }
                if moved[0] > CHAOS[0] * duration || moved[1] > CHAOS[1] {
                    sensitivity.horizon = sensitivity.horizon.min(event.time);
                }
            }
            let odd = alignment.odd.map(|(time, _)| time);
            let refusals = [base, other].map(|record| record.refusal.as_ref());
            let names = refusals.map(|refusal| refusal.map(|refusal| &refusal.name));
            let ends = refusals.into_iter().flatten().map(|refusal| refusal.time);
            let ends = ends.filter(|_| names[0] != names[1]);
            let horizon = &mut sensitivity.horizon;
            *horizon = odd.into_iter().chain(ends).fold(*horizon, f64::min);
        }
        let mut most = [0.0_f64; 2];
        for (index, row) in base.rows.iter().enumerate() {
            for other in nudged.iter().filter_map(|other| other.rows.get(index)) {
                most[0] = most[0].max(distance(&row.places, &other.places));
                if !sensitivity.is_near_event(row.time, 1.0) {
                    most[1] = most[1].max(distance(&row.rates, &other.rates));
                }
            }
            sensitivity.grown.push(most);
            if most[0] > CHAOS[0] || most[1] > CHAOS[1] {
                sensitivity.horizon = sensitivity.horizon.min(row.time);
                break;
            }
        }
        sensitivity
    }

    fn align(&self, events: &[Happening]) -> Alignment {
        Alignment::new([&self.base.events, events], SHORT * self.duration)
    }

    /// Returns whether a time is so near to an event that errors, in nudges, may move it past it.
    fn is_near_event(&self, time: f64, errors: f64) -> bool {
        let mut events = self.base.events.iter().zip(&self.moved);
        let resolution = 1e-8 * self.duration;
        events.any(|(event, [moved, _])| {
            (event.time - time).abs() <= (1.0 + errors) * moved + (1.0 + errors) * resolution
        })
    }

    /// Compares the motion with one that has errors of these tolerances.
    ///
    /// # Errors
    ///
    /// The first difference, in words.
    pub fn compare(&self, other: &Record, tolerance: f64) -> Result<(), String> {
        let errors = Errors::of(tolerance, self.base);
        let refusals = [self.base, other].map(|record| record.refusal.as_ref());
        let times = refusals.map(|refusal| refusal.map_or(f64::INFINITY, |refusal| refusal.time));
        let first = times[0].min(times[1]);
        if first < self.horizon {
            let names = refusals.map(|refusal| refusal.map(|refusal| &refusal.name));
            if names[0] != names[1] {
                return Err(format!("refused differently: {refusals:?}"));
            }
            // The last pose may be that of a step before.
            if (times[0] - times[1]).abs() > 0.01 * self.duration {
                return Err(format!("refused at other times: {refusals:?}"));
            }
        }
        let until = first.min(self.horizon) - SHORT * self.duration;
        self.compare_events(&other.events, until, &errors, false)?;
        for row in other.rows.iter().filter(|row| row.time < until) {
            let Some((index, same)) = self.row(row) else {
                continue;
            };
            let [grown, rates] = self.grown[index.min(self.grown.len() - 1)];
            let allowed = errors.of_place(grown, size(&row.places));
            let off = distance(&row.places, &same.places);
            let time = row.time;
            if off.is_nan() || off > allowed {
                return Err(format!(
                    "places at {time} s differ by {off:.1e}, allowed {allowed:.1e}"
                ));
            }
            let allowed = errors.of_rate(rates, size(&row.rates));
            let off = distance(&row.rates, &same.rates);
            let differ = off.is_nan() || off > allowed;
            if differ && !self.is_near_event(time, errors.ratio) {
                return Err(format!(
                    "rates at {time} s differ by {off:.1e}, allowed {allowed:.1e}"
                ));
            }
        }
        Ok(())
    }

    /// Compares the motion, which has errors of this tolerance, with the truth.
    ///
    /// # Errors
    ///
    /// The first difference, in words.
    pub fn compare_truth(&self, truth: &Truth, tolerance: f64) -> Result<(), String> {
        let errors = Errors::of(tolerance, self.base);
        let refusal = self.base.refusal.as_ref();
        let until = self.horizon.min(truth.until);
        if let Some(refusal) = refusal.filter(|refusal| refusal.time < until) {
            return Err(format!("refused, but goes on in truth: {refusal:?}"));
        }
        let until = until - SHORT * self.duration;
        for (row, [grown, _]) in self.base.rows.iter().zip(&self.grown) {
            if row.time >= until {
                break;
            }
            let values = (truth.values)(row.time);
            let off = distance(&values, &row.variables);
            let allowed = errors.of_place(*grown, size(&row.places));
            if off.is_nan() || off > allowed {
                let (time, found) = (row.time, &row.variables);
                return Err(format!(
                    "at {time} s {found:?}, in truth {values:?}, allowed {allowed:.1e}"
                ));
            }
        }
        self.compare_events(&truth.impacts, until, &errors, true)
    }

    /// Compares the events up to a time with those of another motion, with impacts alone on demand.
    fn compare_events(
        &self,
        others: &[Happening],
        until: f64,
        errors: &Errors,
        impacts: bool,
    ) -> Result<(), String> {
        let mut alignment = self.align(others);
        let mut places: Vec<usize> = (0..self.base.events.len()).collect();
        if impacts {
            let is_impact = |event: &Happening| matches!(event.kind, EventKind::Impact { .. });
            places.retain(|place| is_impact(&self.base.events[*place]));
            let own: Vec<_> = places
                .iter()
                .map(|p| self.base.events[*p].clone())
                .collect();
            alignment = Alignment::new([&own, others], SHORT * self.duration);
        }
        let odd = alignment.odd.filter(|(time, _)| *time < until);
        if let Some((_, odd)) = odd.filter(|(time, _)| !self.rests_at(*time)) {
            return Err(format!("other events: {odd}"));
        }
        for [own, there] in alignment.pairs {
            let (event, other) = (&self.base.events[places[own]], &others[there]);
            let slower = event.speed().min(other.speed());
            if event.time >= until || slower < SLOW {
                continue;
            }
            let [moved, rates] = self.moved[places[own]];
            let allowed =
                errors.ratio * moved + errors.least * (self.duration + 1.0 / slower.min(1.0));
            let allowed = match event.kind {
                EventKind::Impact { .. } => allowed,
                EventKind::Rests => allowed + REST * self.duration,
                // A force has the errors of accelerations.
                _ => allowed + 10.0 * errors.least * self.duration,
            };
            let row = row_of_bounces(&self.base.events, places[own], SHORT * self.duration);
            let allowed = allowed + row[1] - row[0];
            let off = (event.time - other.time).abs();
            if off > allowed {
                let events = [event, other].map(Happening::told);
                return Err(format!(
                    "{events:?} are {off:.1e} s apart, allowed {allowed:.1e}"
                ));
            }
            if row[0] < row[1] {
                continue;
            }
            let allowed = errors.of_rate(rates, 1.0 + slower);
            let off = event.speed() - other.speed();
            if off.abs() > allowed {
                let events = [event, other].map(Happening::told);
                return Err(format!(
                    "{events:?} differ by {off:.1e}, allowed {allowed:.1e}"
                ));
            }
        }
        Ok(())
    }

    /// Returns whether all rests around a time: what comes to rest ever more slowly has no instant of rest.
    fn rests_at(&self, time: f64) -> bool {
        let rows = &self.base.rows;
        let after = rows.partition_point(|row| row.time < time).max(1);
        let around = rows.iter().skip(after - 1).take(2);
        let mut rates = around.flat_map(|row| &row.rates);
        rates.all(|rate| rate.abs() <= AT_REST)
    }

    /// Returns the row at the time of another.
    fn row(&self, other: &Row) -> Option<(usize, &Row)> {
        let mut rows = self.base.rows.iter().enumerate();
        rows.find(|(_, row)| (row.time - other.time).abs() <= 1e-12 * self.duration)
    }
}

/// Errors that motions of a tolerance may have.
struct Errors {
    /// In nudges.
    ratio: f64,
    /// Without any growth.
    least: f64,
}

impl Errors {
    fn of(tolerance: f64, base: &Record) -> Self {
        let size = base.rows.iter().map(|row| size(&row.places));
        let rounding = ROUNDING * size.fold(1.0, f64::max);
        Self {
            ratio: ERRORS * tolerance / NUDGE,
            least: LEAST * tolerance.max(rounding),
        }
    }

    fn of_place(&self, grown: f64, size: f64) -> f64 {
        self.ratio * grown + self.least * size
    }

    fn of_rate(&self, grown: f64, size: f64) -> f64 {
        self.ratio * grown + 10.0 * self.least * size
    }
}

/// Returns the largest size of values, 1 at least.
fn size(values: &[f64]) -> f64 {
    values.iter().fold(1.0, |most, value| value.abs().max(most))
}
