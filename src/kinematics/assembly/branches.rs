//! The ways in which one kernel closes behind those before it, one after the other.

use nalgebra::DVector;

use super::loops::{AllWays, all_ways};
use crate::kinematics::assembly::least_squares::{ATTEMPTS, MAX_ITERATIONS, Part};
use crate::kinematics::block::{Kernel, Miss, Work};
use crate::kinematics::constraint::{Gradient, Region};
use crate::kinematics::newton::Correction;

/// How hard to look for ways where neither a closed form nor bounds give them all.
#[derive(Clone, Copy, Debug)]
pub(in crate::kinematics) enum Effort {
    /// At and near the estimates.
    Near,
    /// From so many places anywhere as well.
    Anywhere(usize),
}

/// The ways in which a kernel closes, nearest the estimates first as far as that is known.
#[derive(Debug)]
pub(in crate::kinematics) struct Ways {
    source: Source,
    /// How many it has given.
    pub(super) given: usize,
    /// From how many starts it has looked for them.
    pub(in crate::kinematics) starts: usize,
    /// How many of them led to none.
    failures: usize,
}

/// Where ways come from.
#[derive(Debug)]
enum Source {
    /// Unknowns that follow from what was found before.
    Explicit,
    /// The angles of a dyad, or that of a slide.
    ClosedForm([[f64; 2]; 2]),
    /// Minimisation and Newton–Raphson from several starts.
    Starts {
        part: Part,
        most: usize,
        /// Whether the rows are linear, once another way has been asked for.
        linear: Option<bool>,
        found: Vec<DVector<f64>>,
        /// The ways that bounds give, once the starts near the estimates are used up.
        all: Option<AllWays>,
    },
    /// A closed form that misses: there are none.
    None(Miss),
}

impl Ways {
    /// Those of a kernel; all that it reads is found in `work`.
    pub(in crate::kinematics) fn new(
        kernel: &Kernel,
        work: &mut Work<'_>,
        estimate: &[f64],
        effort: Effort,
    ) -> Self {
        let found = match kernel {
            Kernel::Pinned(_) | Kernel::Interpolated(_) => Ok(Source::Explicit),
            Kernel::RrrDyad(dyad) => dyad.ways(work, estimate).map(Source::ClosedForm),
            Kernel::RrpDyad(slide) => {
                let ways = slide.ways(work, estimate);
                ways.map(|[first, second]| Source::ClosedForm([[first, 0.0], [second, 0.0]]))
            }
            Kernel::Coupled(kernel) => Ok(Source::Starts {
                part: Part::new(kernel.rows(), kernel.columns()),
                linear: None,
                most: match effort {
                    Effort::Near => ATTEMPTS,
                    Effort::Anywhere(starts) => ATTEMPTS + starts,
                },
                found: Vec::new(),
                all: None,
            }),
        };
        Self {
            source: found.unwrap_or_else(Source::None),
            given: 0,
            starts: 0,
            failures: 0,
        }
    }

    /// Whether there are no others than those it has given, once it gives no more.
    pub(in crate::kinematics) fn is_complete(&self) -> bool {
        match &self.source {
            Source::Explicit => true,
            // What a closed form promises has to be there.
            Source::ClosedForm(_) => self.failures == 0,
            Source::Starts { linear, all, .. } => {
                let listed = all.as_ref().is_some_and(|all| all.ways.is_some());
                *linear == Some(true) || listed && self.failures == 0
            }
            Source::None(miss) => miss.certain,
        }
    }

    /// Into how many boxes angles were divided for bounds.
    pub(in crate::kinematics) fn boxes(&self) -> usize {
        match &self.source {
            Source::Starts { all: Some(all), .. } => all.boxes,
            _ => 0,
        }
    }

    /// By how much a kernel in closed form misses that gave no way \[m\].
    pub(super) fn gap(&self) -> Option<f64> {
        match &self.source {
            Source::Explicit | Source::Starts { .. } => None,
            // It was close enough for rounding to decide.
            Source::ClosedForm(_) => Some(0.0),
            Source::None(miss) => Some(miss.gap),
        }
    }

    /// Puts the kernel, in `work`, in the next of its ways; `None` if there is no other.
    pub(in crate::kinematics) fn next(
        &mut self,
        kernel: &mut Kernel,
        work: &mut Work<'_>,
        estimate: &[f64],
    ) -> Option<Correction> {
        loop {
            let attempt = self.starts;
            let corrected = match (&mut self.source, &mut *kernel) {
                (Source::Explicit, kernel) if attempt == 0 => kernel.close(work, MAX_ITERATIONS),
                (Source::ClosedForm(ways), Kernel::RrrDyad(kernel)) if attempt < ways.len() => {
                    kernel.close_from(work, ways[attempt], MAX_ITERATIONS)
                }
                (Source::ClosedForm(ways), Kernel::RrpDyad(kernel)) if attempt < ways.len() => {
                    kernel.close_from(work, ways[attempt][0], MAX_ITERATIONS)
                }
                (
                    Source::Starts {
                        part,
                        most,
                        linear,
                        found,
                        all,
                    },
                    Kernel::Coupled(kernel),
                ) => {
                    if self.given > 0
                        && *linear
                            .get_or_insert_with(|| is_linear(kernel.rows(), kernel.columns(), work))
                    {
                        return None;
                    }
                    let far = attempt.checked_sub(ATTEMPTS);
                    if far.is_some() && all.is_none() {
                        let (rows, columns) = (&part.rows, part.columns());
                        *all = Some(all_ways(rows, columns, work, estimate));
                        // From here on a failure is one to close where a way was promised.
                        self.failures = 0;
                    }
                    let listed = all.as_ref().and_then(|all| all.ways.as_ref());
                    let mut correct = |work: &mut Work<'_>, most| kernel.correct(work, most);
                    let corrected = match (far, listed) {
                        (None, _) => part.attempt(work, estimate, attempt, correct),
                        (Some(far), Some(listed)) => {
                            let way = listed.get(far)?;
                            part.write(work, &DVector::from_column_slice(way));
                            correct(work, MAX_ITERATIONS)
                        }
                        (Some(far), None) if attempt < *most => {
                            part.attempt_anywhere(work, estimate, far, correct)
                        }
                        _ => return None,
                    };
                    if corrected.is_ok() {
                        let unknowns = part.read(work);
                        if found
                            .iter()
                            .any(|known| part.is_same(work, known, &unknowns))
                        {
                            self.starts += 1;
                            continue;
                        }
                        found.push(unknowns);
                    }
                    corrected
                }
                _ => return None,
            };
            self.starts += 1;
            match corrected {
                Ok(correction) => {
                    self.given += 1;
                    return Some(correction);
                }
                Err(_) => self.failures += 1,
            }
        }
    }
}

/// Whether the rows are linear in the unknowns, so that there is one way at the most.
fn is_linear(rows: &[usize], columns: &[usize], work: &Work<'_>) -> bool {
    let size = work.at.size();
    let unknowns = work.system.unknowns();
    let (mut radii, mut direction) = (vec![0.0; unknowns], vec![0.0; unknowns]);
    for &column in columns {
        let scale = work.system.column_scale(column, size);
        (radii[column], direction[column]) = (scale, scale);
    }
    let region = Region { radii: &radii };
    rows.iter().all(|&row| {
        let constraint = &work.system.equations()[row].constraint;
        let bend = constraint.bend(work.at, &region, &direction, &mut Gradient::new());
        bend.is_some_and(|bend| bend <= 0.0)
    })
}
