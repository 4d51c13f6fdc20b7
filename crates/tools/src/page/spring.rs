//! A spring from the hand to a point of a body.

use std::f64::consts::{SQRT_2, TAU};
use std::sync::Arc;

use nalgebra::DMatrix;

use biela::dynamics::Motion;
use biela::kinematics::{Rates, Solver};
use biela::mechanism::{
    BodyId, Coordinate, CoordinateKind, Expression, Force, ForceLaw, Jet, Load, Marker, MarkerId,
    Mechanism, Variable,
};

/// Frequency of the body on the spring, without gravity \[1/s\].
const FREQUENCY: f64 = 2.0;
/// Sizes of the mechanism by which its weight may stretch the spring, about.
const SAG: f64 = 0.1;
/// Damping ratio.
const DAMPING: f64 = 0.7;
/// Radius of the hand, in sizes of the mechanism: next to a pivot, where a point hardly moves, the
/// spring is as stiff as at about this distance.
const HAND: f64 = 0.05;

/// A spring with a damper between a point of a body and the hand. It consists of forces of a
/// mechanism of its own, the session's with them added at the end: a spring to ground's origin, and
/// the load that moves its free end to the hand. The potential energy is without it.
pub(super) struct Spring {
    pub(super) body: BodyId,
    /// Point in the body's frame \[m\].
    pub(super) grip: [f64; 2],
    /// Place of the hand \[m\].
    pub(super) hand: [f64; 2],
    /// Stiffness \[N/m\].
    pub(super) stiffness: f64,
    /// The first input of the load.
    first_load: usize,
    /// The mechanism without the spring, which waits.
    pub(super) other: Motion,
}

impl Spring {
    /// Hangs a body on a spring that is as stiff as the [`mobility`] of its point demands. Until the
    /// two are exchanged, `other` is the mechanism with the spring.
    pub(super) fn new(
        solver: &Solver,
        mechanism: &Mechanism,
        mobility: f64,
        (body, grip, hand): (BodyId, [f64; 2], [f64; 2]),
    ) -> Result<Self, String> {
        let gravity = (mechanism.simulation.gravity.each_ref())
            .map(|component| component.value(&solver.pose().parameters));
        let weight = f64::hypot(gravity[0], gravity[1]);
        let square = (TAU * FREQUENCY).powi(2) + weight / (SAG * solver.size());
        let stiffness = square / mobility;
        let damping = 2.0 * DAMPING * stiffness / square.sqrt();
        let hung = Arc::new(hung(mechanism, body, grip, [stiffness, damping]));
        let solver = Solver::new(hung).map_err(|error| error.to_string())?;
        let mut other = Motion::new(solver);
        other.seek_forces();
        let prepared = other.prepare_freedoms(Vec::new());
        prepared.map_err(|error| error.to_string())?;
        Ok(Self {
            body,
            grip,
            hand,
            stiffness,
            first_load: mechanism.load_inputs().len(),
            other,
        })
    }

    /// Writes the load that moves the spring's free end to the hand into the last inputs.
    pub(super) fn load(&self, loads: &mut [f64]) {
        for (load, place) in loads[self.first_load..].iter_mut().zip(self.hand) {
            *load = self.stiffness * place;
        }
    }
}

/// Returns the acceleration of a point of a body per force that acts there, the sum of two directions
/// at right angles \[1/kg\]: the trace of ∂r/∂u J⁻¹ (∂r/∂u)ᵀ. `None` if no freedom moves the point.
pub(super) fn mobility(motion: &mut Motion, body: BodyId, arm: [f64; 2]) -> Option<f64> {
    let (free, solver, _) = motion.parts()?;
    let own = free.freedoms();
    let radius = HAND * solver.size() / SQRT_2;
    let mut rates = Rates::new(solver.pose().q.len());
    let mut motions = DMatrix::zeros(3, own.len());
    for (column, freedom) in own.iter().enumerate() {
        let unit = |driver| Jet::new(0.0, [f64::from(u8::from(driver == *freedom)), 0.0]);
        solver.solve_rates(unit, &mut rates).ok()?;
        let [vx, vy, omega] = [0, 1, 2].map(|k| rates.velocity()[3 * body.index() + k]);
        let moved = [vx - omega * arm[1], vy + omega * arm[0], omega * radius];
        motions.set_column(column, &moved.into());
    }
    let inertia = free.inertia().lu();
    let mobility = inertia.solve(&motions.tr_mul(&motions))?.trace();
    (mobility.is_finite() && mobility > 0.0).then_some(mobility)
}

/// Returns a mechanism with the forces of a spring at a point of a body.
fn hung(
    mechanism: &Mechanism,
    body: BodyId,
    grip: [f64; 2],
    [stiffness, damping]: [f64; 2],
) -> Mechanism {
    let mut mechanism = mechanism.clone();
    let mut marker = |body, position: [f64; 2]| {
        mechanism.markers.push(Marker {
            name: String::new(),
            body,
            position: position.map(Expression::constant),
            angle: Expression::constant(0.0),
        });
        MarkerId(mechanism.markers.len() - 1)
    };
    let (from, to) = (marker(None, [0.0; 2]), marker(Some(body), grip));
    let along = |kind| Load::Coordinate {
        coordinate: Coordinate {
            kind,
            from,
            to,
            axes: from,
        },
        law: Some(ForceLaw {
            value: Some(Expression::multiple(-stiffness, Variable::Position)),
            damping: Some(Expression::constant(damping)),
            ..ForceLaw::default()
        }),
    };
    let hand = Load::Marker {
        marker: to,
        axes: None,
        law: None,
    };
    let loads = [along(CoordinateKind::X), along(CoordinateKind::Y), hand];
    mechanism.forces.extend(loads.map(|load| Force {
        name: "hand".to_owned(),
        description: String::new(),
        load,
    }));
    mechanism
}
