//! Mechanisms read from right files; `tests/file/diagnostics.rs` has the wrong ones.

use crate::mechanism::{
    BodyId, CoordinateKind, DisplayUnit, DriverSource, JointKind, MarkerId, Mechanism, ParameterId,
    PrescribedMotion, Source, Variable,
};

fn read(text: &str) -> Mechanism {
    let source = Source::new("test.toml", text);
    match Mechanism::parse(&source) {
        Ok((mechanism, _)) => mechanism,
        Err(problems) => {
            let lines: Vec<String> = problems.iter().map(|p| p.one_line(&source)).collect();
            panic!("{}", lines.join("\n"))
        }
    }
}

/// A pendulum with `more` after it.
fn pendulum(more: &str) -> Mechanism {
    read(&format!(
        "format = 1\nname = 'pendulum'\n\
         [ground.markers]\nO = [0, 0]\nE = [1, 0, '90*deg']\n\
         [bodies.rod]\nmarkers = {{ O = [0, 0], P = [0.5, 0] }}\n\
         [joints]\nO = {{ type = 'revolute', markers = ['ground.O', 'rod.O'] }}\n{more}"
    ))
}

fn gravity(mechanism: &Mechanism) -> [f64; 2] {
    let gravity = mechanism.simulation.gravity.each_ref();
    gravity.map(|component| component.evaluate(&|_| 0.0, 0.0))
}

#[test]
#[expect(
    clippy::float_cmp,
    reason = "read from decimal digits or computed alike"
)]
fn a_file_is_read_in_its_order() {
    let mechanism = read(include_str!("../../../mechanisms/four_bar.toml"));
    assert_eq!(mechanism.name, "four_bar");
    let bodies: Vec<&str> = mechanism
        .bodies
        .iter()
        .map(|body| body.name.as_str())
        .collect();
    assert_eq!(bodies, ["crank", "coupler", "rocker"]);
    let markers: Vec<(Option<BodyId>, &str)> = mechanism
        .markers
        .iter()
        .map(|marker| (marker.body, marker.name.as_str()))
        .collect();
    let body = |index| Some(BodyId(index));
    assert_eq!(
        markers,
        [
            (None, "O2"),
            (None, "O4"),
            (body(0), "O"),
            (body(0), "A"),
            (body(1), "A"),
            (body(1), "B"),
            (body(1), "P"),
            (body(2), "O"),
            (body(2), "B"),
        ]
    );
    for (index, body) in mechanism.bodies.iter().enumerate() {
        for marker in &body.markers {
            assert_eq!(mechanism.markers[marker.index()].body, Some(BodyId(index)));
        }
    }
    let joint = &mechanism.joints[2];
    assert!(matches!(joint.kind, JointKind::Revolute));
    assert_eq!((joint.from, joint.to), (MarkerId(5), MarkerId(8)));
    assert_eq!(mechanism.outputs.markers, [MarkerId(6)]);
    assert_eq!(mechanism.outputs.bodies.len(), 3);
    let driver = &mechanism.drivers[0];
    assert_eq!(driver.coordinate.kind, CoordinateKind::Angle);
    assert_eq!(driver.coordinate.axes, driver.coordinate.from);
    assert!(matches!(driver.source, DriverSource::Input { start } if start == 60_f64.to_radians()));
    let rocker = &mechanism.parameters[2];
    assert!(rocker.tunable && !rocker.derived);
    assert_eq!((rocker.default, rocker.min), (0.3, Some(0.001)));
    let display = rocker.unit.and_then(|unit| unit.display);
    assert_eq!(display, Some(DisplayUnit::MILLIMETRE));
    assert_eq!(
        (mechanism.simulation.stop, mechanism.simulation.step),
        (2.0, 0.01)
    );
    assert_eq!(mechanism.parameter_id("base"), Some(ParameterId(3)));
    assert_eq!(mechanism.body_id("rocker"), Some(BodyId(2)));
    assert_eq!(mechanism.body_id("ground"), None);
}

#[test]
#[expect(clippy::float_cmp, reason = "small integers")]
fn derived_parameters_come_after_those_they_use() {
    let mechanism =
        pendulum("[parameters]\na = 'b + c'\nb = '2*c'\nc = 3\nd = { value = 'a', max = 'a' }\n");
    let [a, b, d] = [0, 1, 3].map(ParameterId);
    assert_eq!(mechanism.derivation_order, [b, a, d]);
    assert_eq!(mechanism.default_parameters(), [9.0, 6.0, 3.0, 9.0]);
    assert_eq!(mechanism.parameters[3].max, Some(9.0));
    let mut values = [0.0, 0.0, 5.0, 0.0];
    mechanism.derive_parameters(&mut values);
    assert_eq!(values, [15.0, 10.0, 5.0, 15.0]);
}

