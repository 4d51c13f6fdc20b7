//! Position, velocity and acceleration of every body against closed forms.

use crate::common::exact::{EXACT, Errors};
use crate::common::{assembled, parse, shipped, straight_to};
use crate::generated::{Ground, chain};
use biela::kinematics::{Direction, DriverPath, InstantCentre, Rates, Reason, Solver};
use biela::mechanism::{BodyId, DriverId, Jet, Order, ParameterId, Signal};

/// The solution is right to the rounding of the equations (some eps of the size) times the
/// condition of the Jacobian, which stays above 0.02 over these motions: 1e-14 for positions;
/// velocity and acceleration each pass through the Jacobian once more.
const LIMITS: [f64; 3] = [1e-14, 1e-13, 1e-12];

#[test]
fn the_four_systems_move_as_their_closed_forms_say() {
    for exact in EXACT {
        let mechanism = shipped(exact.file);
        let (mut solver, mut path) = assembled(&mechanism);
        let (from, to) = exact.range;
        straight_to(&solver, &mut path, from);
        solver.track(&path).expect("the start can be reached");
        let mut rates = Rates::new(solver.pose().q.len());
        let mut errors = Errors::default();
        // From rest with a constant acceleration, over one second.
        let acceleration = 2.0 * (to - from);
        let steps = 500;
        let h = 1.0 / f64::from(steps);
        for step in 0..steps {
            let t = h * f64::from(step);
            path.start = t;
            path.duration = h;
            path.driver_paths[0] = DriverPath::Input {
                position: from + 0.5 * acceleration * t * t,
                velocity: acceleration * t,
                acceleration,
                jump: 0.0,
            };
            let progress = solver.track(&path).expect("nothing is in the way");
            assert_eq!(progress.substeps, 1, "{}: an ordinary step", exact.file);
            let driver = Jet::new(
                solver.pose().drivers[0],
                [acceleration * (t + h), acceleration],
            );
            solver
                .solve_rates(|_| driver, &mut rates)
                .expect("the pose is regular");
            errors.collect(&solver, &rates, &exact.solution(&mechanism, driver));
        }
        let relative = errors.relative();
        println!("{}: {relative:?}", exact.file);
        for order in 0..3 {
            assert!(
                relative[order] <= LIMITS[order],
                "{}, order {order}: {relative:?}",
                exact.file
            );
        }
    }
}

/// Derivatives along several directions at once are those along each, up to the order asked for.
#[test]
fn sensitivities_along_several_directions_are_those_along_each() {
    let mechanism = shipped("four_bar");
    let (mut solver, _) = assembled(&mechanism);
    let driver = Jet::new(solver.pose().drivers[0], [2.0, 3.0]);
    let mut rates = Rates::new(solver.pose().q.len());
    solver
        .solve_rates(|_| driver, &mut rates)
        .expect("the pose is regular");
    let parameters = (0..mechanism.parameters.len()).map(ParameterId);
    let mut directions: Vec<_> = parameters
        .map(|parameter| Direction::by_parameter(&mechanism, parameter))
        .collect();
    let mut by_driver = Direction::zero(&mechanism);
    by_driver.drivers[0] = Jet::constant(1.0);
    directions.push(by_driver);
    let signal = Signal::Body(mechanism.body_id("rocker").expect("it has one"), 2);
    let each: Vec<Jet> = directions
        .iter()
        .map(|direction| {
            let along = solver.sensitivity(&rates, &[driver], direction);
            along.expect("the pose is regular").signal(signal)
        })
        .collect();
    assert!(each.iter().all(|change| change.value.abs() > 1e-3));
    for order in Order::ALL {
        let mut together = Vec::new();
        solver
            .sensitivities(&rates, &[driver], &directions, order, |along| {
                together.push(along.signal(signal));
                Ok(())
            })
            .expect("the pose is regular");
        for (one, other) in each.iter().zip(&together) {
            for lower in Order::ALL.into_iter().filter(|lower| *lower <= order) {
                assert_eq!(lower.of(*one).to_bits(), lower.of(*other).to_bits());
            }
        }
    }
}

