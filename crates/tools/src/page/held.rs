//! Mechanisms whose drivers are too few: the hand holds what nothing drives.

use std::sync::Arc;

use biela::kinematics::{Error, Path, Solver, undriven};
use biela::mechanism::{
    Coordinate, CoordinateKind, Driver, DriverSource, Expression, Marker, MarkerId, Mechanism,
};

/// Assembles a mechanism. Where drivers are too few, drivers without a name are added behind its
/// own, one for each coordinate that nothing drives.
///
/// # Errors
///
/// Those of [`Solver::assembled`], for a mechanism with too many drivers or one that does not close.
pub fn assembled(mechanism: &Arc<Mechanism>) -> Result<Solver, Error> {
    let own = Solver::assembled(Arc::clone(mechanism), &Path::new(mechanism));
    match own {
        Err(Error::Structure { free, .. }) if free > 0 => {
            let held = Arc::new(held(mechanism));
            let path = Path::new(&held);
            // A driver of what is fixed stays an error, which names it.
            Solver::assembled(held, &path).or(own)
        }
        _ => own,
    }
}

/// Returns the mechanism with drivers of the coordinates that nothing drives.
fn held(mechanism: &Arc<Mechanism>) -> Mechanism {
    let mut held = Mechanism::clone(mechanism);
    for undriven in undriven(mechanism) {
        let mut origin_of = |body| {
            held.markers.push(Marker {
                name: String::new(),
                body,
                position: [0.0; 2].map(Expression::constant),
                angle: Expression::constant(0.0),
            });
            MarkerId(held.markers.len() - 1)
        };
        let (from, to) = (origin_of(None), origin_of(Some(undriven.body)));
        let kinds = [CoordinateKind::X, CoordinateKind::Y, CoordinateKind::Angle];
        held.drivers.push(Driver {
            name: String::new(),
            description: String::new(),
            coordinate: Coordinate {
                kind: kinds[undriven.component],
                from,
                to,
                axes: from,
            },
            source: DriverSource::Input {
                start: undriven.value,
            },
            follows: None,
            is_input: true,
            min: None,
            max: None,
            wrapped: false,
        });
    }
    held
}
