//! Values next to a change point, interpolated along the motion.
//!
//! Reactions and derivatives solve equations with the Jacobian. At the distance δ from a change point
//! they lose digits as eps/δ or faster, at the point itself all. Along the motion they are smooth
//! functions of the driver's value, or have a pole: a limit exists only where what the bodies demand
//! does no work in the free motion at the point. Eight places of the motion, four on either side,
//! give the polynomial of degree seven; where the one through the six inner places differs, the
//! value is not smooth and has no limit.
//!
//! The motion through the present state is the one in time, with the third derivatives of prescribed
//! motions. The third derivative of an input and the rate of a load that is an input are unknown: a
//! limit that depends on them is refused. At rest the motion is that along the driver's value.

use std::sync::Arc;

use crate::kinematics::error::{Error, NoLimit};
use crate::kinematics::linear::nan_or_larger;
use crate::kinematics::newton::Limits;
use crate::kinematics::path::Rates;
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::plan::{BlockChoices, Crossing};
use crate::kinematics::state::State;
use crate::mechanism::{DriverId, Jet, Jet3, MotionInForce, ParameterId};

/// Way of the fastest body of the block from one place to the next, in radians and characteristic
/// lengths. A value whose Taylor series at the point converges up to a distance R has the error
/// 576 (WAY/R)⁸ of the polynomial, 1e-9 for R = 0.15; its rounding is that of accelerations, some
/// 1e-11, over WAY.
const WAY: f64 = 5e-3;
/// Places, in distances of neighbours from the change point.
const PLACES: [f64; 8] = [-4.0, -3.0, -2.0, -1.0, 1.0, 2.0, 3.0, 4.0];
/// Part of the crossing's half width that the places may take.
const WITHIN: f64 = 0.9;
/// Places between which both polynomials are compared, besides the present one. A pole is an odd
/// function, for which they agree at the point itself.
const COMPARED: [f64; 2] = [-0.5, 0.5];
/// Largest difference of the polynomials, as part of the largest value of its kind.
const SMOOTH: f64 = 1e-6;
/// Difference of the polynomials below which no nearer places are tried, which have more rounding.
const SMOOTH_ENOUGH: f64 = 1e-8;
/// Distance from the point, in ways of the fastest body, up to which a pose is at the point: a
/// direct solution has half the digits there at best.
const AT: f64 = 1e-7;
/// Least ratio of the driver's velocity at a place to that at the present one.
const STEADY: f64 = 0.5;
/// Most halvings of the distance of neighbours, until the driver is steady and all numbers are smooth.
const MOST_HALVINGS: u32 = 4;
/// Most Newton steps to the time of a place.
const MOST_STEPS_TO_PLACE: usize = 20;

/// A change point so near to the pose that solutions with the Jacobian lose digits.
#[derive(Debug)]
pub(in crate::kinematics) struct NearPoint {
    crossing: Arc<Crossing>,
    /// The driver's value at the pose, in distances of neighbours from the point.
    place: f64,
    /// Distance of neighbours \[m or rad\].
    apart: f64,
    halvings: u32,
    /// Whether the pose is at the point.
    pub(in crate::kinematics) is_at: bool,
}

/// One place of the motion, at which the state is.
pub(in crate::kinematics) struct MotionPoint<'a> {
    /// Rates of q.
    pub(in crate::kinematics) rates: &'a Rates,
    /// Rates of the drivers.
    pub(in crate::kinematics) driver_rates: &'a [Jet],
    /// Part of an unknown change by which inputs of loads have moved away.
    pub(in crate::kinematics) drift: f64,
}

/// Kind of a number: its rounding is that of the largest one of the same group and level or a lower
/// level. Numbers of a higher level have poles of higher order.
#[derive(Clone, Copy, Debug)]
pub(in crate::kinematics) struct Kind {
    pub(in crate::kinematics) group: usize,
    pub(in crate::kinematics) level: usize,
}

/// Levels of a group.
const LEVELS: usize = 4;

