//! Rates of inputs (4.2.1), and what a host is told about them.

use std::f64::consts::{PI, TAU};

use biela::fmi::{Category, Interface, Version, describe};

use crate::clauses::{get, running, set, started, vr};
use crate::common::log::Heard;
use crate::common::{assembled, co_simulation, instance_of, parse, shipped};

const POSITION: &str = "crank_angle.position";
const VELOCITY: &str = "crank_angle.velocity";
const ACCELERATION: &str = "crank_angle.acceleration";

/// A crank that turns as u = 1 + sin(2 pi t).
fn sine(t: f64) -> [f64; 3] {
    let (sin, cos) = (TAU * t).sin_cos();
    [1.0 + sin, TAU * cos, -TAU * TAU * sin]
}

/// "Different input variables may have different interpolation order": order 1 for the position
/// leaves the acceleration that is wired.
#[test]
fn input_derivatives_of_order_1_leave_the_wired_acceleration() {
    let mut instance = running("four_bar");
    let position = vr(&instance, POSITION);
    let h = 0.01;
    for step in 0..40 {
        let t = h * f64::from(step);
        let [u, v, a] = sine(t);
        set(
            &mut instance,
            [(POSITION, u), (VELOCITY, v), (ACCELERATION, a)],
        );
        let given = instance.set_real_input_derivatives(&[position], &[1], &[v]);
        given.expect("it is an input");
        instance.do_step(t, h).expect("it turns freely");
        let found = get(&mut instance, ["crank.phi", "crank.omega", "crank.alpha"]);
        for (found, expected) in found.into_iter().zip([u + h * v, v, a]) {
            assert!((found - expected).abs() < 1e-11, "{t}: {found} {expected}");
        }
    }
}

/// The velocity's own derivative carries it to the end of the step, and is the acceleration.
#[test]
fn derivatives_of_the_velocity_are_the_acceleration_at_the_end_of_the_step() {
    let mut instance = running("four_bar");
    let velocity = vr(&instance, VELOCITY);
    set(&mut instance, [(VELOCITY, 2.0)]);
    let given = instance.set_real_input_derivatives(&[velocity], &[1], &[3.0]);
    given.expect("it is an input");
    instance.do_step(0.0, 0.5).expect("the crank stands");
    let [omega, alpha] = get(&mut instance, ["crank.omega", "crank.alpha"]);
    assert!((omega - 3.5).abs() < 1e-13 && (alpha - 3.0).abs() < 1e-12);
}

#[test]
fn a_velocity_set_before_the_end_of_initialization_counts_at_the_start_only() {
    let mut instance = co_simulation("four_bar");
    instance.setup_experiment(0.0, None).expect("legal");
    set(&mut instance, [(VELOCITY, 5.0)]);
    instance.enter_initialization_mode().expect("legal");
    assert_eq!(get(&mut instance, ["crank.omega"]), [5.0]);
    instance.exit_initialization_mode().expect("it starts");
    assert_eq!(get(&mut instance, ["crank.omega"]), [5.0]);
    // The host wires the position alone, and moves it at 2 rad/s.
    for step in 0..5 {
        let t = 0.1 * f64::from(step);
        set(&mut instance, [(POSITION, 1.0 + 2.0 * t)]);
        instance.do_step(t, 0.1).expect("it turns freely");
    }
    let [omega] = get(&mut instance, ["crank.omega"]);
    assert!((omega - 2.0).abs() < 1e-12, "{omega}");
}

/// Drives the crank with the angle from `position` and rates that `rates` sets; returns advice.
fn advice(
    interface: Interface,
    rates: i32,
    position: impl Fn(f64) -> f64,
    given: impl Fn(f64) -> [Option<f64>; 2],
) -> Vec<String> {
    let heard = Heard::default();
    let mut instance = heard.instance(shipped("four_bar"), interface, true);
    let choice = vr(&instance, "rates");
    instance.set_integer(&[choice], &[rates]).expect("legal");
    let mut instance = started(instance);
    heard.take_all();
    let h = 0.01;
    for step in 0..50 {
        let t = h * f64::from(step);
        let at = match interface {
            Interface::CoSimulation => t,
            Interface::ModelExchange => t + h,
        };
        set(&mut instance, [(POSITION, position(at))]);
        for (name, rate) in [VELOCITY, ACCELERATION].into_iter().zip(given(at)) {
            if let Some(rate) = rate {
                set(&mut instance, [(name, rate)]);
            }
        }
        match interface {
            Interface::CoSimulation => instance.do_step(t, h).expect("it turns freely"),
            Interface::ModelExchange => {
                instance.set_time(at).expect("legal");
                let ended = instance.completed_integrator_step();
                assert_eq!(ended.map(|step| step.must_end), Ok(false));
            }
        }
    }
    heard.take(Category::Warning)
}

fn turning(t: f64) -> f64 {
    PI / 3.0 + 10.0 * t
}