/// A motion that gives up early has the bits of one that looks for the cause, and stops at a valid
/// pose in front of a dead point.
#[test]
fn a_motion_that_gives_up_is_the_same_up_to_its_stop() {
    let (mut solver, mut path) = assembled(&shipped("four_bar"));
    let mut twin = assembled(&shipped("four_bar")).0;
    for degrees in (70..420).step_by(10) {
        straight_to(&solver, &mut path, f64::from(degrees).to_radians());
        let progress = solver.track(&path).expect("the crank turns");
        assert_eq!(twin.track_or_give_up(&path), Ok(progress));
        assert_eq!(solver.pose(), twin.pose());
    }
    // The cylinder is as long as base and arm together at 0.65 m.
    let (mut solver, mut path) = assembled(&shipped("tlv"));
    straight_to(&solver, &mut path, 0.7);
    let blocked = solver
        .track_or_give_up(&path)
        .expect_err("the arm is stretched");
    assert!(matches!(blocked.reason, Reason::Lost));
    let [reached] = solver.pose().drivers[..] else {
        panic!("there is one driver")
    };
    // It stops where sub-steps of a ten-thousandth of the path are refused: the certificate takes
    // steps of up to a part of the distance from the dead point, some hundredths at the least.
    assert!((0.64..0.65).contains(&reached), "{reached}");
    assert!(solver.residual() < 1e-14);
}

/// Every rocker of a chain turns like the first, whether the chain stays where it is or goes away
/// 250 m. Rounding adds up from loop to loop, each passing on what it got and some eps of its
/// own: 1e-13 for each of a thousand loops at the most.
#[test]
fn a_long_chain_moves_as_its_first_loop() {
    const LOOPS: usize = 1000;
    for ground in [Ground::Zigzag, Ground::Straight] {
        let mechanism = parse(&chain(LOOPS, ground));
        let (mut solver, mut path) = assembled(&mechanism);
        let mut rates = Rates::new(solver.pose().q.len());
        for _ in 0..20 {
            let now = solver.pose().drivers[0];
            straight_to(&solver, &mut path, now + 0.05);
            let progress = solver.track(&path).expect("the crank turns fully");
            assert_eq!(progress.substeps, 1);
            let driver = Jet::new(0.0, [10.0, 3.0]);
            solver
                .solve_rates(|_| driver, &mut rates)
                .expect("the pose is regular");
            for values in [&solver.pose().q[..], rates.velocity(), rates.acceleration()] {
                let first = values[8];
                for loop_ in 1..LOOPS {
                    let off = (values[6 * loop_ + 8] - first).abs();
                    assert!(
                        off <= 1e-10 * first.abs(),
                        "loop {loop_}: {off:e} of {first}"
                    );
                }
            }
        }
    }
}

#[test]
fn a_wheel_rolls_on_either_side_of_a_tilted_track() {
    const RADIUS: f64 = 0.3;
    let (tilt, origin) = (0.5_f64, [0.1, -0.2]);
    for (side, sign) in [("above", 1.0), ("below", -1.0)] {
        let mechanism = parse(&format!(
            "format = 1\nname = 'wheel'\n[ground.markers]\ntrack = [0.1, -0.2, {tilt}]\n\
             [bodies.wheel]\nmarkers = {{ C = [0, 0] }}\nestimate = [0.1, {}, 0.5]\n[joints]\n\
             W = {{ type = 'rolling', markers = ['wheel.C', 'ground.track'], radius = {RADIUS}, \
             side = '{side}' }}\n[drivers]\n\
             u = {{ coordinate = 'x', markers = ['ground.track', 'wheel.C'], start = 0 }}\n",
            -0.2 + sign * RADIUS
        ));
        let (mut solver, mut path) = assembled(&mechanism);
        let mut rates = Rates::new(3);
        for travel in [0.4, -3.0, 20.0] {
            straight_to(&solver, &mut path, travel);
            solver
                .track(&path)
                .expect("a wheel rolls as far as it likes");
            let along = Jet::new(travel, [1.5, -0.5]);
            solver
                .solve_rates(|_| along, &mut rates)
                .expect("a wheel on its track has a regular Jacobian");
            let (sine, cosine) = tilt.sin_cos();
            let state = [
                solver.pose().q.as_slice(),
                rates.velocity(),
                rates.acceleration(),
            ];
            for (order, way) in [along.value, along.first(), along.second()]
                .into_iter()
                .enumerate()
            {
                let at_rest = if order == 0 { 1.0 } else { 0.0 };
                let truth = [
                    at_rest * (origin[0] - sign * RADIUS * sine) + way * cosine,
                    at_rest * (origin[1] + sign * RADIUS * cosine) + way * sine,
                    at_rest * tilt - sign * way / RADIUS,
                ];
                for (found, truth) in state[order].iter().zip(truth) {
                    // Some ulp of an angle of up to 67 rad.
                    assert!(
                        (found - truth).abs() < 1e-13,
                        "{side}: {found} is not {truth}"
                    );
                }
            }
        }
    }
}

