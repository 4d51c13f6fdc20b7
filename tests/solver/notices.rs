//! Notices of a mechanism in motion: each is told once, whoever moves the mechanism.

use biela::dynamics::{GivenByPath, Motion, Notice};
use biela::kinematics::{Path, SolverChoices};

use super::rope::LOWERED;
use crate::common::{assembled, parse, straight_to};

fn sentences(motion: &mut Motion) -> Vec<String> {
    let mut sentences = Vec::new();
    motion.tell_notices(|notice| sentences.push(notice.to_string()));
    sentences
}

#[test]
fn limits_and_pulleys_are_told_once_per_excursion_and_anew_after_a_new_start() {
    let mechanism = parse(&LOWERED.replace("start = 0.5", "start = 0.5, min = -0.2"));
    let (solver, mut path) = assembled(&mechanism);
    let home = solver.pose().clone();
    let mut choices = SolverChoices::default();
    solver.copy_choices(&mut choices);
    let mut motion = Motion::new(solver);
    let (mut is_below, mut is_off) = (false, false);
    for height in [0.2, -0.15, -0.4, -0.6, 0.1, -0.5, f64::NAN, 0.3, -0.5] {
        if height.is_nan() {
            motion.begin(&home, &choices);
            (is_below, is_off) = (false, false);
            continue;
        }
        straight_to(&motion.solver, &mut path, height);
        motion.follow(&path).expect("the way is free");
        let q = &motion.pose().q;
        let along = (q[3] - q[0]).hypot(q[4]);
        // The distance of the pulley's centre from the straight rope, positive above it.
        let leaves = -q[4] * (1.0 - q[0]) / along > 0.1;
        let mut expected = Vec::new();
        if height < -0.2 && !is_below {
            expected.push("driver `height` is at ");
        }
        if leaves && !is_off {
            expected.push("rope `rope` would leave its pulley at `ground.F`");
        }
        (is_below, is_off) = (height < -0.2, leaves);
        let told = sentences(&mut motion);
        assert_eq!(told.len(), expected.len(), "{height}: {told:?}");
        let all = told
            .iter()
            .zip(&expected)
            .all(|(told, expected)| told.contains(expected));
        assert!(all, "{height}: {told:?}");
        assert!(sentences(&mut motion).is_empty(), "{height}");
    }
}

/// A mass that falls by 0.5 m onto a stop, from which it does not bounce.
const FALLING: &str = r#"
    format = 1
    name = "falling"
    [ground.markers]
    O = [0, 0, "90*deg"]
    [bodies.mass]
    mass = 1
    inertia = 1
    markers = { O = [0, 0, "90*deg"] }
    estimate = [0, 0.5, 0]
    [joints.guide]
    type = "translational"
    markers = ["ground.O", "mass.O"]
    [freedoms.height]
    coordinate = "x"
    markers = ["ground.O", "mass.O"]
    start = 0.5
    [stops.bottom]
    coordinate = "x"
    markers = ["ground.O", "mass.O"]
    min = 0
    [simulation]
    gravity = [0, -10]
"#;

#[test]
fn events_are_told_once_and_only_of_freedoms_that_were_released() {
    let mechanism = parse(FALLING);
    let (solver, mut path) = assembled(&mechanism);
    let mut motion = Motion::new(solver);
    motion.prepare_freedoms(Vec::new()).expect("a tolerance");
    let advance = |motion: &mut Motion, path: &mut Path, until: f64| {
        path.start = motion.pose().time;
        path.duration = until - path.start;
        let given = GivenByPath {
            path,
            load: |_, _| 0.0,
        };
        motion
            .advance(path, &given, until)
            .expect("nothing stops it");
    };
    advance(&mut motion, &mut path, 1.0);
    let height = motion.pose().drivers[0];
    assert!((height - 0.5).abs() < 1e-15, "it is held: {height}");
    assert!(sentences(&mut motion).is_empty());
    let given = GivenByPath {
        path: &path,
        load: |_, _| 0.0,
    };
    motion.release(&given).expect("it has a mass");
    advance(&mut motion, &mut path, 1.3);
    assert!(sentences(&mut motion).is_empty(), "it falls");
    advance(&mut motion, &mut path, 1.4);
    // It falls for sqrt(2 h/g), to the tolerance of integration, 1e-8 or less.
    let landing = 1.0 + 0.1_f64.sqrt();
    let mut events = Vec::new();
    motion.tell_notices(|notice| {
        let Notice::Event(event, _) = &notice else {
            panic!("{notice}")
        };
        assert!((event.time - landing).abs() < 1e-7, "{notice}");
        events.push(notice.to_string());
    });
    assert!(events[0].contains("at stop `bottom`"), "{events:?}");
    assert!(sentences(&mut motion).is_empty());
}