impl Kind {
    fn index(self) -> usize {
        LEVELS * self.group + self.level
    }
}

/// A number at the pose.
#[derive(Clone, Copy, Debug)]
struct Interpolated {
    value: f64,
    /// Largest difference of the polynomials, as part of the largest number of its kind.
    difference: f64,
}

impl Interpolated {
    /// Returns the number, not a number where the polynomials differ.
    fn value(self) -> f64 {
        if self.difference <= SMOOTH {
            self.value
        } else {
            f64::NAN
        }
    }
}

/// The motion through the present state.
struct MotionThrough {
    /// Value, rates and third derivative of each driver.
    drivers: Vec<Jet3>,
    /// Time from the pose to each place \[s\]; `None` for the motion along the driver's value.
    times: Option<[f64; 8]>,
}

/// Returns the nearest change point, if the pose is next to one.
pub(in crate::kinematics) fn near_point(
    compiled: &CompiledMechanism,
    state: &State,
) -> Option<NearPoint> {
    let crossings = state.pose.crossings.iter();
    let near = crossings.filter_map(|crossing| {
        let driver = crossing.driver.index();
        let apart =
            (WAY / speed(compiled, state, crossing)).min(crossing.half_width * WITHIN / 4.0);
        let place = (state.pose.drivers[driver] - crossing.center) / apart;
        (place.abs() < 1.0).then(|| NearPoint {
            crossing: Arc::clone(crossing),
            place,
            apart,
            halvings: 0,
            is_at: place.abs() * WAY < AT,
        })
    });
    near.min_by(|a, b| a.place.abs().total_cmp(&b.place.abs()))
}

/// Returns the largest scaled rate of the block's unknowns and of its driver with the driver's
/// value, at the change point.
fn speed(compiled: &CompiledMechanism, state: &State, crossing: &Crossing) -> f64 {
    let (system, size) = (&compiled.system, state.at.size());
    let columns = compiled.plan.blocks[crossing.block].columns();
    let rates = columns.iter().enumerate().map(|(local, &column)| {
        let [_, rate, _] = crossing.evaluate(local, crossing.center);
        (rate / system.column_scale(column, size)).abs()
    });
    let driver = system.driver_row(crossing.driver).row_scale(&state.at);
    rates.fold(driver, f64::max)
}

impl NearPoint {
    /// Returns the error of values of this kind that have no limit.
    pub(in crate::kinematics) fn no_limit(
        &self,
        compiled: &CompiledMechanism,
        of: NoLimit,
    ) -> Error {
        let mechanism = compiled.system.mechanism();
        let driver = &mechanism.drivers[self.crossing.driver.index()];
        Error::ChangePoint {
            of,
            driver: driver.name.clone(),
            value: driver.coordinate.kind.show(self.crossing.center),
            geometry: self.crossing.alignment.describe(mechanism, ""),
        }
    }

    /// Returns numbers of the motion, such as reactions, at the pose: `evaluate` adds them to a list
    /// at each place, and `kind` tells which of them are compared.
    /// Numbers without a known limit, and those that are not smooth, are not a number. `None` where
    /// the motion or a number does not exist at all places. The pose and all further results stay
    /// as they are.
    pub(in crate::kinematics) fn interpolate(
        &self,
        compiled: &mut CompiledMechanism,
        state: &mut State,
        driver_rates: &[Jet],
        kind: impl Fn(usize) -> Kind,
        mut evaluate: impl FnMut(
            &mut CompiledMechanism,
            &mut State,
            &MotionPoint<'_>,
            &mut Vec<f64>,
        ) -> Result<(), Error>,
    ) -> Option<Vec<f64>> {
        let mut found: Option<Vec<Interpolated>> = None;
        for halvings in 0..=MOST_HALVINGS {
            let nearer = self.halved(halvings);
            if nearer.place.abs() >= 1.0 {
                break;
            }
            let values = nearer.interpolate_at(compiled, state, driver_rates, &kind, &mut evaluate);
            let Some(values) = values else { continue };
            let best = found.get_or_insert_with(|| values.clone());
            for (best, value) in best.iter_mut().zip(values) {
                if value.difference < best.difference {
                    *best = value;
                }
            }
            if best.iter().all(|best| best.difference <= SMOOTH_ENOUGH) {
                break;
            }
        }
        let found = found?.into_iter();
        Some(found.map(Interpolated::value).collect())
    }

