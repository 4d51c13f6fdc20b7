//! Contours in pieces and by motion laws, and parameters that make none.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use biela::kinematics::{Path, Rates, Reason, Solver};
use biela::mechanism::Jet;

use crate::cam::{follower_height, text_with_profile, with_profile};
use crate::common::{assembled, parse, straight_to};

/// Contours of pieces that join smoothly: at the first three and the last the second derivative
/// is continuous, at the fourth it jumps.
const PIECES: [&str; 5] = [
    "0.05 + 0.002*max(cos(theta), 0)^4",
    "0.05 + 0.002*abs(sin(theta))^3",
    "0.05 + 0.002*max(1 - ((theta - 3)/1.5)^2, 0)^3",
    "0.05 + 0.002*max(0, sin(theta))^2",
    "0.05 + 0.001*(mod(theta, pi)/pi*(1 - mod(theta, pi)/pi))^2",
];

/// Turns a cam to an angle, in a step that is proved and has few sub-steps.
fn turn_to(solver: &mut Solver, path: &mut Path, angle: f64, what: &str) {
    straight_to(solver, path, angle);
    let progress = solver.track(path);
    let progress = progress.unwrap_or_else(|blocked| panic!("{what}: {blocked:?}"));
    assert_eq!(progress.checked, 0, "{what}");
    assert!(progress.substeps < 100, "{what}: {progress:?}");
    // Some hundred roundings of lengths and slopes.
    assert!(solver.residual() < 1e-13, "{what}");
}

/// A follower runs over the switches of such contours, in large steps and in small ones, both ways.
/// On the knife edge, which is above the axle, stands R(90° − u).
#[test]
fn contours_of_smooth_pieces_are_run_over() {
    for profile in PIECES {
        for name in ["cam_knife", "cam_roller", "cam_flat"] {
            for steps in [7, 20] {
                let mut solver = with_profile(name, &format!("'{profile}'"));
                let mechanism = solver.mechanism().clone();
                let mut path = Path::new(&mechanism);
                let start = solver.pose().drivers[0];
                let home = solver.pose().clone();
                for step in (1..=2 * steps).chain((0..2 * steps).rev()) {
                    let angle = start + TAU * f64::from(step) / f64::from(steps);
                    let what = format!("{name}, {profile}, {step} of {steps}");
                    turn_to(&mut solver, &mut path, angle, &what);
                    if name == "cam_knife" {
                        let theta = (TAU / 4.0 - angle).rem_euclid(TAU);
                        let height = follower_height(&solver, &mechanism);
                        let off = height - radius(profile, theta);
                        assert!(off.abs() < 1e-14, "{profile} at {theta}: {off:e}");
                    }
                }
                // Back where it began, to the rounding of angles of two turns.
                for (here, home) in solver.pose().q.iter().zip(&home.q) {
                    assert!((here - home).abs() < 1e-13, "{name}, {profile}");
                }
            }
        }
    }
}

/// The contours of [`PIECES`] in Rust.
fn radius(profile: &str, theta: f64) -> f64 {
    let index = PIECES.iter().position(|piece| *piece == profile);
    0.05 + match index.expect("it is one of them") {
        0 => 0.002 * theta.cos().max(0.0).powi(4),
        1 => 0.002 * theta.sin().abs().powi(3),
        2 => 0.002 * (1.0 - ((theta - 3.0) / 1.5).powi(2)).max(0.0).powi(3),
        3 => 0.002 * theta.sin().max(0.0).powi(2),
        _ => 0.001 * (theta.rem_euclid(PI) / PI * (1.0 - theta.rem_euclid(PI) / PI)).powi(2),
    }
}

/// Stroke and its first two derivatives after the part `x` of the time.
fn stroke(law: &str, x: f64) -> [f64; 3] {
    let mirrored = |x: f64, half: &dyn Fn(f64) -> [f64; 3]| {
        let [s, v, a] = half(x.min(1.0 - x));
        if x > 0.5 { [1.0 - s, v, -a] } else { [s, v, a] }
    };
    match law {
        "cycloidal" => [
            x - (TAU * x).sin() / TAU,
            1.0 - (TAU * x).cos(),
            TAU * (TAU * x).sin(),
        ],
        "harmonic" => [
            0.5 - 0.5 * (PI * x).cos(),
            0.5 * PI * (PI * x).sin(),
            0.5 * PI * PI * (PI * x).cos(),
        ],
        "polynomial_345" => [
            x.powi(3) * (10.0 - 15.0 * x + 6.0 * x * x),
            30.0 * (x * (1.0 - x)).powi(2),
            60.0 * x * (1.0 - x) * (1.0 - 2.0 * x),
        ],
        "polynomial_4567" => [
            x.powi(4) * (35.0 - 84.0 * x + 70.0 * x * x - 20.0 * x.powi(3)),
            140.0 * (x * (1.0 - x)).powi(3),
            420.0 * (x * (1.0 - x)).powi(2) * (1.0 - 2.0 * x),
        ],
        "trapezoidal" => mirrored(x, &|x| {
            if x < 1.0 / 3.0 {
                [2.25 * x * x, 4.5 * x, 4.5]
            } else {
                [1.5 * x - 0.25, 1.5, 0.0]
            }
        }),
        // Norton, Cam Design and Manufacturing Handbook, chapter 3: flanks of an eighth.
        _ => mirrored(x, &|x| {
            let (c, w) = (1.0 / (4.0 + PI), 4.0 * PI);
            if x < 0.125 {
                [
                    c * (PI * x - 0.25 * (w * x).sin()),
                    c * PI * (1.0 - (w * x).cos()),
                    c * PI * w * (w * x).sin(),
                ]
            } else {
                let y = (w * x + PI) / 3.0;
                [
                    c * (2.0 + PI * x - 2.25 * y.sin()),
                    c * PI * (1.0 - 3.0 * y.cos()),
                    c * PI * w * y.sin(),
                ]
            }
        }),
    }
}