#[test]
fn a_velocity_that_contradicts_the_motion_draws_one_warning() {
    let co_simulation = Interface::CoSimulation;
    let wrong = advice(co_simulation, 1, turning, |_| [Some(2.0), None]);
    let [message] = &wrong[..] else {
        panic!("{wrong:?}")
    };
    for part in [
        "the velocity of driver `crank_angle` is given as 2 rad/s",
        "its position changes by 10",
        "connect `crank_angle.velocity`, or set `rates` to 3",
    ] {
        assert!(message.contains(part), "{message}");
    }
    // `rates = inputs` takes a velocity that nobody connects as 0.
    assert_eq!(advice(co_simulation, 2, turning, |_| [None; 2]).len(), 1);
    for rates in [1, 2] {
        let right = advice(co_simulation, rates, turning, |_| [Some(10.0), Some(0.0)]);
        assert_eq!(right, [""; 0]);
    }
    assert_eq!(advice(co_simulation, 1, turning, |_| [None; 2]), [""; 0]);
    assert_eq!(
        advice(co_simulation, 3, turning, |_| [Some(2.0), None]),
        [""; 0]
    );
    let all = |t| sine(t).map(Some);
    let right = advice(co_simulation, 2, |t| sine(t)[0], |t| [all(t)[1], all(t)[2]]);
    assert_eq!(right, [""; 0]);
}

#[test]
fn an_acceleration_that_contradicts_the_motion_draws_one_warning() {
    let found = advice(
        Interface::CoSimulation,
        2,
        |t| sine(t)[0],
        |t| [Some(sine(t)[1]), None],
    );
    let [message] = &found[..] else {
        panic!("{found:?}")
    };
    assert!(
        message.contains("connect `crank_angle.acceleration`"),
        "{message}"
    );
}

#[test]
fn model_exchange_with_the_position_alone_draws_one_warning() {
    let exchange = Interface::ModelExchange;
    let found = advice(exchange, 1, turning, |_| [None; 2]);
    let [message] = &found[..] else {
        panic!("{found:?}")
    };
    assert!(
        message.ends_with("connect `crank_angle.velocity`"),
        "{message}"
    );
    let right = advice(exchange, 1, turning, |_| [Some(10.0), None]);
    assert_eq!(right, [""; 0]);
}

#[test]
fn each_change_of_the_source_of_a_rate_is_an_event() {
    let heard = Heard::default();
    let mut instance = started(heard.instance(shipped("four_bar"), Interface::CoSimulation, true));
    heard.take_all();
    let mut events = Vec::new();
    for step in 0..6 {
        let t = 0.1 * f64::from(step);
        set(&mut instance, [(POSITION, 1.0 + t)]);
        if step == 2 {
            set(&mut instance, [(VELOCITY, 1.0)]);
        }
        if step == 4 {
            set(&mut instance, [(ACCELERATION, 0.1)]);
        }
        instance.do_step(t, 0.1).expect("it turns freely");
        events.push(heard.take(Category::Events));
    }
    let now = |rate: &str, source: &str| {
        format!("the {rate} of driver `crank_angle` now comes from {source}")
    };
    let expected = [
        vec![],
        vec![],
        vec![now("velocity", "the rate input")],
        vec![now("acceleration", "differences of the velocity")],
        vec![now("acceleration", "the rate input")],
        vec![],
    ];
    for (step, (events, expected)) in events.iter().zip(expected).enumerate() {
        assert_eq!(events.len(), expected.len(), "{step}: {events:?}");
        for (event, expected) in events.iter().zip(expected) {
            assert!(event.ends_with(&expected), "{step}: {event}");
        }
    }
}

/// A host that wraps the crank's angle at 2 pi.
fn wrapped(text: &str) -> (Vec<[f64; 2]>, Vec<String>) {
    let heard = Heard::default();
    let mut instance = started(heard.instance(parse(text), Interface::CoSimulation, true));
    let (h, speed) = (0.01, 10.0);
    let mut found = Vec::new();
    for step in 0..200 {
        let t = h * f64::from(step);
        let angle = (PI / 3.0 + speed * t).rem_euclid(TAU);
        set(&mut instance, [(POSITION, angle)]);
        instance.do_step(t, h).expect("it turns freely");
        found.push(get(&mut instance, ["crank.phi", "crank.omega"]));
    }
    (found, heard.take(Category::Warning))
}

fn four_bar_text() -> String {
    let path = crate::common::folder("mechanisms").join("four_bar.toml");
    std::fs::read_to_string(path).expect("it is shipped")
}

#[test]
fn a_fall_by_more_than_half_a_turn_draws_one_warning() {
    let (found, advice) = wrapped(&four_bar_text());
    assert!(found.iter().any(|[_, omega]| *omega < -10.0), "it unwinds");
    let [message] = &advice[..] else {
        panic!("{advice:?}")
    };
    assert!(
        message.contains("driver `crank_angle` jumps by -6."),
        "{message}"
    );
    assert!(message.contains("`wrapped = true`"), "{message}");
}