    /// Returns the numbers that the places at this distance give.
    fn interpolate_at(
        &self,
        compiled: &mut CompiledMechanism,
        state: &mut State,
        driver_rates: &[Jet],
        kind: &impl Fn(usize) -> Kind,
        evaluate: &mut impl FnMut(
            &mut CompiledMechanism,
            &mut State,
            &MotionPoint<'_>,
            &mut Vec<f64>,
        ) -> Result<(), Error>,
    ) -> Option<Vec<Interpolated>> {
        let course = self.course(compiled, state, driver_rates, 0.0)?;
        let values = self.visit(compiled, state, &course, 0.0, evaluate)?;
        let mut found = self.values_here(&values, kind);
        if self.is_at && course.times.is_some() {
            // A third derivative that changes the velocity by itself within a radian, and loads that
            // do likewise.
            let other = self.course(compiled, state, driver_rates, 1.0)?;
            let others = self.visit(compiled, state, &other, 1.0, evaluate)?;
            let scales = scales(&values, kind);
            let others = self.values_here(&others, kind);
            for (index, (found, other)) in found.iter_mut().zip(others).enumerate() {
                let scale = scales[kind(index).index()];
                let is_same = (found.value - other.value).abs() <= SMOOTH * scale;
                if !(is_same && other.difference <= SMOOTH) {
                    found.difference = f64::INFINITY;
                }
            }
        }
        Some(found)
    }

    /// Returns the point with nearer places: a slow driver may turn back before it comes to farther
    /// ones, and a motion in time may converge less far than one along the driver's value.
    fn halved(&self, halvings: u32) -> Self {
        let ratio = f64::from(1 << halvings);
        Self {
            crossing: Arc::clone(&self.crossing),
            place: ratio * self.place,
            apart: self.apart / ratio,
            halvings,
            is_at: self.is_at,
        }
    }

    /// Returns the motion through the present state: in time, or along the driver's value where the
    /// driver is too slow. Inputs have the third derivative `unknown`, times a natural one. `None`
    /// where the motion has no limit at the point, as where it turns back there.
    fn course(
        &self,
        compiled: &CompiledMechanism,
        state: &State,
        driver_rates: &[Jet],
        unknown: f64,
    ) -> Option<MotionThrough> {
        let time = state.pose.time;
        let parameters = &state.pose.parameters;
        // The rate of the fastest body per unit of the driver's value: a natural unit of its course.
        let speed = WAY / (self.apart * f64::from(1 << self.halvings));
        let mechanism = compiled.system.mechanism();
        let drivers = mechanism.drivers.iter().zip(driver_rates);
        let drivers = drivers.enumerate().map(|(index, (driver, rates))| {
            let third = driver.motion().map_or_else(
                || unknown * rates.first().powi(3) * speed.powi(2),
                |motion| {
                    let mut motion = MotionInForce::<Jet3>::new(motion, parameters.len());
                    motion.set_parameters(|p: ParameterId| Jet3::constant(parameters[p.index()]));
                    motion.evaluate(Jet3::variable(time)).third()
                },
            );
            let [first, second] = rates.derivatives;
            Jet3::new(state.pose.drivers[index], [first, second, third])
        });
        let drivers: Vec<Jet3> = drivers.collect();
        let own = drivers[self.crossing.driver.index()];
        let times = self.times(compiled, state, own);
        let is_at_rest = || {
            drivers
                .iter()
                .all(|u| u.derivatives.iter().all(|rate| *rate == 0.0))
        };
        (times.is_some() || !self.is_at || is_at_rest()).then_some(MotionThrough { drivers, times })
    }

