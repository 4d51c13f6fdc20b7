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

use nalgebra::{Cholesky, DMatrix, DVector};

/// Part of the diagonal at which a pivot is rounding: the row depends on others.
const DEPENDENT: f64 = 1e-11;

/// Part of a rate that is its rounding.
const STILL_RATE: f64 = 1e-12;

/// A force that bounds hold, at the present step of the search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ActiveBound {
    Between,
    Lower,
    Upper,
}

/// Returns x for `w` and `b`, with bounds `[lower, upper]` that have 0 in them. `noise` is the part of
/// each `b` that is rounding.
///
/// # Errors
///
/// The places of the forces that grow for ever where none obey: contacts press on what does not give way.
///
/// Rows that depend on each other may disagree, where something is driven: no forces make all
/// c̈ = 0. ½ xᵀ W x + bᵀ x falls for ever then along an n with W n = 0, so that the forces go along it
/// until one meets its bound.
///
/// An active set is changed by one force at a time (Stark and Parker, Bounded-variable least squares):
/// each step lowers the minimum, so that it ends.
pub(super) fn solve(
    w: &DMatrix<f64>,
    b: &[f64],
    bounds: &[[f64; 2]],
    noise: &[f64],
) -> Result<DVector<f64>, Vec<usize>> {
    let count = b.len();
    let mut x = DVector::zeros(count);
    let mut places: Vec<ActiveBound> = bounds
        .iter()
        .map(|[lower, upper]| match (*lower < 0.0, *upper > 0.0) {
            (true, true) => ActiveBound::Between,
            (false, _) => ActiveBound::Lower,
            (true, false) => ActiveBound::Upper,
        })
        .collect();
    // Far more steps than any set of forces takes.
    for _ in 0..16 * count * count + 16 {
        descend(w, (b, noise), bounds, &mut x, &mut places)?;
        let gradient = w * &x;
        let scale = |k: usize| {
            let row = w.row(k);
            let products = row.iter().zip(&x).map(|(w, x)| (w * x).abs());
            STILL_RATE * products.fold(b[k].abs(), f64::max)
        };
        let violation = |k: usize| {
            let rate = gradient[k] + b[k];
            match places[k] {
                ActiveBound::Between => 0.0,
                ActiveBound::Lower if bounds[k][1] > bounds[k][0] => -rate,
                ActiveBound::Upper if bounds[k][1] > bounds[k][0] => rate,
                _ => 0.0,
            }
        };
        // A coordinate that does not give way is driven.
        let rounding = |k: usize| {
            if w[(k, k)] > 0.0 {
                scale(k)
            } else {
                scale(k).max(noise[k])
            }
        };
        let worst = (0..count)
            .filter(|&k| violation(k) > rounding(k))
            .max_by(|&i, &j| {
                let size = |k: usize| violation(k) / w[(k, k)].sqrt();
                size(i).total_cmp(&size(j))
            });
        match worst {
            Some(k) => places[k] = ActiveBound::Between,
            None => break,
        }
    }
    Ok(x)
}

/// Moves the forces between their bounds to the minimum; those that meet a bound on the way stay there.
///
/// # Errors
///
/// The forces that grow for ever where there is no minimum.
fn descend(
    w: &DMatrix<f64>,
    (b, noise): (&[f64], &[f64]),
    bounds: &[[f64; 2]],
    x: &mut DVector<f64>,
    places: &mut [ActiveBound],
) -> Result<(), Vec<usize>> {
    loop {
        let free: Vec<usize> = (0..b.len())
            .filter(|&k| places[k] == ActiveBound::Between)
            .collect();
        let (target, is_minimum) = minimum(w, (b, noise), x, &free);
        // The largest part of the way on which all stay between their bounds.
        let mut part = if is_minimum { 1.0 } else { f64::INFINITY };
        let mut met = None;
        for (&k, target) in free.iter().zip(&target) {
            let way = target - x[k];
            let (bound, place) = if way > 0.0 {
                (bounds[k][1], ActiveBound::Upper)
            } else {
                (bounds[k][0], ActiveBound::Lower)
            };
            let room = (bound - x[k]) / way;
            if way != 0.0 && room < part {
                (part, met) = (room.max(0.0), Some((k, bound, place)));
            }
        }
        if part == f64::INFINITY {
            let grows = free.iter().zip(&target);
            let grows = grows.filter(|(k, target)| (**target - x[**k]).abs() > 0.0);
            return Err(grows.map(|(&k, _)| k).collect());
        }
        for (&k, target) in free.iter().zip(&target) {
            x[k] += part * (target - x[k]);
        }
        let Some((k, bound, place)) = met else {
            return Ok(());
        };
        (x[k], places[k]) = (bound, place);
    }
}

