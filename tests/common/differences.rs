//! Derivatives of outputs by differences of fourth order, through the FMI instance.

use biela::fmi::{Kind, Quantity, Variable, value_reference};
use biela::mechanism::Order;

use super::common::Instance;

/// A quarter of the way over which differences are taken, in units of the known. It is a
/// thousandth of lengths of a centimetre; the truncation is the fourth power of that, and the
/// rounding 1e-16 / 1e-5 times the condition.
const STEP: f64 = 1e-5;
/// Error of these differences relative to the largest derivative beside them: rounding times the
/// condition of poses near singular positions.
pub const DIFFERENCE: f64 = 1e-6;

/// Returns the value references of some variables.
pub fn references(instance: &Instance, which: impl Fn(&Variable<Quantity>) -> bool) -> Vec<u32> {
    let variables = (1..).zip(instance.variables());
    let found = variables.filter(|(_, variable)| which(variable));
    found.map(|(reference, _)| reference).collect()
}

/// Brings a new instance into initialization mode with all inputs moved on and all rates wired.
pub fn move_inputs(instance: &mut Instance) {
    // Between the points of every table.
    instance.setup_experiment(0.317, None).expect("legal");
    for (place, variable) in instance.variables().to_vec().into_iter().enumerate() {
        let (reference, more) = (value_reference(place), 0.1 * place as f64);
        let value = match (variable.quantity, variable.kind) {
            (Quantity::Input(_, order), Kind::Real { start, .. }) => match order {
                // Some lengths do not go further than a few centimetres.
                Order::Position => start.expect("inputs have one") + 0.003,
                Order::Velocity => 0.7 + more,
                Order::Acceleration => -0.4 + more,
            },
            (Quantity::ForceInput(_), _) => 2.0 + more,
            (Quantity::RateSource, _) => {
                // As the inputs say.
                instance.set_integer(&[reference], &[2]).expect("legal");
                continue;
            }
            _ => continue,
        };
        instance.set_real(&[reference], &[value]).expect("legal");
    }
    instance.enter_initialization_mode().expect("legal");
}

/// Returns the derivatives of the unknowns by a known, from four values of it.
pub fn differences(instance: &mut Instance, unknowns: &[u32], known: u32) -> Vec<f64> {
    let mut value = [0.0];
    instance.get_real(&[known], &mut value).expect("it is set");
    let mut moved = |by: f64| -> Vec<f64> {
        let to = value[0] + by;
        instance.set_real(&[known], &[to]).expect("legal");
        instance.reals(unknowns).expect("it closes").collect()
    };
    let [far_before, before, after, far_after] = [-2.0, -1.0, 1.0, 2.0].map(|k| moved(k * STEP));
    moved(0.0);
    let way = (value[0] + STEP) - (value[0] - STEP);
    let difference = |place: usize| {
        let near = after[place] - before[place];
        let far = far_after[place] - far_before[place];
        (8.0 * near - far) / (6.0 * way)
    };
    (0..unknowns.len()).map(difference).collect()
}
