//! All the branches in which a block closes, by bounds over intervals: its angles are divided into
//! boxes until each holds no solution, as an equation has a bound that keeps it from zero, or
//! exactly one, by Krawczyk's test.
//!
//! Given the angles, the rows that hold points together give x and y of each body as a sum of
//! constants and of waves α cos φ + β sin φ, one an angle, whose range over an interval is known
//! in closed form. The rows that are left must be zero. An angle that only says where a link of a
//! known length points is eliminated as well: its two rows become one, of a distance.

mod eliminate;
mod form;

use std::f64::consts::{PI, TAU};

use eliminate::Builder;
use form::Closure;
use nalgebra::DMatrix;

use crate::kinematics::block::BlockState;
use crate::mechanism::{Interval, Number};

/// A block of more unknowns has too many angles for boxes.
const MOST_UNKNOWNS: usize = 60;
/// Into so many boxes angles are divided at the most.
const MOST_BOXES: usize = 10_000;
/// A box narrower than this \[rad\] is not divided: there the block nearly closes, or closes in a
/// nearly singular position.
const NARROWEST: f64 = 1e-6;
/// Krawczyk's test is of use in boxes narrower than this \[rad\].
const NARROW: f64 = 1.0;
/// By how much of its width a box is enlarged for that test: a solution may lie on its edge.
const ENLARGED: f64 = 0.1;
/// Angles that differ by less than this, in boxes known to hold one solution, are of the same.
const SAME: f64 = 1e-7;
/// A gap below this, scaled, may be rounding.
const MARGIN: f64 = 1e-10;

/// The branches in which a block closes.
#[derive(Debug)]
pub(super) struct AllBranches {
    /// The unknowns in the order of the block's columns, near a solution each; all there are.
    /// `None` if that could not be proved.
    pub(super) branches: Option<Vec<Vec<f64>>>,
    /// Into how many boxes the angles were divided.
    pub(super) boxes: usize,
}

/// Finds all branches in which the rows close in the unknowns `columns`. All other unknowns are known
/// in `work`.
pub(super) fn all_branches(
    rows: &[usize],
    columns: &[usize],
    work: &BlockState<'_>,
    estimate: &[f64],
) -> AllBranches {
    let unknown = AllBranches {
        branches: None,
        boxes: 0,
    };
    let bodies = work.system.mechanism().bodies.len();
    let from_joints = columns.iter().any(|&column| column >= 3 * bodies);
    if from_joints || columns.len() > MOST_UNKNOWNS {
        return unknown;
    }
    let mut builder = Builder::new(rows, columns, work);
    let Some(loops) = builder.loops() else {
        return unknown;
    };
    let (solutions, boxes) = loops.solve();
    let branches = solutions.and_then(|solutions| {
        let at = |angles: &Vec<f64>| builder.unknowns(columns, &loops.kept, angles, estimate);
        solutions.iter().map(at).collect()
    });
    AllBranches { branches, boxes }
}

/// The equations of a block in its torn angles.
#[derive(Debug)]
struct Loops {
    /// The torn angles that are left.
    kept: Vec<usize>,
    closures: Vec<Closure>,
    /// What a row may be off by \[m\].
    margin: f64,
}

/// What is known of a box of angles.
enum Content {
    /// It holds no solution.
    None,
    /// A box around it holds exactly one, near here.
    One(Vec<f64>),
    Unknown,
}