    /// Returns the times at which a driver is at the places; `None` if it does not pass them
    /// steadily.
    fn times(&self, compiled: &CompiledMechanism, state: &State, driver: Jet3) -> Option<[f64; 8]> {
        let id = self.crossing.driver;
        let along = |time: f64| along(compiled, state, id, driver, time);
        let mut times = [0.0; 8];
        for (time, place) in times.iter_mut().zip(PLACES) {
            let way = (place - self.place) * self.apart;
            let is_steady = |rate: f64| rate / driver.first() >= STEADY;
            let mut close = false;
            for _ in 0..MOST_STEPS_TO_PLACE {
                let [value, rate, _] = along(*time);
                let off = value - driver.value - way;
                close = off.abs() <= 1e-9 * self.apart;
                if close || !is_steady(rate) {
                    break;
                }
                *time -= off / rate;
            }
            let [_, rate, _] = along(*time);
            if !close || !is_steady(rate) {
                return None;
            }
        }
        Some(times)
    }

    /// Evaluates numbers at all places of a motion.
    fn visit(
        &self,
        compiled: &mut CompiledMechanism,
        state: &mut State,
        course: &MotionThrough,
        unknown: f64,
        evaluate: &mut impl FnMut(
            &mut CompiledMechanism,
            &mut State,
            &MotionPoint<'_>,
            &mut Vec<f64>,
        ) -> Result<(), Error>,
    ) -> Option<Vec<Vec<f64>>> {
        let home = state.pose.clone();
        let mut choices: Vec<BlockChoices> = Vec::new();
        compiled.plan.copy_choices(&mut choices);
        let own = self.crossing.driver.index();
        let mut rates = Rates::new(home.q.len());
        let mut driver_rates = vec![Jet::constant(0.0); home.drivers.len()];
        let mut all = Vec::with_capacity(PLACES.len());
        for (k, place) in PLACES.into_iter().enumerate() {
            let time = course.times.map_or(0.0, |times| times[k]);
            for (index, driver) in course.drivers.iter().enumerate() {
                let rates = along(compiled, state, DriverId(index), *driver, time);
                let [value, first, second] = rates;
                state.pose.drivers[index] = value;
                driver_rates[index] = Jet::new(value, [first, second]);
            }
            state.pose.drivers[own] = self.crossing.center + place * self.apart;
            state.pose.time = home.time + time;
            let mut values_there = |compiled: &mut CompiledMechanism, state: &mut State| {
                move_there(compiled, state)?;
                let jet = |driver: DriverId| driver_rates[driver.index()];
                state.solve_rates(compiled, jet, &mut rates).ok()?;
                let place = MotionPoint {
                    rates: &rates,
                    driver_rates: &driver_rates,
                    drift: unknown * (place - self.place) * WAY,
                };
                let mut values = Vec::new();
                evaluate(compiled, state, &place, &mut values).ok()?;
                Some(values)
            };
            match values_there(compiled, state) {
                Some(values) => all.push(values),
                None => break,
            }
            state.pose.copy_place(&home);
            state.move_to_pose(&compiled.system);
        }
        state.pose.copy_place(&home);
        state.move_to_pose(&compiled.system);
        let fits = compiled.plan.take_choices(&choices);
        debug_assert!(fits, "they are of this plan");
        state.refresh(compiled).ok()?;
        (all.len() == PLACES.len()).then_some(all)
    }

