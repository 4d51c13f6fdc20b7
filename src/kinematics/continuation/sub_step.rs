//! Certified sub-steps of a path, and the watch over them.

use crate::kinematics::certificate::StepBounds;
use crate::kinematics::constraint::{Clearance, Constraint};
use crate::kinematics::plan::Watched;
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::state::State;
use crate::mechanism::{Coordinate, CoordinateKind};

/// A certified sub-step of a path, with the mechanism at its end.
pub struct SubStep<'a> {
    pub(super) compiled: &'a CompiledMechanism,
    pub(super) state: &'a State,
    pub(super) bounds: &'a mut StepBounds,
    /// The places on the path at which it starts and ends, from 0 to 1.
    pub part: [f64; 2],
}

/// A watch over the sub-steps of a path.
pub trait PathWatch {
    /// Returns the place on the path beyond which the next sub-step must not end.
    fn most(&self) -> f64;

    /// Returns whether a sub-step may be taken. Otherwise [`most`](Self::most) is the end to try next,
    /// behind its start.
    fn admits(&mut self, sub_step: &mut SubStep<'_>) -> bool;
}

impl SubStep<'_> {
    /// Returns the value of a relation at the end.
    #[must_use]
    pub fn value(&self, relation: &dyn Constraint) -> f64 {
        relation.value(&self.state.at)
    }

    /// Bounds the deviation of a relation, with these unknowns, from the straight line between its values
    /// at both ends; infinite without a bound. Of a clearance it bounds how far this lies below the line. A
    /// relation that is a distance names it, for the places at
    /// which it is not smooth. Where drivers have second derivatives, the deviation at a part σ of the
    /// sub-step is at most 4 σ (1 − σ) of this. Allocates nothing.
    pub fn deviation(
        &mut self,
        relation: &dyn Constraint,
        columns: &[usize],
        coordinate: Option<&Coordinate>,
    ) -> f64 {
        let Self {
            compiled,
            state,
            bounds,
            ..
        } = self;
        let watched = Watched {
            relation,
            columns,
            at: &state.at,
            from: &state.pose.q,
            pivots: &compiled.plan.pivots,
        };
        let any: &dyn std::any::Any = relation;
        if let Some(clearance) = any.downcast_ref::<Clearance>() {
            let chord = |column: usize| state.at.coordinate(column) - state.pose.q[column];
            let off = |column| bounds.deviation(column, &compiled.plan.pivots);
            let moving = clearance
                .shapes
                .map(|shape| bounds.parameters.core_motion(shape));
            let deviation = clearance.deviation(&state.at, chord, off, moving);
            return if deviation.is_nan() {
                f64::INFINITY
            } else {
                deviation
            };
        }
        let deviation = if bounds.parameters.moving {
            watched.deviation_while_moving(bounds, 0.0)
        } else {
            let smooth = watched.deviation(bounds);
            smooth.or_else(|| Some(2.0 * swept(compiled, state, coordinate?, bounds)?))
        };
        deviation.filter(|d| !d.is_nan()).unwrap_or(f64::INFINITY)
    }
}

/// Bounds the change of a distance over the sub-step, also where its points meet: by their ways. `None`
/// for another coordinate.
fn swept(
    compiled: &CompiledMechanism,
    state: &State,
    coordinate: &Coordinate,
    bounds: &StepBounds,
) -> Option<f64> {
    if coordinate.kind != CoordinateKind::Distance {
        return None;
    }
    let way = |column: usize| {
        let chord = state.at.coordinate(column) - state.pose.q[column];
        chord.abs() + bounds.deviation(column, &compiled.plan.pivots)
    };
    let ways = [coordinate.from, coordinate.to].map(|id| {
        let marker = state.at.marker(id);
        marker.body.map_or(0.0, |body| {
            let k = 3 * body.index();
            way(k) + way(k + 1) + marker.arm.norm() * way(k + 2)
        })
    });
    Some(ways[0] + ways[1])
}
