//! Forces between bounds: those of contacts, which only push, and of friction that sticks.
//!
//! With x for the forces along some coordinates c, W = ∂c̈/∂x and b for c̈ without them, each force and
//! its coordinate obey one of
//!
//! > c̈ = 0 between the bounds, c̈ ≥ 0 at the lower one, c̈ ≤ 0 at the upper one
//!
//! Contacts have the bounds 0 and ∞: the linear complementarity problem. W is symmetric and has no
//! negative eigenvalue, so that x minimises ½ xᵀ W x + bᵀ x between the bounds, and c̈ is unique. The
//! same holds for impulses and the velocities after an impact.

use nalgebra::{DMatrix, DVector};

/// Part of the diagonal at which a pivot is rounding: the row depends on others.
const DEPENDENT: f64 = 1e-11;

/// A force that bounds hold, at the present step of the search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    Between,
    Lower,
    Upper,
}

/// Returns x for `w` and `b`, with bounds `[lower, upper]` that have 0 in them.
///
/// An active set is changed by one force at a time (Stark and Parker, Bounded-variable least squares):
/// each step lowers the minimum, so that it ends.
pub(super) fn solve(w: &DMatrix<f64>, b: &[f64], bounds: &[[f64; 2]]) -> DVector<f64> {
    let count = b.len();
    let mut x = DVector::zeros(count);
    let mut places: Vec<Place> = bounds
        .iter()
        .map(|[lower, upper]| match (*lower < 0.0, *upper > 0.0) {
            (true, true) => Place::Between,
            (false, _) => Place::Lower,
            (true, false) => Place::Upper,
        })
        .collect();
    // Far more steps than any set of forces takes.
    for _ in 0..16 * count * count + 16 {
        descend(w, b, bounds, &mut x, &mut places);
        let gradient = w * &x;
        let scale = |k: usize| {
            let row = w.row(k);
            let products = row.iter().zip(&x).map(|(w, x)| (w * x).abs());
            1e-12 * products.fold(b[k].abs(), f64::max)
        };
        let violation = |k: usize| {
            let rate = gradient[k] + b[k];
            match places[k] {
                Place::Between => 0.0,
                Place::Lower if bounds[k][1] > bounds[k][0] => -rate,
                Place::Upper if bounds[k][1] > bounds[k][0] => rate,
                _ => 0.0,
            }
        };
        let worst = (0..count)
            .filter(|&k| violation(k) > scale(k) && w[(k, k)] > 0.0)
            .max_by(|&i, &j| {
                let size = |k: usize| violation(k) / w[(k, k)].sqrt();
                size(i).total_cmp(&size(j))
            });
        match worst {
            Some(k) => places[k] = Place::Between,
            None => break,
        }
    }
    x
}

/// Moves the forces between their bounds to the minimum; those that meet a bound on the way stay there.
fn descend(
    w: &DMatrix<f64>,
    b: &[f64],
    bounds: &[[f64; 2]],
    x: &mut DVector<f64>,
    places: &mut [Place],
) {
    loop {
        let free: Vec<usize> = (0..b.len())
            .filter(|&k| places[k] == Place::Between)
            .collect();
        let target = minimum(w, b, x, &free);
        // The largest part of the way on which all stay between their bounds.
        let mut part = 1.0;
        let mut met = None;
        for (&k, target) in free.iter().zip(&target) {
            let way = target - x[k];
            let (bound, place) = match way > 0.0 {
                true => (bounds[k][1], Place::Upper),
                false => (bounds[k][0], Place::Lower),
            };
            let room = (bound - x[k]) / way;
            if way != 0.0 && room < part {
                (part, met) = (room.max(0.0), Some((k, bound, place)));
            }
        }
        for (&k, target) in free.iter().zip(&target) {
            x[k] += part * (target - x[k]);
        }
        let Some((k, bound, place)) = met else { return };
        (x[k], places[k]) = (bound, place);
    }
}

