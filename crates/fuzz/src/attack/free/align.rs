//! Events of two motions, side by side.

use std::collections::BTreeSet;

use biela::dynamics::EventKind;

/// An event by its name.
#[derive(Clone, Debug, PartialEq)]
pub struct Happening {
    pub time: f64,
    /// Name of the stop, joint or friction.
    pub name: String,
    pub kind: EventKind,
}

/// Least number of events of a row of bounces, one after the other.
const BOUNCES: usize = 8;
/// Longest time between two of them, in short ones.
const PAUSE: f64 = 10.0;
/// Impacts below this speed may differ \[m/s or rad/s\]: bounces of a micrometre.
pub const SLOW: f64 = 5e-3;

impl Happening {
    /// Returns the speed of an impact, infinite of other events.
    pub fn speed(&self) -> f64 {
        match self.kind {
            EventKind::Impact { speed } => speed,
            _ => f64::INFINITY,
        }
    }

    fn is_impact(&self) -> bool {
        matches!(self.kind, EventKind::Impact { .. })
    }

    /// Tells the event.
    pub fn told(&self) -> String {
        format!("{:?} of {} at {} s", self.kind, self.name, self.time)
    }
}

/// Pairs of events of two motions, by their places there.
#[derive(Debug, Default)]
pub struct Alignment {
    pub pairs: Vec<[usize; 2]>,
    /// The first event that has no other, with its time \[s\], in words.
    pub odd: Option<(f64, String)>,
}

impl Alignment {
    /// Aligns the events of two motions, those of each name in their order. Slow impacts may have no
    /// others, nor has what is undone within a `short` time.
    pub fn new(events: [&[Happening]; 2], short: f64) -> Self {
        let mut alignment = Self::default();
        let names: BTreeSet<&str> = (events.into_iter().flatten())
            .map(|event| event.name.as_str())
            .collect();
        for name in names {
            let of_name = events.map(|events| {
                let places = events.iter().enumerate();
                let places = places.filter(|(_, event)| event.name == name);
                places.map(|(place, _)| place).collect::<Vec<_>>()
            });
            alignment.add(events, [&of_name[0], &of_name[1]], short);
        }
        alignment
    }

    /// Passes over the rest of a row of bounces, and returns whether there is one.
    fn pass_row(
        &self,
        events: [&[Happening]; 2],
        places: [&[usize]; 2],
        at: &mut [usize; 2],
        short: f64,
    ) -> bool {
        let ends = [0, 1].map(|side| {
            let place = *places[side].get(at[side])?;
            let [start, end] = row_of_bounces(events[side], place, short);
            (start < end).then_some(end)
        });
        let Some(end) = ends.into_iter().flatten().max_by(f64::total_cmp) else {
            return false;
        };
        for side in [0, 1] {
            let rest = &places[side][at[side]..];
            at[side] += rest
                .iter()
                .take_while(|k| events[side][**k].time <= end + PAUSE * short)
                .count();
        }
        true
    }

    /// Aligns the events at some places.
    fn add(&mut self, events: [&[Happening]; 2], places: [&[usize]; 2], short: f64) {
        let mut at = [0, 0];
        loop {
            let here = [0, 1].map(|side| {
                let rest = &places[side][at[side]..];
                rest.iter()
                    .map(|place| &events[side][*place])
                    .collect::<Vec<_>>()
            });
            let undone = here.each_ref().map(|events| undone(events, short));
            if undone[0].min(undone[1]) == 0 && undone != [0, 0] {
                at = [at[0] + undone[0], at[1] + undone[1]];
                continue;
            }
            let firsts = [here[0].first(), here[1].first()];
            let is_same = match firsts {
                [None, None] => return,
                [Some(one), Some(other)] => {
                    let leaves_row = |side: usize| {
                        let place = places[side][at[side]];
                        let [start, end] = row_of_bounces(events[side], place, short);
                        start < end && here[1 - side][0].time > end + PAUSE * short
                    };
                    is_same(one, other) && !leaves_row(0) && !leaves_row(1)
                }
                _ => false,
            };
            if is_same {
                self.pairs.push([places[0][at[0]], places[1][at[1]]]);
                at = at.map(|at| at + 1);
                continue;
            }
            let skipped = here.each_ref().map(|events| skipped(events));
            match skipped {
                [0, 0] if self.pass_row(events, places, &mut at, short) => {}
                [0, 0] => {
                    let mut odd: Vec<_> = firsts.into_iter().flatten().collect();
                    odd.sort_by(|a, b| a.time.total_cmp(&b.time));
                    let time = odd[0].time;
                    if self.odd.as_ref().is_none_or(|(first, _)| time < *first) {
                        let words = firsts.map(|event| event.map(|event| event.told()));
                        self.odd = Some((time, format!("{words:?}")));
                    }
                    return;
                }
                [0, more] => at[1] += more,
                [more, 0] => at[0] += more,
                // The earlier one.
                [one, other] => {
                    if here[0][0].time <= here[1][0].time {
                        at[0] += one
                    } else {
                        at[1] += other
                    }
                }
            }
        }
    }
}