/// The key `wrapped`: each value means the turn nearest the last one.
#[test]
fn a_wrapped_angle_goes_on_turning() {
    let own = "start = \"60*deg\" }";
    let text = four_bar_text();
    assert!(text.contains(own));
    let (found, advice) = wrapped(&text.replace(own, "start = \"60*deg\", wrapped = true }"));
    assert_eq!(advice, [""; 0]);
    for (step, [phi, omega]) in (0_u32..).zip(found) {
        let expected = PI / 3.0 + 0.1 * f64::from(step);
        assert!((phi - expected).abs() < 1e-12, "{step}: {phi} {expected}");
        // Rounding of angles up to 21 rad, differentiated over 0.01 s.
        assert!(step < 1 || (omega - 10.0).abs() < 1e-11, "{step}: {omega}");
    }
}

/// Limits of an input are information (2.2.3): each excursion draws one message and is followed.
#[test]
fn a_driver_beyond_its_limits_is_followed_with_one_warning() {
    let own = "start = \"60*deg\" }";
    let limited = four_bar_text().replace(own, "start = \"60*deg\", min = 1, max = 1.5 }");
    let mechanism = parse(&limited);
    let (solver, _) = assembled(&mechanism);
    let xml = describe(solver.mechanism(), solver.structure(), Version::Fmi2).write(None);
    let xml = String::from_utf8(xml).expect("XML is text");
    assert!(xml.contains("min=\"1.0\" max=\"1.5\""), "{xml}");

    let heard = Heard::default();
    let mut instance = started(heard.instance(mechanism, Interface::CoSimulation, true));
    let mut warnings = Vec::new();
    for (step, angle) in [1.2, 1.6, 1.7, 1.4, 0.9].into_iter().enumerate() {
        set(&mut instance, [(POSITION, angle)]);
        instance.do_step(step as f64, 1.0).expect("it turns freely");
        let [phi] = get(&mut instance, ["crank.phi"]);
        assert!((phi - angle).abs() < 1e-14, "{phi}");
        warnings.push(heard.take(Category::Warning));
    }
    let counts: Vec<_> = warnings.iter().map(Vec::len).collect();
    assert_eq!(counts, [0, 1, 0, 0, 1]);
    assert!(warnings[1][0].contains("driver `crank_angle` is at 1.600000000 rad"));
    assert!(warnings[1][0].contains("beyond its `max` = 1.500000000 rad"));
    assert!(warnings[4][0].contains("beyond its `min` = 1.000000000 rad"));
}

/// A wrapped angle that jumps by 2 rad and rests, while estimated rates extrapolate each step: its
/// turns are those of the same angle without `wrapped`.
#[test]
fn an_extrapolated_wrapped_angle_keeps_to_its_turn() {
    let text = std::fs::read_to_string("mechanisms/four_bar.toml").expect("it is shipped");
    let crank = |start: &str| parse(&text.replace("start = \"60*deg\"", start));
    let follow = |start: &str| {
        let mut instance = instance_of(crank(start), Interface::CoSimulation);
        let rule = ["rates", "extrapolation"].map(|name| vr(&instance, name));
        instance.set_integer(&rule, &[1, 2]).expect("settings");
        let mut instance = started(instance);
        let steps = [
            0.0,
            0.0,
            2.0,
            2.0,
            2.0,
            2.0,
            2.0,
            4.0 - TAU,
            6.0 - TAU,
            6.0 - TAU,
        ];
        let turns = if start.contains("wrapped") { 0.0 } else { TAU };
        steps
            .into_iter()
            .enumerate()
            .map(|(step, position)| {
                let turn = if step > 6 { turns } else { 0.0 };
                set(&mut instance, [(POSITION, position + turn)]);
                let stepped = instance.do_step(0.01 * step as f64, 0.01);
                stepped.expect("it turns freely");
                get(&mut instance, ["crank.phi"])[0]
            })
            .collect::<Vec<f64>>()
    };
    let (wrapped, whole) = (follow("start = 0, wrapped = true"), follow("start = 0"));
    for (wrapped, whole) in wrapped.into_iter().zip(whole) {
        // Some roundings of a turn, carried on by estimates.
        assert!(
            (wrapped - whole).abs() < 64.0 * f64::EPSILON * TAU,
            "{wrapped} {whole}"
        );
    }
}

/// The first step is short beside the second, which takes no estimate from it: in the second the
/// crank rests whatever its position.
#[test]
fn derivatives_leave_out_the_short_step_that_rates_left_out() {
    let mut instance = running("four_bar");
    instance.do_step(0.0, 0.005).expect("it turns freely");
    set(&mut instance, [(POSITION, 1.1)]);
    instance.do_step(0.005, 1.0).expect("it turns freely");
    assert_eq!(get(&mut instance, ["crank.omega"]), [0.0]);
    let names = ["crank.phi", "crank.omega"].map(|name| vr(&instance, name));
    let position = vr(&instance, POSITION);
    let by_position = instance.directional_derivative(&names, &[position], &[1.0]);
    assert_eq!(by_position.expect("it turns freely"), [1.0, 0.0]);
}
