//! Largest sizes of a quantity over samples, refined between them.

/// A size that is sought, and what belongs to it, such as its joint.
pub(super) type Measured<T> = (f64, T);

/// A largest size over the range of a driver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Largest<T> {
    /// A size, and the driver's value there.
    Value(Measured<T>, f64),
    /// None: the size grows without bound towards this value of the driver.
    Unbounded(f64),
}

/// Most peaks of the samples that are refined. Others are smaller in the samples.
const MOST_PEAKS: usize = 4;

/// Ratio of the golden section.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Width of the last interval, as a part of the first. A smooth maximum has its value to rounding
/// far earlier, a pole is far above its surroundings.
const LAST_WIDTH: f64 = 1e-9;

/// Distance from the place found at which a smooth quantity has the same value, as a part of the
/// first interval.
const NEAR: f64 = 1e-5;

/// Part of the range below which a place is zero: a flat maximum has half of the digits.
const FLAT: f64 = 1e-7;

/// Least ratio of a pole to a size that nine in ten samples keep below: a pole of a square root is
/// some ten thousand times as high where the search ends, rounding is as high as other rounding.
const TALL: f64 = 100.0;

/// Returns the largest size among samples, ascending in the driver's value, and between the
/// neighbours of their highest peaks, where `at` gives it; `None` without any. Sizes that do not
/// exist are `None`.
pub(super) fn largest<T: Copy>(
    samples: &[(f64, Option<Measured<T>>)],
    mut at: impl FnMut(f64) -> Option<Measured<T>>,
) -> Option<Largest<T>> {
    let of = |index: usize| size(samples[index].1);
    let last = samples.len().checked_sub(1)?;
    let is_peak = |&index: &usize| {
        samples[index].1.is_some()
            && (index == 0 || of(index) > of(index - 1))
            && (index == last || of(index) >= of(index + 1))
    };
    let usual = usual(samples);
    let rounding = FLAT * (samples[last].0 - samples[0].0);
    let rounded = |place: f64| if place.abs() < rounding { 0.0 } else { place };
    let mut peaks: Vec<usize> = (0..=last).filter(is_peak).collect();
    peaks.sort_by(|a, b| of(*b).total_cmp(&of(*a)));
    let mut most = None;
    for &peak in peaks.iter().take(MOST_PEAKS) {
        match climb(samples, peak, usual, &mut at)? {
            Largest::Value(found, there) if size(Some(found)) > size(most.map(|(m, _)| m)) => {
                most = Some((found, there));
            }
            Largest::Value(..) => {}
            Largest::Unbounded(there) => return Some(Largest::Unbounded(rounded(there))),
        }
    }
    most.map(|(most, place)| Largest::Value(most, rounded(place)))
}

/// Returns the size, below all others where there is none.
fn size<T>(of: Option<Measured<T>>) -> f64 {
    of.map_or(f64::NEG_INFINITY, |(size, _)| size)
}

/// Returns a size that nine in ten samples keep below, without regard to sign; those of zero do not
/// count.
fn usual<T: Copy>(samples: &[(f64, Option<Measured<T>>)]) -> f64 {
    let sizes = samples.iter().filter_map(|(_, sample)| *sample);
    let sizes = sizes.map(|(size, _)| size.abs());
    let mut sizes: Vec<f64> = sizes.filter(|size| *size > 0.0).collect();
    sizes.sort_by(f64::total_cmp);
    sizes.get(9 * sizes.len() / 10).copied().unwrap_or(0.0)
}

