//! Directional derivatives of every shipped mechanism against differences.

use crate::common::{Instance, co_simulation, instance_of, shipped, stems};
use crate::differences::{DIFFERENCE, differences, move_inputs, references};
use biela::fmi::{Causality, Interface, Quantity, Variable, value_reference};
use biela::kinematics::OutputSource;

fn is_parameter(variable: &Variable<Quantity>) -> bool {
    variable.causality == Causality::Parameter && variable.kind.is_real()
}

fn moving(name: &str) -> Instance {
    let mut instance = co_simulation(name);
    move_inputs(&mut instance);
    instance
}

/// Errors are relative to the largest derivative of the same order of time that any output has:
/// accelerations near singular positions have the largest third derivatives.
#[test]
fn every_derivative_agrees_with_differences() {
    for name in stems("mechanisms", "toml") {
        let mut instance = moving(&name);
        let knowns = references(&instance, |variable| {
            variable.causality == Causality::Input || is_parameter(variable)
        });
        let unknowns = references(&instance, |variable| {
            matches!(
                variable.causality,
                Causality::Output | Causality::CalculatedParameter
            )
        });
        for known in knowns {
            let exact = instance
                .directional_derivative(&unknowns, &[known], &[1.0])
                .unwrap_or_else(|error| panic!("{name}: {error}"));
            let differences = differences(&mut instance, &unknowns, known);
            let mut largest = [1.0_f64; 3];
            let order = |place: usize| {
                let variable = &instance.variables()[unknowns[place] as usize - 1];
                match variable.quantity {
                    Quantity::Output(OutputSource::Signal(_, order)) => order as usize,
                    _ => 0,
                }
            };
            for (place, exact) in exact.iter().enumerate() {
                largest[order(place)] = largest[order(place)].max(exact.abs());
            }
            for (place, (exact, difference)) in exact.iter().zip(differences).enumerate() {
                assert!(
                    (exact - difference).abs() <= DIFFERENCE * largest[order(place)],
                    "{name}: `{}` by `{}`: {exact} and {difference}",
                    instance.variables()[unknowns[place] as usize - 1].name,
                    instance.variables()[known as usize - 1].name,
                );
            }
        }
    }
}

/// A direction in all knowns at once is the sum of its parts, each known as often as it is named.
#[test]
fn derivatives_are_linear_in_the_direction() {
    let mut instance = moving("four_bar");
    let unknowns = references(&instance, |v| v.causality == Causality::Output);
    let knowns = [1, 2, 3, 4, 1];
    let changes = [0.3, -1.0, 2.0, 0.01, 0.4];
    let mut sum = vec![0.0; unknowns.len()];
    for (known, change) in knowns.iter().zip(changes) {
        let part = instance
            .directional_derivative(&unknowns, &[*known], &[change])
            .unwrap();
        sum.iter_mut()
            .zip(part)
            .for_each(|(sum, part)| *sum += part);
    }
    let together = instance
        .directional_derivative(&unknowns, &knowns, &changes)
        .unwrap();
    for (sum, together) in sum.iter().zip(together) {
        // Some ten roundings of terms of the order of one.
        assert!((sum - together).abs() < 1e-13, "{sum} {together}");
    }
}

/// An estimated velocity changes with the newest position; one that is given would replace it.
#[test]
fn an_estimate_is_differentiated() {
    let mut instance = co_simulation("pendulum");
    instance.setup_experiment(0.0, None).unwrap();
    instance.enter_initialization_mode().unwrap();
    instance.exit_initialization_mode().unwrap();
    for step in 0..3 {
        let t = 0.1 * f64::from(step);
        instance.set_real(&[1], &[0.5 + t]).unwrap();
        instance.do_step(t, 0.1).unwrap();
    }
    let reference = |name: &str| {
        let mut variables = instance.variables().iter();
        let place = variables.position(|variable| variable.name == name);
        value_reference(place.unwrap())
    };
    let unknowns = [reference("rod.vx"), reference("rod.omega")];
    let length = reference("length");
    let mut by = |known| {
        let values = instance.directional_derivative(&unknowns, &[known], &[1.0])?;
        Ok::<[f64; 2], biela::fmi::Error>([values[0], values[1]])
    };
    // x = sin(u)/4 at u = 0.7 where u̇ = 1, so that ∂vx/∂u = -sin(u) u̇/4 and ∂vx/∂u̇ = cos(u)/4. The
    // slope of the parabola through three points 0.1 s apart changes by 3/2 of the last one's change.
    let slope = 1.5 / 0.1;
    let [vx, omega] = by(1).unwrap();
    let truth = -0.25 * 0.7_f64.sin() + 0.25 * 0.7_f64.cos() * slope;
    assert!((vx - truth).abs() < 1e-14, "{vx}");
    assert!((omega - slope).abs() < 1e-14, "{omega}");
    let [vx, omega] = by(2).unwrap();
    assert!((vx - 0.25 * 0.7_f64.cos()).abs() < 1e-14, "{vx}");
    assert!((omega - 1.0).abs() < 1e-15, "{omega}");
    // After initialization parameters are no knowns any more.
    let refused = by(length).unwrap_err().to_string();
    assert!(refused.contains("by inputs"), "{refused}");
}