/// Returns the time from the start to the end of the row of bounces to which an event belongs; zero if it
/// belongs to none. What bounces there in turn until it rests magnifies errors at each bounce, and has no
/// other effect.
pub fn row_of_bounces(events: &[Happening], place: usize, short: f64) -> [f64; 2] {
    let follows = |pair: &[Happening]| pair[1].time - pair[0].time < PAUSE * short;
    let ends = events[place..].windows(2).take_while(|pair| follows(pair));
    let starts = events[..=place].windows(2).rev();
    let starts = starts.take_while(|pair| follows(pair));
    let [before, after] = [starts.count(), ends.count()];
    let time = events[place].time;
    match before + after {
        BOUNCES.. => [events[place - before].time, events[place + after].time],
        _ => [time, time],
    }
}

/// Returns whether two events of the same name may be one.
fn is_same(one: &Happening, other: &Happening) -> bool {
    let is_same_kind = std::mem::discriminant(&one.kind) == std::mem::discriminant(&other.kind);
    let slower = one.speed().min(other.speed());
    let faster = one.speed().max(other.speed());
    is_same_kind && (!one.is_impact() || slower > SLOW || faster < 2.0 * SLOW)
}

/// Returns how many events may be passed over.
fn skipped(events: &[&Happening]) -> usize {
    match events {
        [first, ..] if first.speed() < 2.0 * SLOW => 1,
        _ => 0,
    }
}

/// Returns the number of events from the first one to the one that undoes it at once, slow impacts
/// between them; zero if it lasts.
fn undone(events: &[&Happening], short: f64) -> usize {
    let is_slow = |event: &Happening| event.speed() < 2.0 * SLOW;
    let later = events.iter().skip(1).position(|event| !is_slow(event));
    let Some(between) = later else {
        return 0;
    };
    let [first, second] = [events[0], events[1 + between]];
    let is_opposite = matches!(
        [first.kind, second.kind],
        [EventKind::Leaves, EventKind::Rests]
            | [EventKind::Rests, EventKind::Leaves]
            | [EventKind::Slides, EventKind::Sticks]
            | [EventKind::Sticks, EventKind::Slides]
    );
    if is_opposite && second.time - first.time < short {
        2 + between
    } else {
        0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn event(time: f64, kind: EventKind) -> Happening {
        Happening {
            time,
            name: "stop".to_owned(),
            kind,
        }
    }

    fn impact(time: f64, speed: f64) -> Happening {
        event(time, EventKind::Impact { speed })
    }

    #[test]
    fn slow_impacts_and_short_rests_need_no_other() {
        let one = [
            impact(0.1, 1.0),
            impact(0.2, 0.006),
            impact(0.21, 0.001),
            event(0.22, EventKind::Rests),
            event(0.5, EventKind::Leaves),
        ];
        let other = [
            impact(0.1, 1.0),
            impact(0.2, 0.0049),
            event(0.22, EventKind::Rests),
            event(0.3, EventKind::Leaves),
            impact(0.3, 1e-6),
            event(0.300_001, EventKind::Rests),
            event(0.5, EventKind::Leaves),
        ];
        let alignment = Alignment::new([&one, &other], 1e-4);
        assert_eq!(alignment.odd, None);
        assert_eq!(alignment.pairs, [[0, 0], [1, 1], [3, 2], [4, 6]]);
    }

    #[test]
    fn an_impact_that_is_missed_is_odd() {
        let one = [impact(0.1, 1.0), event(0.2, EventKind::Rests)];
        let other = [event(0.2, EventKind::Rests)];
        let alignment = Alignment::new([&one, &other], 1e-4);
        assert_eq!(alignment.odd.map(|(time, _)| time), Some(0.1));
    }
}