    /// Returns the numbers at the pose by both polynomials.
    fn values_here(&self, values: &[Vec<f64>], kind: &impl Fn(usize) -> Kind) -> Vec<Interpolated> {
        let scales = scales(values, kind);
        let at = |place: f64| [&PLACES[..], &PLACES[1..7]].map(|nodes| weights(nodes, place));
        let here = at(self.place);
        let compared = COMPARED.map(at);
        let value = |index: usize| {
            let both = |weights: &[Vec<f64>; 2]| {
                let [all, inner] = weights;
                let sum = |weights: &[f64], values: &[Vec<f64>]| -> f64 {
                    let terms = weights.iter().zip(values);
                    terms.map(|(weight, values)| weight * values[index]).sum()
                };
                [sum(all, values), sum(inner, &values[1..7])]
            };
            let [value, other] = both(&here);
            let pairs = compared.iter().map(both).chain([[value, other]]);
            let largest = pairs.map(|[a, b]| (a - b).abs()).fold(0.0, nan_or_larger);
            let difference = match largest / scales[kind(index).index()] {
                _ if largest == 0.0 => 0.0,
                difference if difference.is_nan() => f64::INFINITY,
                difference => difference,
            };
            Interpolated { value, difference }
        };
        (0..values[0].len()).map(value).collect()
    }
}

/// Moves the bodies to the drivers' values of the pose, and makes this the pose.
fn move_there(compiled: &mut CompiledMechanism, state: &mut State) -> Option<()> {
    let CompiledMechanism { system, plan, .. } = &mut *compiled;
    let mut blocks = state.block_state(system);
    plan.close(&mut blocks, Limits::STEP).ok()?;
    state.accept_bodies();
    state.invalidate();
    state.refresh(compiled).ok()
}

/// Returns value and rates of a driver after a time: those of its prescribed motion, or of the Taylor
/// polynomial of an input. Along a Taylor polynomial of a prescribed motion a limit could have a small
/// pole.
fn along(
    compiled: &CompiledMechanism,
    state: &State,
    id: DriverId,
    driver: Jet3,
    time: f64,
) -> [f64; 3] {
    if time != 0.0
        && compiled.system.mechanism().drivers[id.index()]
            .motion()
            .is_some()
    {
        let there = Jet::variable(state.pose.time + time);
        let motion = state.motions.evaluate(id, there);
        return [motion.value, motion.first(), motion.second()];
    }
    let [first, second, third] = driver.derivatives;
    [
        driver.value + time * (first + time * (0.5 * second + time * third / 6.0)),
        first + time * (second + 0.5 * time * third),
        second + time * third,
    ]
}

/// Returns the largest magnitude of the numbers of each kind, and of those of lower levels, at all
/// places.
fn scales(values: &[Vec<f64>], kind: &impl Fn(usize) -> Kind) -> Vec<f64> {
    let mut scales = Vec::new();
    for (index, value) in values.iter().flat_map(|place| place.iter().enumerate()) {
        let kind = kind(index).index();
        if scales.len() <= kind {
            scales.resize(kind + 1, 0.0);
        }
        scales[kind] = f64::max(scales[kind], value.abs());
    }
    for group in scales.chunks_mut(LEVELS) {
        let mut largest = 0.0;
        for scale in group {
            largest = f64::max(largest, *scale);
            *scale = largest;
        }
    }
    scales
}

/// Returns the weights of the values at these nodes in the polynomial through them at a place, by
/// Lagrange.
fn weights(nodes: &[f64], place: f64) -> Vec<f64> {
    let weight = |node: &f64| {
        let others = nodes.iter().filter(|other| (*other - node).abs() > 0.5);
        others
            .map(|other| (place - other) / (node - other))
            .product()
    };
    nodes.iter().map(weight).collect()
}

#[cfg(test)]
mod tests {
    use super::{PLACES, weights};

    /// The polynomial of degree seven is met exactly, with the rounding of eight products of weights
    /// below 1.4.
    #[test]
    fn weights_meet_a_polynomial() {
        let f = |x: f64| 1.0 + x * (2.0 - x * x * x * (0.5 + 0.25 * x * x * x));
        for place in [0.0, 0.3, -0.9] {
            let terms = weights(&PLACES, place);
            let sum: f64 = terms.iter().zip(PLACES).map(|(w, x)| w * f(x)).sum();
            assert!(
                (sum - f(place)).abs() <= 16.0 * f64::EPSILON * f(4.0).abs(),
                "{place}"
            );
        }
    }
}