/// In model exchange all rates are given, also at a point that the host has just accepted.
#[test]
fn accepted_points_of_model_exchange_have_given_rates() {
    let mut instance = instance_of(shipped("pendulum"), Interface::ModelExchange);
    instance.setup_experiment(0.0, None).unwrap();
    instance.enter_initialization_mode().unwrap();
    instance.exit_initialization_mode().unwrap();
    instance.enter_continuous_time_mode().unwrap();
    for step in 1..4 {
        let t = 0.1 * f64::from(step);
        instance.set_time(t).unwrap();
        instance.set_real(&[1, 2], &[0.5 + t, 1.0]).unwrap();
        instance.completed_integrator_step().unwrap();
    }
    let mut variables = instance.variables().iter();
    let omega = variables.position(|v| v.name == "rod.omega");
    let omega = value_reference(omega.unwrap());
    let by_inputs = |instance: &mut Instance| {
        [1, 2, 3].map(|known| {
            let values = instance.directional_derivative(&[omega], &[known], &[1.0]);
            values.unwrap()
        })
    };
    let truth = [[0.0], [1.0], [0.0]].map(Vec::from);
    assert_eq!(by_inputs(&mut instance), truth);

    // A new instance that takes over the state accepts the same point.
    let state = instance.fmu_state().unwrap();
    let bytes = instance.serialize_fmu_state(&state).unwrap();
    let mut other = instance_of(shipped("pendulum"), Interface::ModelExchange);
    let state = other.deserialize_fmu_state(&bytes).unwrap();
    other.set_fmu_state(&state).unwrap();
    other.completed_integrator_step().unwrap();
    assert_eq!(by_inputs(&mut other), truth);
}

/// An expression `f` of the parameter `p`, and a value of `p` at which it has no derivative.
const STEEP: [(&str, f64); 7] = [
    ("sqrt(p)", 0.0),
    ("p^0.5", 0.0),
    ("asin(p)", 1.0),
    ("acos(p)", -1.0),
    ("hypot(p, 0)", 0.0),
    ("atan2(p, p)", 0.0),
    ("abs(p)^0.25", 0.0),
];

/// A crank with `f` in the place named: a parameter, a marker, a constraint's value, a measure, a
/// mass, a spring.
fn steep(f: &str, value: f64, place: &str) -> Instance {
    let at = |own: &str, usual: &str| {
        if own == place {
            format!("\"{usual} + 0.1*({f})\"")
        } else {
            usual.to_owned()
        }
    };
    let text = format!(
        r#"format = 1
name = "steep"
[parameters]
p = {{ value = {value}, unit = "1" }}
q = {{ value = {}, unit = "1" }}
[ground.markers]
O = [0, 0]
F = [0.5, 1]
[bodies.crank]
markers = {{ O = [0, 0], A = [{}, 0] }}
mass = {}
center = [0.1, 0]
[bodies.other.markers]
O = [0, 0]
[joints]
O = {{ type = "revolute", markers = ["ground.O", "crank.O"] }}
P = {{ type = "revolute", markers = ["ground.F", "other.O"] }}
[constraints]
held = {{ coordinate = "angle", markers = ["ground.F", "other.O"], value = {} }}
[drivers]
turn = {{ coordinate = "angle", markers = ["ground.O", "crank.O"], start = 0.3 }}
[forces]
spring = {{ coordinate = "distance", markers = ["ground.F", "crank.A"], stiffness = {}, free = 0.2 }}
[outputs]
markers = ["crank.A"]
[measures]
plain = {{ value = "2*crank.phi" }}
told = {{ value = {} }}
"#,
        at("q", "1"),
        at("marker", "0.4"),
        at("mass", "2"),
        at("held", "0.2"),
        at("spring", "100"),
        match place {
            "told" => format!("\"crank.phi + {f}\""),
            _ => "\"crank.phi\"".to_owned(),
        },
    );
    let mut instance = instance_of(crate::common::parse(&text), Interface::CoSimulation);
    instance.setup_experiment(0.0, None).expect("legal");
    instance.enter_initialization_mode().expect("legal");
    instance
}

/// A derivative that does not exist is refused like a rate at a dead point, and the message names
/// the expression and the parameter; what does not depend on it keeps its derivative.
#[test]
fn derivatives_that_do_not_exist_are_refused() {
    for (f, value) in STEEP {
        for (place, unknown, named) in [
            ("q", "q", "parameter `q`"),
            ("marker", "crank.A.x", "marker `crank.A`"),
            ("held", "other.phi", "constraint `held`"),
            ("told", "told", "measure `told`"),
            ("mass", "turn.effort", "body `crank`"),
            ("spring", "turn.effort", "force `spring`"),
        ] {
            let mut instance = steep(f, value, place);
            let reference = |name: &str| {
                let mut variables = instance.variables().iter();
                value_reference(variables.position(|v| v.name == name).expect("it is there"))
            };
            let [p, plain, unknown] = ["p", "plain", unknown].map(reference);
            let mut by_p = |unknown| instance.directional_derivative(&[unknown], &[p], &[1.0]);
            let refused = by_p(unknown).expect_err(f).to_string();
            assert!(
                refused.contains(named) && refused.contains("`p`"),
                "{f}: {refused}"
            );
            assert_eq!(by_p(plain).expect("it exists"), [0.0], "{f} in {place}");
        }
    }
    // The next power has a derivative.
    let mut instance = steep("p^1.5", 0.0, "told");
    let names = ["p", "told"];
    let [p, told] = names.map(|name| {
        let mut variables = instance.variables().iter();
        value_reference(variables.position(|v| v.name == name).expect("it is there"))
    });
    let found = instance.directional_derivative(&[told], &[p], &[1.0]);
    assert_eq!(found.expect("it exists"), [0.0]);
}