/// The contour by a motion law and its first two derivatives: a rise of 90°, a dwell of 60° and a
/// return of 120°.
fn radius_by_law(law: &str, theta: f64) -> [f64; 3] {
    let (rise, dwell, back) = (TAU / 4.0, TAU / 6.0, TAU / 3.0);
    let on = |x: f64, width: f64, sign: f64| {
        let [s, v, a] = stroke(law, x / width);
        let s = if sign > 0.0 { s } else { 1.0 - s };
        [
            0.05 + 0.004 * s,
            sign * 0.004 * v / width,
            sign * 0.004 * a / (width * width),
        ]
    };
    if theta < rise {
        on(theta, rise, 1.0)
    } else if theta < rise + dwell {
        [0.054, 0.0, 0.0]
    } else if theta < rise + dwell + back {
        on(theta - rise - dwell, back, -1.0)
    } else {
        [0.05, 0.0, 0.0]
    }
}

/// Motion laws as cam designers write them, run over in large steps and in small ones. On the knife
/// edge stands R(90° − u).
#[test]
fn contours_by_motion_laws_are_run_over() {
    for law in [
        "cycloidal",
        "harmonic",
        "polynomial_345",
        "polynomial_4567",
        "modified_sine",
        "trapezoidal",
    ] {
        let profile = format!(
            "{{ table = [[0, 0.05], ['90*deg', 0.054], ['150*deg', 0.054], ['270*deg', 0.05]], \
             law = '{law}' }}"
        );
        for (name, steps) in [
            ("cam_knife", 7),
            ("cam_knife", 36),
            ("cam_roller", 20),
            ("cam_flat", 20),
        ] {
            let mut solver = with_profile(name, &profile);
            let mut path = Path::new(solver.mechanism());
            let start = solver.pose().drivers[0];
            for step in (1..=2 * steps).chain((0..2 * steps).rev()) {
                let angle = start + 0.1 + TAU * f64::from(step) / f64::from(steps);
                let what = format!("{name}, {law}, {step} of {steps}");
                turn_to(&mut solver, &mut path, angle, &what);
                if name == "cam_knife" {
                    compare_with_law(&mut solver, law, angle);
                }
            }
        }
    }
}

/// Compares a knife edge at an angle of its cam, and its rates, with the contour by a motion law.
fn compare_with_law(solver: &mut Solver, law: &str, angle: f64) {
    let mechanism = Arc::clone(solver.mechanism());
    let mut rates = Rates::new(solver.pose().q.len());
    let theta = (TAU / 4.0 - angle).rem_euclid(TAU);
    let [value, slope, second] = radius_by_law(law, theta);
    let off = follower_height(solver, &mechanism) - value;
    assert!(off.abs() < 1e-14, "{law} at {theta}: {off:e}");
    let turning = Jet::new(angle, [1.0, 0.0]);
    solver
        .solve_rates(|_| turning, &mut rates)
        .expect("regular");
    let follower = 3 * mechanism.body_id("follower").expect("it has one").index() + 1;
    // Some roundings of theta times the next derivative, below 1 m.
    assert!(
        (rates.velocity()[follower] + slope).abs() < 1e-13,
        "{law} at {theta}"
    );
    let off = rates.acceleration()[follower] - second;
    assert!(off.abs() < 1e-12, "{law} at {theta}: {off:e}");
}

/// Parameters that make no contour, or no roller, are refused with the reason, whether they come
/// between steps or at the start; the pose and its parameters are kept.
#[test]
fn parameters_that_make_no_contour_are_refused() {
    let profile = "'disc_radius + 0*eccentricity + sqrt(offset)*cos(theta)/20'";
    let text = text_with_profile("cam_roller", profile);
    let text = text.replace(
        "offset        = { value = 0.008,",
        "offset        = { tunable = true, value = 0.008,",
    );
    let mechanism = parse(&text);
    let parameter = |name: &str| mechanism.parameter_id(name).expect("it has one").index();
    for (name, value, reason) in [
        (
            "offset",
            -0.001,
            "joint `contact`: radius, slope and curvature of a contour must be finite; they are \
             not at theta = 0 deg",
        ),
        (
            "disc_radius",
            0.003,
            "joint `contact`: the radius of a contour must be positive; it is ",
        ),
        (
            "roller_radius",
            -0.005,
            "joint `contact` would hold a distance at -0.005 m; a distance must be positive",
        ),
    ] {
        let (mut solver, mut path) = assembled(&mechanism);
        let before = solver.pose().clone();
        path.to[parameter(name)] = value;
        let blocked = solver.track(&path).expect_err(name);
        let Reason::Value(_) = blocked.reason else {
            panic!("{name}: {blocked:?}");
        };
        // It stands where the last values of the way made a mechanism.
        assert!(solver.residual() < 1e-14, "{name}");
        let error = solver.assemble(&path).expect_err(name);
        assert!(error.to_string().starts_with(reason), "{name}: {error}");
        solver.restore(&before);
        assert_eq!(solver.pose(), &before);
        path.to.clone_from(&path.from);
        straight_to(&solver, &mut path, 3.0);
        solver.track(&path).expect("the mechanism is as it was");
    }
}