/// Returns the free forces at the minimum, with the others as they are. A force whose row depends on
/// those before it stays as it is.
fn minimum(w: &DMatrix<f64>, b: &[f64], x: &DVector<f64>, free: &[usize]) -> Vec<f64> {
    let mut chosen: Vec<usize> = Vec::new();
    let mut matrix = DMatrix::zeros(0, 0);
    for &k in free {
        chosen.push(k);
        let trial = DMatrix::from_fn(chosen.len(), chosen.len(), |i, j| w[(chosen[i], chosen[j])]);
        let factor = trial.clone().cholesky();
        let pivot = factor.map_or(0.0, |factor| {
            factor.l_dirty()[(chosen.len() - 1, chosen.len() - 1)]
        });
        if pivot * pivot > DEPENDENT * w[(k, k)] {
            matrix = trial;
        } else {
            chosen.pop();
        }
    }
    let mut target: Vec<f64> = free.iter().map(|&k| x[k]).collect();
    let others = |row: usize| {
        let fixed = (0..b.len()).filter(|k| !chosen.contains(k));
        fixed.map(|k| w[(row, k)] * x[k]).sum::<f64>()
    };
    let side = DVector::from_iterator(chosen.len(), chosen.iter().map(|&k| -b[k] - others(k)));
    if let Some(found) = matrix.cholesky().map(|factor| factor.solve(&side)) {
        for (&k, value) in chosen.iter().zip(&found) {
            let place = free
                .iter()
                .position(|&f| f == k)
                .expect("chosen from these");
            target[place] = *value;
        }
    }
    target
}

#[cfg(test)]
mod tests {
    use super::*;

    const PUSH: [f64; 2] = [0.0, f64::INFINITY];

    fn assert_force(w: &DMatrix<f64>, b: f64, bounds: [f64; 2], force: f64) {
        let found = solve(w, &[b], &[bounds])[0];
        assert!((found - force).abs() < 1e-14, "{found} {force}");
    }

    #[test]
    fn a_contact_pushes_or_opens() {
        let w = DMatrix::from_element(1, 1, 0.5);
        assert_force(&w, -9.81, PUSH, 19.62);
        assert_force(&w, 9.81, PUSH, 0.0);
    }

    #[test]
    fn friction_sticks_within_its_limit() {
        let w = DMatrix::from_element(1, 1, 1.0);
        assert_force(&w, 1.5, [-2.0, 2.0], -1.5);
        assert_force(&w, 2.5, [-2.0, 2.0], -2.0);
        assert_force(&w, -2.5, [-2.0, 2.0], 2.0);
    }

    /// Two frictions on one coordinate: neither alone holds it, both do.
    #[test]
    fn dependent_frictions_hold_together() {
        let w = DMatrix::from_element(2, 2, 1.0);
        let x = solve(&w, &[1.5, 1.5], &[[-1.0, 1.0], [-1.0, 1.0]]);
        assert!((x[0] + x[1] + 1.5).abs() < 1e-15, "{x}");
    }

    /// The conditions hold for many random forces: they have no other solution for c̈.
    #[test]
    fn the_conditions_hold() {
        let mut seed = 1_u64;
        let mut random = move || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        for case in 0..2000 {
            let (count, rank) = (1 + case % 6, 1 + case % 4);
            let rows = DMatrix::from_fn(count, rank, |_, _| random());
            let w = &rows * rows.transpose();
            // In the range of the rows, as accelerations are.
            let b = &rows * DVector::from_fn(rank, |_, _| random());
            let bounds: Vec<[f64; 2]> = (0..count)
                .map(|k| match k % 2 {
                    0 => PUSH,
                    _ => [-0.3, 0.3],
                })
                .collect();
            let x = solve(&w, b.as_slice(), &bounds);
            let rates = &w * &x + &b;
            for k in 0..count {
                let [lower, upper] = bounds[k];
                assert!(lower <= x[k] && x[k] <= upper, "case {case}: {x}");
                if x[k] > lower {
                    assert!(rates[k] <= 1e-9, "case {case}: {x} {rates}");
                }
                if x[k] < upper {
                    assert!(rates[k] >= -1e-9, "case {case}: {x} {rates}");
                }
            }
        }
    }
}