impl Loops {
    /// All solutions in the angles kept, or `None` if some box could not be decided, and the
    /// number of boxes.
    fn solve(&self) -> (Option<Vec<Vec<f64>>>, usize) {
        let half_turn = PI.next_up();
        let mut boxes = vec![vec![Interval::new(-half_turn, half_turn); self.kept.len()]];
        let mut solutions: Vec<Vec<f64>> = Vec::new();
        let mut count = 0;
        let width = |angle: &Interval| angle.high - angle.low;
        while let Some(angles) = boxes.pop() {
            count += 1;
            match self.content(&angles) {
                Content::None => continue,
                Content::One(found) => {
                    let same = |known: &Vec<f64>| {
                        let mut pairs = known.iter().zip(&found);
                        pairs.all(|(a, b)| (a - b - TAU * ((a - b) / TAU).round()).abs() < SAME)
                    };
                    if !solutions.iter().any(same) {
                        solutions.push(found);
                    }
                    continue;
                }
                Content::Unknown => {}
            }
            let widest = (0..angles.len()).max_by(|&a, &b| {
                let widths = [a, b].map(|k| width(&angles[k]));
                widths[0].total_cmp(&widths[1]).then(b.cmp(&a))
            });
            let widest = widest.filter(|&k| width(&angles[k]) > NARROWEST);
            let Some(widest) = widest.filter(|_| count + boxes.len() < MOST_BOXES) else {
                return (None, count);
            };
            let middle = angles[widest].midpoint();
            let (mut low, mut high) = (angles.clone(), angles);
            low[widest] = Interval::new(low[widest].low, middle);
            high[widest] = Interval::new(middle, high[widest].high);
            boxes.extend([high, low]);
        }
        (Some(solutions), count)
    }

    fn content(&self, angles: &[Interval]) -> Content {
        let mut rows = self.closures.iter();
        if rows.any(|row| row.excludes(angles, self.margin)) {
            return Content::None;
        }
        if self.kept.is_empty() {
            return Content::One(Vec::new());
        }
        let narrow = angles.iter().all(|angle| angle.high - angle.low < NARROW);
        let mut around: Vec<_> = angles
            .iter()
            .map(|angle| {
                let more = ENLARGED * (angle.high - angle.low);
                Interval::new(angle.low - more, angle.high + more)
            })
            .collect();
        let Some(inner) = (narrow && self.closures.len() == self.kept.len())
            .then(|| self.contract(&around))
            .flatten()
        else {
            return Content::Unknown;
        };
        let misses = |(inner, around): (&Interval, &Interval)| {
            inner.low > around.high || inner.high < around.low
        };
        if inner.iter().zip(&around).any(misses) {
            return Content::None;
        }
        let inside = |(inner, around): (&Interval, &Interval)| {
            inner.low > around.low && inner.high < around.high
        };
        if !inner.iter().zip(&around).all(inside) {
            return Content::Unknown;
        }
        // The solution stays in, however often it is contracted.
        around = inner;
        for _ in 0..4 {
            if let Some(inner) = self.contract(&around) {
                let both = around.iter().zip(inner).map(|(a, b)| a.intersection(b));
                let both: Vec<_> = both.collect();
                if both.iter().all(|angle| angle.is_finite()) {
                    around = both;
                }
            }
        }
        Content::One(around.iter().map(|angle| angle.midpoint()).collect())
    }

    /// Krawczyk's operator: m − Y f(m) + (1 − Y J)(x − m) contains all solutions in the box x, m
    /// being its middle and Y near the inverse of J(m). Inside x it proves that there is one and
    /// only one.
    fn contract(&self, angles: &[Interval]) -> Option<Vec<Interval>> {
        let order = self.kept.len();
        let middle: Vec<_> = angles
            .iter()
            .map(|x| Interval::point(x.midpoint()))
            .collect();
        let slope = |row: usize, col: usize, at: &[Interval]| self.closures[row].slope(col, at);
        let inverse =
            DMatrix::from_fn(order, order, |row, col| slope(row, col, &middle).midpoint())
                .try_inverse()?;
        let values: Vec<_> = self.closures.iter().map(|row| row.over(&middle)).collect();
        let slopes: Vec<Vec<_>> = (0..order)
            .map(|row| (0..order).map(|col| slope(row, col, angles)).collect())
            .collect();
        let zero = Interval::point(0.0);
        let contracted: Vec<_> = (0..order)
            .map(|k| {
                let newton =
                    (0..order).fold(middle[k], |sum, row| sum - values[row] * inverse[(k, row)]);
                (0..order).fold(newton, |sum, col| {
                    let product = (0..order)
                        .fold(zero, |sum, row| sum + slopes[row][col] * inverse[(k, row)]);
                    let unit = Interval::point(f64::from(u8::from(k == col)));
                    sum + (unit - product) * (angles[col] - middle[col])
                })
            })
            .collect();
        contracted
            .iter()
            .all(|x| x.is_finite())
            .then_some(contracted)
    }
}