#[test]
#[expect(
    clippy::float_cmp,
    reason = "read from decimal digits or computed alike"
)]
fn what_is_left_out_has_its_default() {
    let mechanism = pendulum("");
    assert_eq!(mechanism.simulation.start, 0.0);
    assert_eq!(mechanism.simulation.stop, 1.0);
    assert_eq!(mechanism.simulation.step, 1.0 / 500.0);
    assert_eq!(mechanism.simulation.tolerance, 1e-6);
    assert_eq!(gravity(&mechanism), [0.0, -9.81]);
    let estimate = mechanism.bodies[0].estimate.each_ref().map(|e| e.literal());
    assert_eq!(estimate, [Some(0.0); 3]);
    assert_eq!(mechanism.markers[0].angle.literal(), Some(0.0));
    let longer = pendulum("[simulation]\nstart = 1\nstop = '2 + 1'\ngravity = [0.5, '-2*9']\n");
    assert_eq!(longer.simulation.step, 2.0 / 500.0);
    assert_eq!(gravity(&longer), [0.5, -18.0]);
}

#[test]
#[expect(clippy::float_cmp, reason = "small integers")]
fn a_motion_is_a_function_of_time() {
    let mechanism = pendulum(
        "[parameters]\nomega = 2\n[drivers]\n\
         swing = { coordinate = 'angle', markers = ['ground.O', 'rod.O'], motion = 'omega*t' }\n",
    );
    let DriverSource::Motion(PrescribedMotion::Expression(motion)) = &mechanism.drivers[0].source
    else {
        panic!("an expression");
    };
    assert!(motion.uses(Variable::Time));
    assert_eq!(motion.evaluate(&|_| 2.0, 3.0), 6.0);
    assert!(
        mechanism
            .parse_expression("omega*t", Some(Variable::Time))
            .is_ok()
    );
    assert!(mechanism.parse_expression("omega*t", None).is_err());
}

#[test]
fn a_driver_may_have_limits_and_be_wrapped() {
    let mechanism = pendulum(
        "[parameters]\nlongest = { value = 0.9, unit = 'm' }\n[drivers]\n\
         swing = { coordinate = 'angle', markers = ['ground.O', 'rod.O'], start = 0, \
         min = '-30*deg', max = '30*deg' }\n\
         turn = { coordinate = 'angle', markers = ['ground.E', 'rod.P'], start = 0, wrapped = true }\n\
         reach = { coordinate = 'distance', markers = ['ground.E', 'rod.P'], motion = 0.5, \
         max = 'longest' }\n",
    );
    let limits: Vec<_> = mechanism
        .drivers
        .iter()
        .map(|d| (d.min, d.max, d.wrapped))
        .collect();
    let angle = 30.0 * (std::f64::consts::PI / 180.0);
    assert_eq!(
        limits,
        [
            (Some(-angle), Some(angle), false),
            (None, None, true),
            (None, Some(0.9), false),
        ]
    );
}

#[test]
fn a_marker_may_be_given_in_polar_coordinates() {
    let mechanism = pendulum(
        "[parameters]\nhorn = 0.2\ntilt = '30*deg'\n[bodies.bell_crank.markers]\n\
         A = { r = 'horn', angle = '-90*deg' }\nB = { r = 'horn', angle = 'tilt' }\n\
         C = { r = '2*horn', angle = '120*deg' }\n",
    );
    let body = mechanism.body_id("bell_crank").expect("it is there");
    let markers = mechanism.bodies[body.index()].markers.iter();
    let texts: Vec<[String; 3]> = markers
        .map(|marker| {
            let marker = &mechanism.markers[marker.index()];
            let [x, y] = &marker.position;
            let name = |id: ParameterId| mechanism.parameters[id.index()].name.as_str();
            [x, y, &marker.angle].map(|number| number.display(name).to_string())
        })
        .collect();
    let (sine, cosine) = (120.0 * (std::f64::consts::PI / 180.0)).sin_cos();
    assert_eq!(
        texts,
        [
            ["0.0", "-horn", "0.0"].map(str::to_owned),
            ["horn*cos(tilt)", "horn*sin(tilt)", "0.0"].map(str::to_owned),
            [
                format!("2.0*horn*{cosine:?}"),
                format!("2.0*horn*{sine:?}"),
                "0.0".to_owned()
            ],
        ]
    );
}

#[test]
fn x_and_y_may_be_measured_on_other_axes() {
    let mechanism = pendulum(
        "[measures]\n\
         height = { coordinate = 'y', markers = ['ground.O', 'rod.P'], axes = 'ground.E' }\n",
    );
    let coordinate = mechanism.measures[0].coordinate;
    assert_eq!(
        (coordinate.kind, coordinate.axes),
        (CoordinateKind::Y, MarkerId(1))
    );
}

#[test]
fn the_canonical_form_has_no_layout() {
    let plain = pendulum("[simulation]\nstop = 2\n").canonical;
    assert_eq!(
        pendulum("# longer\n[simulation]\n  stop = 2.0 # s\n").canonical,
        plain
    );
    assert_eq!(pendulum("[simulation]\nstop = 0.2e1\n").canonical, plain);
    assert_ne!(pendulum("[simulation]\nstop = 2.5\n").canonical, plain);
}
