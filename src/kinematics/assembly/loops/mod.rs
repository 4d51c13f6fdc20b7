//! All branches of a block, by bounds over intervals: boxes of angles are divided until each holds
//! no solution, because an equation is bounded away from zero in it, or exactly one, by Krawczyk's
//! test.
//!
//! Given the angles, the rows that hold points together give x and y of each body as a sum of
//! constants and of waves α cos φ + β sin φ, one per angle, whose range over an interval is known
//! in closed form. The rows that are left must be zero. An angle that only gives the direction of
//! a link of a known length is eliminated as well: its two rows become one row of a distance.

mod eliminate;
mod form;

use std::f64::consts::PI;

use eliminate::Builder;
use form::Closure;
use nalgebra::DMatrix;

use crate::kinematics::constraint::configuration::on_nearest_turn;
use crate::kinematics::plan::BlockState;
use crate::mechanism::{Interval, Number};

/// Most unknowns of a block whose angles are divided into boxes.
const MOST_UNKNOWNS: usize = 60;
/// Most boxes of angles.
const MOST_BOXES: usize = 10_000;
/// Most terms of bounds of a block, some tens of nanoseconds each: as many as that many boxes of six
/// angles have.
const MOST_TERMS: usize = 4_000_000;
/// Width of a box that is not divided \[rad\]: there the block nearly closes, or closes in a nearly
/// singular position.
const NARROWEST: f64 = 1e-6;
/// Largest width of a box for Krawczyk's test \[rad\].
const WIDEST_TESTED: f64 = 1.0;
/// Part of its width by which a box is enlarged for that test: a solution may lie on its edge.
const ENLARGED: f64 = 0.1;
/// Largest difference of angles, in boxes known to hold one solution, that are the same solution.
const SAME_SOLUTION: f64 = 1e-7;

/// The branches of a block.
#[derive(Debug)]
pub(super) struct AllBranches {
    /// The unknowns, in the order of the block's columns, near each solution; `None` if it could
    /// not be proved that there are no others.
    pub(super) branches: Option<Vec<Vec<f64>>>,
    /// Number of boxes into which the angles were divided.
    pub(super) boxes: usize,
    /// Number of terms of the bounds in these boxes.
    pub(super) terms: usize,
}

/// Finds all branches of the rows in the unknowns `columns`. All other unknowns are known in
/// `state`.
pub(super) fn all_branches(
    rows: &[usize],
    columns: &[usize],
    state: &BlockState<'_>,
    estimate: &[f64],
) -> AllBranches {
    let unknown = AllBranches {
        branches: None,
        boxes: 0,
        terms: 0,
    };
    let bodies = state.system.mechanism().bodies.len();
    let from_joints = columns.iter().any(|&column| column >= 3 * bodies);
    if from_joints || columns.len() > MOST_UNKNOWNS {
        return unknown;
    }
    let mut builder = Builder::new(rows, columns, state);
    let Some(loops) = builder.loops() else {
        return unknown;
    };
    let (solutions, boxes) = loops.solve();
    let terms = boxes * loops.terms_per_box();
    let branches = solutions.and_then(|solutions| {
        let at = |angles: &Vec<f64>| builder.unknowns(columns, &loops.kept, angles, estimate);
        solutions.iter().map(at).collect()
    });
    AllBranches {
        branches,
        boxes,
        terms,
    }
}

/// The equations of a block in its torn angles.
#[derive(Debug)]
struct Loops {
    /// The torn angles that are not eliminated.
    kept: Vec<usize>,
    closures: Vec<Closure>,
    /// Bound of the rounding of a row \[m\].
    margin: f64,
}

/// The content of a box of angles.
enum Content {
    /// No solution.
    None,
    /// Exactly one solution in a box around it, near these angles.
    One(Vec<f64>),
    Unknown,
}

impl Loops {
    /// Returns the number of terms of the bounds in a box: values and slopes of the rows, and the
    /// products of Krawczyk's test.
    fn terms_per_box(&self) -> usize {
        let (rows, angles) = (self.closures.len(), self.kept.len());
        4 * rows * angles + angles.pow(3)
    }

    /// Returns all solutions in the angles kept, or `None` if some box could not be decided, and
    /// the number of boxes.
    fn solve(&self) -> (Option<Vec<Vec<f64>>>, usize) {
        let half_turn = PI.next_up();
        let mut boxes = vec![vec![Interval::new(-half_turn, half_turn); self.kept.len()]];
        let mut solutions: Vec<Vec<f64>> = Vec::new();
        let mut count = 0;
        let most = MOST_BOXES.min(MOST_TERMS / self.terms_per_box().max(1));
        let width = |angle: &Interval| angle.high - angle.low;
        while let Some(angles) = boxes.pop() {
            count += 1;
            match self.content(&angles) {
                Content::None => continue,
                Content::One(found) => {
                    let same = |known: &Vec<f64>| {
                        let mut pairs = known.iter().zip(&found);
                        pairs.all(|(a, b)| on_nearest_turn(a - b, 0.0).abs() < SAME_SOLUTION)
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
            let Some(widest) = widest.filter(|_| count + boxes.len() < most) else {
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

    /// Returns the content of a box.
    fn content(&self, angles: &[Interval]) -> Content {
        let mut rows = self.closures.iter();
        if rows.any(|row| row.excludes(angles, self.margin)) {
            return Content::None;
        }
        if self.kept.is_empty() {
            return Content::One(Vec::new());
        }
        let narrow = angles
            .iter()
            .all(|angle| angle.high - angle.low < WIDEST_TESTED);
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
        // Each contraction keeps the solution.
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

    /// Applies Krawczyk's operator: m − Y f(m) + (1 − Y J)(x − m), with the middle m of the box x
    /// and Y near the inverse of J(m), contains all solutions in x. If it lies inside x, there is
    /// one and only one.
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

#[cfg(test)]
mod tests {
    use super::form::Form;
    use super::{Closure, Interval, Loops, MOST_TERMS};

    /// Returns rows Σ cos φ = 0 in this number of angles, which have solutions everywhere.
    fn undecided(angles: usize) -> Loops {
        let [zero, one] = [0.0, 1.0].map(Interval::point);
        let row = || Form {
            constant: zero,
            waves: vec![[one, zero]; angles],
        };
        Loops {
            kept: (0..angles).collect(),
            closures: (0..angles).map(|_| Closure::Sum(row())).collect(),
            margin: 1e-10,
        }
    }

    /// The bounds of a box in many angles have more terms: fewer boxes are looked at.
    #[test]
    fn many_angles_take_no_longer_than_few() {
        for angles in [3, 6, 12, 24] {
            let loops = undecided(angles);
            let (solutions, boxes) = loops.solve();
            assert!(solutions.is_none(), "{angles}");
            let terms = boxes * loops.terms_per_box();
            assert!(terms <= MOST_TERMS, "{angles}: {boxes} boxes");
        }
    }
}