/// Returns the instant centres of all bodies while the first driver moves alone.
fn instant_centres(solver: &mut Solver) -> Vec<InstantCentre> {
    let mut rates = Rates::new(solver.pose().q.len());
    let jet = |driver: DriverId| Jet::linear(0.0, f64::from(u8::from(driver.index() == 0)));
    solver.solve_rates(jet, &mut rates).expect("it moves");
    let bodies = (0..solver.mechanism().bodies.len()).map(BodyId);
    bodies
        .map(|body| solver.instant_centre(body, &rates))
        .collect()
}

/// Asserts that an instant centre is a point, to the rounding of rates: 1e-13 of some tenths of a
/// metre, divided by an angular velocity of about one.
fn assert_at(centre: InstantCentre, expected: [f64; 2]) {
    let InstantCentre::At([x, y]) = centre else {
        panic!("{centre:?}, not {expected:?}");
    };
    assert!(
        (x - expected[0]).hypot(y - expected[1]) < 1e-12,
        "{x}, {y}, not {expected:?}"
    );
}

#[test]
fn the_instant_centres_of_a_four_bar_are_in_line() {
    let (mut solver, mut path) = assembled(&shipped("four_bar"));
    for degrees in [60.0_f64, 100.0, 200.0, 300.0] {
        straight_to(&solver, &mut path, degrees.to_radians());
        solver.track(&path).expect("the crank turns fully");
        let q = solver.pose().q.clone();
        let centres = instant_centres(&mut solver);
        // Pivots O2 = (0, 0) and O4 = (0.4, 0); bars of 0.1 m and 0.3 m from them to A and B.
        let a = [0.1 * q[2].cos(), 0.1 * q[2].sin()];
        let b = [0.4 + 0.3 * q[8].cos(), 0.3 * q[8].sin()];
        assert_at(centres[0], [0.0, 0.0]);
        assert_at(centres[2], [0.4, 0.0]);
        // Kennedy's theorem: the coupler's centre is on the lines O2 A and O4 B.
        let determinant = a[0] * b[1] - a[1] * (b[0] - 0.4);
        let s = 0.4 * b[1] / determinant;
        assert_at(centres[1], [s * a[0], s * a[1]]);
    }
}

#[test]
fn sliders_translate_and_wheels_turn_about_their_contact() {
    let (mut solver, _) = assembled(&shipped("slider_crank"));
    let q = solver.pose().q.clone();
    let centres = instant_centres(&mut solver);
    assert_at(centres[0], [0.0, 0.0]);
    // The rod's centre is above the slider on the line of the crank.
    assert_at(centres[1], [q[6], q[6] * q[2].tan()]);
    assert_eq!(centres[2], InstantCentre::AtInfinity);

    // A rolling wheel is at rest where it touches its track.
    let (mut solver, mut path) = assembled(&shipped("rolling_wheel"));
    straight_to(&solver, &mut path, 1.0);
    solver.track(&path).expect("it rolls on");
    let centres = instant_centres(&mut solver);
    assert_at(centres[0], [solver.pose().q[0], 0.0]);

    // A body that another driver moves is at rest.
    let (mut solver, _) = assembled(&shipped("five_bar_robot"));
    let centres = instant_centres(&mut solver);
    let resting = centres
        .iter()
        .filter(|centre| **centre == InstantCentre::AtRest);
    assert_eq!(resting.count(), 1);
}