/// A mass that falls from 0.5 m through a table of its height that ends at 0.3 m, and faster than that of
/// its speed; its damper calls a third function, which repeats.
const TABLES: &str = r#"
    format = 1
    name = "tables"
    [functions]
    push = { table = [[0.3, 0], [1, 0]], law = "linear" }
    drag = { of = ["v"], value = "0*slow(-v)" }
    slow = { table = [[0, 0], [1.5, 1]], law = "linear" }
    again = { table = [[0, 0], [0.1, 0]], law = "linear", ends = "periodic" }
    [ground.markers]
    O = [0, 0, "90*deg"]
    [bodies.mass]
    mass = 1
    inertia = 1
    markers = { O = [0, 0, "90*deg"] }
    estimate = [0, 0.5, 0]
    [joints.guide]
    type = "translational"
    markers = ["ground.O", "mass.O"]
    [freedoms.height]
    coordinate = "x"
    markers = ["ground.O", "mass.O"]
    start = 0.5
    [forces.air]
    coordinate = "x"
    markers = ["ground.O", "mass.O"]
    value = "push(position) + drag(velocity) + again(position)"
    [simulation]
    gravity = [0, -10]
"#;

#[test]
fn a_function_that_is_called_beyond_its_points_is_told_once() {
    let mechanism = parse(TABLES);
    let (solver, mut path) = assembled(&mechanism);
    let mut motion = Motion::new(solver);
    motion.prepare_freedoms(Vec::new()).expect("a tolerance");
    let nothing = |_: usize, _: f64| 0.0;
    let given = GivenByPath {
        path: &path,
        load: nothing,
    };
    motion.release(&given).expect("it has a mass");
    let mut found = Vec::new();
    for step in 1..=30 {
        let until = 0.01 * f64::from(step);
        (path.start, path.duration) = (motion.pose().time, 0.01);
        let given = GivenByPath {
            path: &path,
            load: nothing,
        };
        motion
            .advance(&path, &given, until)
            .expect("nothing stops it");
        motion.tell_notices(|notice| {
            let Notice::Beyond(beyond, mechanism, time) = &notice else {
                panic!("{notice}")
            };
            let name = mechanism.functions.list()[beyond.function].name.clone();
            found.push((name, *time, until, beyond.argument, notice.to_string()));
        });
    }
    // It passes 0.3 m after 0.2 s, and falls at 1.5 m/s from 0.15 s on.
    let expected = [
        (
            "slow",
            0.15,
            " is called at 1.",
            " beyond its points from 0 to 1.5",
        ),
        (
            "push",
            0.2,
            " is called at 0.",
            " beyond its points from 0.3 to 1",
        ),
    ];
    assert_eq!(found.len(), 2, "{found:?}");
    for ((name, time, until, argument, text), (function, instant, at, points)) in
        found.iter().zip(expected)
    {
        assert_eq!(name, function);
        assert!(*time > instant && *time <= *until && until - instant < 0.0101);
        let exact = match function {
            "slow" => 10.0 * time,
            _ => 0.5 - 5.0 * time * time,
        };
        assert!((argument - exact).abs() < 1e-6, "{text}");
        assert!(text.contains(at) && text.contains(points), "{text}");
    }
}

/// A measure and a motion that call functions beyond their points.
#[test]
fn measures_and_motions_beyond_points_are_told() {
    let mechanism = parse(
        r#"
        format = 1
        name = "driven"
        functions.ramp = { table = [[0, 0], [1, 1]], law = "linear" }
        functions.gauge = { table = [[0, 0], [0.5, 1]], law = "linear" }
        ground.markers = { O = [0, 0] }
        bodies.arm.markers = { O = [0, 0] }
        joints.O = { type = "revolute", markers = ["ground.O", "arm.O"] }
        drivers.turn = { coordinate = "angle", markers = ["ground.O", "arm.O"], motion = "ramp(t)" }
        measures.shown = { value = "gauge(turn.position)" }
        "#,
    );
    let (solver, mut path) = assembled(&mechanism);
    let mut motion = Motion::new(solver);
    let mut told = Vec::new();
    for step in 0..4 {
        (path.start, path.duration) = (0.4 * f64::from(step), 0.4);
        motion.follow(&path).expect("the way is free");
        motion.take_rates();
        motion.solve().expect("rates");
        told.push(sentences(&mut motion));
    }
    let gauge = "t = 0.8 s: function `gauge` is called at 0.8, beyond its points from 0 to 0.5: its \
                 `ends` give the value";
    let ramp = gauge
        .replace("t = 0.8", "t = 1.2")
        .replace("`gauge` is called at 0.8", "`ramp` is called at 1.2")
        .replace("to 0.5", "to 1");
    assert_eq!(told, [vec![], vec![gauge.to_owned()], vec![ramp], vec![]]);
}