/// Returns the largest size between the samples beside a peak, or at the peak, by golden section:
/// right where there is one peak. `None` if the peak has no size.
fn climb<T: Copy>(
    samples: &[(f64, Option<Measured<T>>)],
    peak: usize,
    usual: f64,
    at: &mut impl FnMut(f64) -> Option<Measured<T>>,
) -> Option<Largest<T>> {
    let beside = [peak.saturating_sub(1), (samples.len() - 1).min(peak + 1)];
    let [low, high] = beside.map(|index| samples[index].0);
    let width = high - low;
    let [mut a, mut b] = [low, high];
    let mut inner = [b - GOLDEN * width, a + GOLDEN * width];
    let mut found = inner.map(&mut *at);
    // Samples may be a rounding apart.
    while b - a > LAST_WIDTH * width && a < inner[0] && inner[0] < inner[1] && inner[1] < b {
        if size(found[0]) >= size(found[1]) {
            b = inner[1];
            inner = [b - GOLDEN * (b - a), inner[0]];
            found = [at(inner[0]), found[0]];
        } else {
            a = inner[0];
            inner = [inner[1], a + GOLDEN * (b - a)];
            found = [found[1], at(inner[1])];
        }
    }
    let best = usize::from(size(found[1]) > size(found[0]));
    let (mut place, mut most) = (inner[best], found[best]);
    let (of_peak, sample) = samples[peak];
    if size(sample) >= size(most) {
        (place, most) = (of_peak, sample);
    }
    let most = most?;
    // A pole is far above the places beside it, and above the samples beside it, one of which may
    // be a pole of the other sign.
    let near = [place - NEAR * width, place + NEAR * width];
    let near = near.into_iter().filter(|near| (low..=high).contains(near));
    let near = near.map(|near| size(at(near)));
    let near = near.fold(f64::NEG_INFINITY, f64::max);
    let others = beside.into_iter().filter(|index| *index != peak);
    let others = others.filter_map(|index| samples[index].1);
    let around = others.map(|(other, _)| other.abs()).reduce(f64::min);
    let around = around.unwrap_or(0.0).max(near.abs());
    let is_pole = near.is_finite() && most.0 - near > around && most.0 > TALL * usual;
    Some(if is_pole {
        Largest::Unbounded(place)
    } else {
        Largest::Value(most, place)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn over(quantity: impl Fn(f64) -> f64) -> Option<Largest<()>> {
        let value = |at: f64| Some((quantity(at), ())).filter(|(value, ())| value.is_finite());
        let samples: Vec<_> = (-20..=20)
            .map(f64::from)
            .map(|at| (at, value(at)))
            .collect();
        largest(&samples, value)
    }

    fn is_near(found: Option<Largest<()>>, value: f64, place: f64) -> bool {
        // A maximum is flat: its place has half of the digits.
        matches!(found, Some(Largest::Value((v, ()), p))
            if (v - value).abs() < 1e-12 && (p - place).abs() < 1e-6)
    }

    #[test]
    fn a_peak_between_samples_is_found() {
        // Peaks of 1 at 0.5 and, lower in the samples, of 1.5 at 17.5.
        let bell = |x: f64, at: f64, width: f64| (-((x - at) / width).powi(2)).exp();
        let found = over(|x| bell(x, 0.5, 2.0) + 1.5 * bell(x, 17.5, 0.6));
        assert!(is_near(found, 1.5, 17.5), "{found:?}");
        assert!(is_near(over(|x| -x), 20.0, -20.0));
        assert!(is_near(over(|x| x), 20.0, 20.0));
    }

    #[test]
    fn samples_may_be_a_rounding_apart() {
        let places = [
            250.0,
            251.0,
            251.0_f64.next_up(),
            251.0_f64.next_up().next_up(),
        ];
        let samples = places.map(|at| (at, Some((at, ()))));
        let found = largest(&samples, |at| Some((at, ())));
        assert_eq!(found, Some(Largest::Value((places[3], ()), places[3])));
    }

    #[test]
    fn a_constant_is_largest_anywhere() {
        assert_eq!(over(|_| 0.0), Some(Largest::Value((0.0, ()), -20.0)));
        assert!(matches!(over(|_| 3.0), Some(Largest::Value((3.0, ()), _))));
    }

    #[test]
    fn a_jump_is_no_pole() {
        let found = over(|x| if x < 0.3 { 1.0 } else { 2.0 });
        assert!(
            matches!(found, Some(Largest::Value((2.0, ()), _))),
            "{found:?}"
        );
    }

    #[test]
    fn a_pole_has_no_largest_value() {
        // At a sample, almost at one, between two, at one end, and of a root.
        for at in [0.0, 1e-15, 0.3, 20.0] {
            for power in [-1.0, -0.5] {
                let found = over(|x| (x - at).abs().powf(power));
                let is_there =
                    matches!(found, Some(Largest::Unbounded(p)) if (p - at).abs() < 1e-6);
                assert!(is_there, "{at}, {power}: {found:?}");
            }
        }
    }

    #[test]
    fn rounding_is_no_pole() {
        // A quantity that is zero but for rounding, everywhere and at some places only.
        for least in [-1.0, 0.98] {
            let noise = |x: f64| (1e9 * x).sin();
            let found = over(|x| {
                if noise(x) > least {
                    1e-17 * noise(2.0 * x)
                } else {
                    0.0
                }
            });
            assert!(matches!(found, Some(Largest::Value(..))), "{found:?}");
        }
    }

    #[test]
    fn a_pole_may_have_the_other_sign_at_a_sample_beside_it() {
        let found = over(|x| 1.0 / (x - 1e-16));
        let is_there = matches!(found, Some(Largest::Unbounded(p)) if p.abs() < 1e-6);
        assert!(is_there, "{found:?}");
    }

    #[test]
    fn without_values_there_is_none() {
        assert_eq!(largest::<()>(&[], |_| None), None);
        assert_eq!(over(|_| f64::NAN), None);
        let found = over(|x| if x < -19.5 { 1.0 } else { f64::NAN });
        assert!(
            matches!(found, Some(Largest::Value((1.0, ()), _))),
            "{found:?}"
        );
    }
}