/// Returns the free forces at the minimum, with the others as they are, and true. A force whose row
/// depends on those before it stays as it is. Without a minimum, returns forces on the way down, and
/// false.
fn minimum(
    w: &DMatrix<f64>,
    (b, noise): (&[f64], &[f64]),
    x: &DVector<f64>,
    free: &[usize],
) -> (Vec<f64>, bool) {
    let mut chosen: Vec<usize> = Vec::new();
    let mut factor = Cholesky::pack_dirty(DMatrix::zeros(0, 0));
    for &k in free {
        chosen.push(k);
        let trial = DMatrix::from_fn(chosen.len(), chosen.len(), |i, j| w[(chosen[i], chosen[j])]);
        let last = chosen.len() - 1;
        let found = trial.cholesky();
        match found.filter(|found| found.l_dirty()[(last, last)].powi(2) > DEPENDENT * w[(k, k)]) {
            Some(found) => factor = found,
            None => {
                chosen.pop();
            }
        }
    }
    let mut target: Vec<f64> = free.iter().map(|&k| x[k]).collect();
    let place_of = |k: usize| free.iter().position(|&f| f == k).expect("one of these");
    let solve = |side: &dyn Fn(usize) -> f64| {
        let side = chosen.iter().map(|&k| side(k));
        factor.solve(&DVector::from_iterator(chosen.len(), side))
    };
    for &k in free.iter().filter(|k| !chosen.contains(k)) {
        // W n = 0, with 1 at k.
        let others = solve(&|row| -w[(row, k)]);
        let others = chosen.iter().copied().zip(others.iter().copied());
        let n: Vec<(usize, f64)> = others.chain([(k, 1.0)]).collect();
        let slope: f64 = n.iter().map(|(j, part)| b[*j] * part).sum();
        let rounding =
            |(j, part): &(usize, f64)| (STILL_RATE * b[*j].abs() + noise[*j]) * part.abs();
        if slope.abs() > n.iter().map(rounding).sum() {
            for (j, part) in n {
                target[place_of(j)] -= slope.signum() * part;
            }
            return (target, false);
        }
    }
    let of_fixed = |row: usize| {
        let fixed = (0..b.len()).filter(|k| !chosen.contains(k));
        fixed.map(|k| w[(row, k)] * x[k]).sum::<f64>()
    };
    let found = solve(&|row| -b[row] - of_fixed(row));
    for (&k, value) in chosen.iter().zip(&found) {
        target[place_of(k)] = *value;
    }
    (target, true)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PUSH: [f64; 2] = [0.0, f64::INFINITY];

    fn assert_force(w: &DMatrix<f64>, b: f64, bounds: [f64; 2], force: f64) {
        let found = solve(w, &[b], &[bounds], &[0.0]).expect("forces exist")[0];
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
        let bounds = [[-1.0, 1.0], [-1.0, 1.0]];
        let x = solve(&w, &[1.5, 1.5], &bounds, &[0.0; 2]).expect("forces exist");
        assert!((x[0] + x[1] + 1.5).abs() < 1e-15, "{x}");
    }

    /// A block that the ground holds by 10, and a plate that slides on it by 2: the rows depend on each
    /// other and disagree.
    #[test]
    fn dependent_frictions_that_disagree_slide() {
        let w = DMatrix::from_element(2, 2, 1.0);
        let bounds = [[-10.0, 10.0], [-2.0, 2.0]];
        let x = solve(&w, &[5.0, 7.5], &bounds, &[0.0; 2]).expect("forces exist");
        assert!(
            (x[0] + 3.0).abs() < 1e-15 && (x[1] + 2.0).abs() < 1e-15,
            "{x}"
        );
        let x = solve(&w, &[9.0, 6.5], &bounds, &[0.0; 2]).expect("forces exist");
        assert!(
            (x[0] + 10.0).abs() < 1e-15 && (x[1] - 2.0).abs() < 1e-15,
            "{x}"
        );
    }

    /// Two driven jaws close on a part: no push opens them.
    #[test]
    fn contacts_that_squeeze_have_no_forces() {
        let w = DMatrix::from_row_slice(2, 2, &[1.0, -1.0, -1.0, 1.0]);
        let squeezed = solve(&w, &[-1.0, -1.0], &[PUSH, PUSH], &[0.0; 2]);
        assert_eq!(squeezed, Err(vec![0, 1]));
        assert!(solve(&w, &[-1.0, 2.0], &[PUSH, PUSH], &[0.0; 2]).is_ok());
        let still = DMatrix::zeros(1, 1);
        assert!(solve(&still, &[-1.0], &[PUSH], &[0.0]).is_err());
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
            let noise = vec![0.0; count];
            let x = solve(&w, b.as_slice(), &bounds, &noise).expect("b is in the range");
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
