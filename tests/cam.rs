//! Cams: the contact over many turns and large steps, and contours that a follower cannot follow.

mod common;

use std::f64::consts::{PI, TAU};

use biela::kinematics::{GeometryWarningKind, Path, Rates, Reason, Solver};
use biela::mechanism::{Jet, Mechanism};
use common::{assembled, parse, shipped, straight_to};
use proptest::prelude::*;

/// The place of a follower as a function of the cam angle.
type Law = fn(f64) -> f64;

/// Each translating cam of the gallery with the place of its follower in closed form; disc
/// 40 mm, eccentricity 15 mm, roller 10 mm, offset 8 mm.
const LAWS: [(&str, Law); 3] = [
    ("cam_knife", |u| 0.030 + 0.010 * (1.0 - u.sin())),
    ("cam_roller", |u| {
        0.015 * u.sin() + (0.05_f64.powi(2) - (0.008 - 0.015 * u.cos()).powi(2)).sqrt()
    }),
    ("cam_flat", |u| 0.040 + 0.015 * u.sin()),
];

fn follower_height(solver: &Solver, mechanism: &Mechanism) -> f64 {
    let follower = mechanism.body_id("follower").expect("it has one");
    solver.pose().q[3 * follower.index() + 1]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    /// The cam may jump by up to half a turn; the contact goes along. Heights are right to some
    /// eps of the 0.1 m that the mechanism measures, for rounding of the angle up to 100 rad.
    #[test]
    fn large_steps_keep_the_contact(steps in prop::collection::vec(-3.1..3.1_f64, 1..5)) {
        for (name, law) in LAWS {
            let mechanism = shipped(name);
            let (mut solver, mut path) = assembled(&mechanism);
            let mut angle = solver.pose().drivers[0];
            for step in &steps {
                angle += step;
                straight_to(&solver, &mut path, angle);
                prop_assert!(solver.track(&path).is_ok(), "{name} at {angle}");
                let off = follower_height(&solver, &mechanism) - law(angle);
                prop_assert!(off.abs() < 1e-14, "{name}: {off:e}");
            }
        }
    }
}

/// The contact of a flat face on a circle stays at the top of the circle: seen from the cam, its
/// tangent turns by −1 for each turn of the cam.
#[test]
fn the_contact_counts_turns() {
    let mechanism = shipped("cam_flat");
    let (mut solver, mut path) = assembled(&mechanism);
    let contact = 3 * mechanism.bodies.len();
    let (start, first) = (solver.pose().drivers[0], solver.pose().q[contact]);
    for turn in 1..=20 {
        let angle = start + TAU * f64::from(turn);
        straight_to(&solver, &mut path, angle);
        solver.track(&path).expect("the cam turns on for ever");
        let off = solver.pose().q[contact] - (first - TAU * f64::from(turn));
        // The angle itself has been rounded to half an ulp of up to 126 rad.
        assert!(off.abs() < 1e-13, "{turn}: {off:e}");
    }
}

/// On a bump of 0.1 rad a flat face would have to leap from one side to the other: no step passes
/// it unnoticed, however large, and none that goes the other way round is stopped. A knife edge
/// runs over it.
#[test]
fn a_large_step_does_not_pass_over_a_narrow_bump() {
    let bump = "0.04 + 0.002*exp(-(sin((theta - 3)/2)/0.05)^2)";
    for way in [1.0_f64, 3.0, 6.2] {
        for turn in [way, -way] {
            // The face is above the axle: it touches where theta = 90° − u, at u = −82° the bump.
            let mut solver = with_profile("cam_flat", &format!("\"{bump}\""));
            let (start, bump_at) = (solver.pose().drivers[0], 0.5 * PI - 3.0);
            let passes = [bump_at, bump_at + TAU]
                .iter()
                .any(|at| (at - start) * turn.signum() > 0.0 && (at - start).abs() < turn.abs());
            let mut path = Path::new(solver.mechanism());
            straight_to(&solver, &mut path, start + turn);
            let followed = solver.track(&path);
            assert_eq!(followed.is_err(), passes, "{turn}: {followed:?}");
        }
    }
    let text = std::fs::read_to_string("mechanisms/cam_knife.toml").expect("it is shipped");
    let text = text.replace("base + lift/2*(1 - cos(theta - phase))", bump);
    let (mut solver, mut path) = assembled(&parse(&text));
    let target = solver.pose().drivers[0] + TAU;
    straight_to(&solver, &mut path, target);
    let progress = solver
        .track(&path)
        .expect("the edge is a point of the contour");
    // Sub-steps on the bump are shorter than it is.
    assert!(progress.substeps > 20, "{progress:?}");
}

/// On a circle round the axle nothing moves but the contact; this is where the equations of the
/// contact are alone with their unknown.
#[test]
fn a_round_cam_moves_nothing() {
    for name in ["cam_roller", "cam_flat", "cam_roller_arm", "cam_flat_arm"] {
        let mechanism = shipped(name);
        let (mut solver, mut path) = assembled(&mechanism);
        let eccentricity = mechanism.parameter_id("eccentricity").expect("it has one");
        path.to[eccentricity.index()] = 0.0;
        solver.track(&path).expect("eccentricities between fit");
        path.from.clone_from(&path.to);
        let before = solver.pose().q[3..6].to_vec();
        straight_to(&solver, &mut path, 4.0);
        solver.track(&path).expect("a round cam turns");
        for (q, before) in solver.pose().q[3..6].iter().zip(before) {
            // Some eps of lengths up to 0.1 m and angles up to 3 rad.
            assert!((q - before).abs() < 4e-15, "{name}");
        }
        let mut rates = Rates::new(solver.pose().q.len());
        let turning = Jet::new(4.0, [10.0, 5.0]);
        solver
            .solve_rates(|_| turning, &mut rates)
            .expect("regular");
        let (contact, follower) = (3 * mechanism.bodies.len(), 3..6);
        assert!(
            rates.velocity()[follower.clone()]
                .iter()
                .all(|v| v.abs() < 1e-14)
        );
        assert!(
            rates.acceleration()[follower]
                .iter()
                .all(|a| a.abs() < 1e-12)
        );
        assert!((rates.velocity()[contact] + 10.0).abs() < 1e-13, "{name}");
        assert!(
            (rates.acceleration()[contact] + 5.0).abs() < 1e-12,
            "{name}"
        );
    }
}

/// Contours of pieces that join smoothly: at the first three and the last the second derivative
/// is continuous, at the fourth it jumps.
const PIECES: [&str; 5] = [
    "0.05 + 0.002*max(cos(theta), 0)^4",
    "0.05 + 0.002*abs(sin(theta))^3",
    "0.05 + 0.002*max(1 - ((theta - 3)/1.5)^2, 0)^3",
    "0.05 + 0.002*max(0, sin(theta))^2",
    "0.05 + 0.001*(mod(theta, pi)/pi*(1 - mod(theta, pi)/pi))^2",
];

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
                    straight_to(&solver, &mut path, angle);
                    let progress = solver.track(&path);
                    let progress = progress.unwrap_or_else(|blocked| {
                        panic!("{name}, {profile}, {step} of {steps}: {blocked:?}")
                    });
                    assert_eq!(progress.checked, 0, "{name}, {profile}, {step} of {steps}");
                    assert!(progress.substeps < 100, "{name}, {profile}: {progress:?}");
                    // Some hundred roundings of lengths and slopes.
                    assert!(solver.residual() < 1e-13, "{name}, {profile}");
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

/// A rise of 90°, a dwell of 60° and a return of 120° by each motion law, as cam designers write
/// them, run over in large steps and in small ones. On the knife edge stands R(90° − u).
#[test]
fn contours_by_motion_laws_are_run_over() {
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
    let radius = |law: &str, theta: f64| {
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
    };
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
            let mechanism = solver.mechanism().clone();
            let mut path = Path::new(&mechanism);
            let mut rates = Rates::new(solver.pose().q.len());
            let start = solver.pose().drivers[0];
            for step in (1..=2 * steps).chain((0..2 * steps).rev()) {
                let angle = start + 0.1 + TAU * f64::from(step) / f64::from(steps);
                straight_to(&solver, &mut path, angle);
                let progress = solver.track(&path);
                let progress = progress.unwrap_or_else(|blocked| {
                    panic!("{name}, {law}, {step} of {steps}: {blocked:?}")
                });
                assert_eq!(progress.checked, 0, "{name}, {law}, {step} of {steps}");
                assert!(progress.substeps < 100, "{name}, {law}: {progress:?}");
                // Some hundred roundings of lengths and slopes.
                assert!(solver.residual() < 1e-13, "{name}, {law}");
                if name != "cam_knife" {
                    continue;
                }
                let theta = (TAU / 4.0 - angle).rem_euclid(TAU);
                let [value, slope, second] = radius(law, theta);
                let off = follower_height(&solver, &mechanism) - value;
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
        }
    }
}

/// A slip in a unit, such as an angle of 1e9 rad, is given up after a number of sub-steps that takes
/// less than a second.
#[test]
fn a_path_without_end_is_given_up_soon() {
    let (mut solver, mut path) = assembled(&shipped("cam_knife"));
    straight_to(&solver, &mut path, 1e9);
    let blocked = solver.track(&path).expect_err("it is too long");
    assert_eq!(blocked.reason, Reason::TooLong);
    assert!(blocked.progress.substeps < 2_100, "{blocked:?}");
    // A thousand turns are none.
    let (mut solver, mut path) = assembled(&shipped("cam_knife"));
    straight_to(&solver, &mut path, 1e3 * TAU);
    solver.track(&path).expect("it turns on");
}

/// The disc grows a thousandfold within one step, its contour checked at every sub-step.
#[test]
fn a_large_change_of_a_contour_is_given_up_soon() {
    for (name, parameter) in [
        ("cam_roller", "disc_radius"),
        ("cam_roller_arm", "disc_radius"),
        ("cam_flat", "disc_radius"),
        ("cam_flat_arm", "disc_radius"),
        ("cam_knife", "base"),
    ] {
        let mechanism = shipped(name);
        let (mut solver, mut path) = assembled(&mechanism);
        let id = mechanism.parameter_id(parameter).expect(name);
        path.to[id.index()] = 40.0;
        let substeps = match solver.track(&path) {
            Ok(progress) => progress.substeps,
            Err(blocked) => blocked.progress.substeps,
        };
        assert!(substeps <= 1_000, "{name}: {substeps}");
    }
}

/// A shipped cam with another contour.
fn with_profile(name: &str, profile: &str) -> Solver {
    assembled(&parse(&text_with_profile(name, profile))).0
}

fn text_with_profile(name: &str, profile: &str) -> String {
    let path = format!("{}/mechanisms/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).expect("shipped mechanisms can be read");
    let start = text.find("profile = ").expect("it has a profile");
    let quoted = text[start..].match_indices('"').nth(1);
    let end = start + quoted.expect("it is a text").0 + 1;
    text.replace(&text[start..end], &format!("profile = {profile}"))
}

/// At θ = 60° of R = 0.05 + 0.01 cos 3θ the contour is hollow: R = 0.04, R″ = 0.09, so that the
/// curvature (R² − R R″)/R³ is −31.25/m and the radius of curvature 32 mm.
#[test]
fn a_roller_too_large_for_a_hollow_is_reported() {
    for (roller, fits) in [(0.0319, true), (0.0321, false)] {
        let mut solver = with_profile("cam_roller", "'0.05 + 0.01*cos(3*theta)'");
        let mechanism = solver.mechanism().clone();
        let mut path = biela::kinematics::Path::new(&mechanism);
        let radius = mechanism.parameter_id("roller_radius").expect("it has one");
        path.to[radius.index()] = roller;
        solver.assemble(&path).expect("it closes");
        match &solver.geometry_warnings()[..] {
            [] => assert!(fits),
            [misfit] => {
                assert!(!fits);
                let GeometryWarningKind::NarrowHollow {
                    ranges, curvature, ..
                } = &misfit.kind
                else {
                    panic!("{misfit}");
                };
                assert!((curvature - 0.032).abs() < 1e-9);
                // The three hollows, to the parts of a degree that are looked at.
                let middles = ranges
                    .iter()
                    .map(|[from, to]| (0.5 * (from + to)).to_degrees());
                let middles: Vec<_> = middles.map(|middle| middle.round()).collect();
                assert_eq!(middles, [60.0, 180.0, 300.0]);
            }
            more => panic!("{more:?}"),
        }
    }
}

/// R = 0.05 + 0.005 cos 3θ turns hollow where R² + 2R′² − R R″ = 0; at θ = 60° it is
/// 0.045² − 0.045·0.045 = 0 exactly: convex up to an amplitude of 5 mm.
#[test]
fn a_flat_face_over_a_hollow_is_reported() {
    for (amplitude, hollow) in [("0.0049", false), ("0.0051", true)] {
        let profile = format!("'0.05 + {amplitude}*cos(3*theta)'");
        let misfits = with_profile("cam_flat", &profile).geometry_warnings();
        let reported = misfits
            .iter()
            .any(|misfit| matches!(misfit.kind, GeometryWarningKind::HollowUnderFace { .. }));
        assert_eq!(
            (reported, misfits.len()),
            (hollow, usize::from(hollow)),
            "{misfits:?}"
        );
    }
}

#[test]
fn the_gallery_fits() {
    for entry in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/mechanisms"))
        .expect("the folder is there")
    {
        let path = entry.expect("it can be read").path();
        if path
            .extension()
            .is_some_and(|extension| extension == "toml")
        {
            let name = path.file_stem().expect("it has a name").to_string_lossy();
            let misfits = assembled(&shipped(&name)).0.geometry_warnings();
            assert!(misfits.is_empty(), "{name}: {misfits:?}");
        }
    }
}

/// Gears, belts and racks whose places do not fit their radii, each with the figures.
#[test]
fn wheels_that_do_not_fit_are_reported() {
    let pair = |joint: &str| {
        let mechanism = parse(&format!(
            "format = 1\nname = 'pair'\n[ground.markers]\nA = [0, 0]\nB = [0.3, 0.4]\n\
             [bodies.a]\nmarkers = {{ O = [0, 0] }}\n[bodies.b]\nmarkers = {{ O = [0, 0] }}\n\
             estimate = [0.3, 0.4, 0]\n[joints]\n\
             A = {{ type = 'revolute', markers = ['ground.A', 'a.O'] }}\n\
             B = {{ type = 'revolute', markers = ['ground.B', 'b.O'] }}\n{joint}\n[drivers]\n\
             u = {{ coordinate = 'angle', markers = ['ground.A', 'a.O'], start = 0 }}\n"
        ));
        let misfits = assembled(&mechanism).0.geometry_warnings();
        misfits.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    let wheels = |kind: &str, radii: &str, more: &str| {
        pair(&format!(
            "W = {{ type = '{kind}', markers = ['a.O', 'b.O'], radii = {radii}{more} }}"
        ))
    };
    let fits: [String; 0] = [];
    assert_eq!(wheels("gear", "[0.2, 0.3]", ""), fits);
    assert_eq!(wheels("gear", "[0.7, 0.2]", ", internal = true"), fits);
    assert_eq!(
        wheels("gear", "[0.2, 0.31]", ""),
        ["joint `W`: the centres are 0.500000 m apart; the radii ask for 0.510000 m"]
    );
    assert_eq!(
        wheels("gear", "[0.2, 0.3]", ", internal = true"),
        ["joint `W`: the centres are 0.500000 m apart; the radii ask for 0.100000 m"]
    );
    assert_eq!(wheels("belt", "[0.2, 0.6]", ""), fits);
    assert_eq!(
        wheels("belt", "[0.2, 0.4]", ", crossed = true"),
        [
            "joint `W`: the centres are 0.500000 m apart; wheels of these radii need more than \
             0.600000 m"
        ]
    );
    let rack = |side: &str| {
        let mechanism = parse(&format!(
            "format = 1\nname = 'rack'\n[ground.markers]\nO = [0, 0.05]\nway = [0, 0]\n\
             [bodies.pinion]\nmarkers = {{ O = [0, 0] }}\n[bodies.rack]\nmarkers = {{ R = [0, 0] }}\n\
             [joints]\nO = {{ type = 'revolute', markers = ['ground.O', 'pinion.O'] }}\n\
             way = {{ type = 'translational', markers = ['ground.way', 'rack.R'] }}\n\
             W = {{ type = 'rack_and_pinion', markers = ['pinion.O', 'rack.R'], radius = 0.05, side = '{side}' }}\n\
             [drivers]\nu = {{ coordinate = 'angle', markers = ['ground.O', 'pinion.O'], start = 0 }}\n"
        ));
        let misfits = assembled(&mechanism).0.geometry_warnings();
        misfits.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    assert_eq!(rack("above"), fits);
    assert_eq!(
        rack("below"),
        [
            "joint `W`: the pinion's centre is at y = 0.050000 m of the rack; its radius and \
             side ask for -0.050000 m"
        ]
    );
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

/// A roller estimated inside the contour comes out on the side on which it is, not through the
/// axle on the other.
#[test]
fn a_rough_estimate_keeps_its_side() {
    let path = format!("{}/mechanisms/cam_roller.toml", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).expect("shipped mechanisms can be read");
    let (_, law) = LAWS[1];
    for height in ["0.005", "0.01", "0.03", "0.2"] {
        let text = text.replace(
            "[\"offset\", 0.06, 0]",
            &format!("[\"offset\", {height}, 0]"),
        );
        let mechanism = parse(&text.replace("60*deg", "90*deg"));
        let (solver, _) = assembled(&mechanism);
        let off = follower_height(&solver, &mechanism) - law(90_f64.to_radians());
        assert!(off.abs() < 1e-15, "{height}: {off:e}");
    }
}

/// A cam takes the same sub-steps whatever its size, also where all markers are at its center. The
/// knife edge runs on the contour: y = R(π/2 − u).
#[test]
fn a_cam_of_a_tenth_of_a_millimetre_costs_no_more_than_one_of_a_kilometre() {
    let radius = |theta: f64| {
        0.12 + 0.03 * (2.0 * theta).cos() + 0.03 * (((theta - 1.0).cos() - 1.0) / 0.0025).exp()
    };
    let runs = [1e-3, 1.0, 1e4].map(|scale: f64| {
        let (mut solver, mut path) = assembled(&parse(&format!(
            r#"
            format = 1
            name = "cam"
            [parameters]
            scale = {scale:e}
            [ground.markers]
            O = [0, 0]
            guide = [0, 0, "90*deg"]
            [bodies.cam]
            markers = {{ O = [0, 0] }}
            estimate = [0, 0, 0]
            [bodies.follower]
            markers = {{ A = [0, 0, "90*deg"] }}
            estimate = [0, "0.1*scale", 0]
            [joints]
            O = {{ type = "revolute", markers = ["ground.O", "cam.O"] }}
            guide = {{ type = "translational", markers = ["ground.guide", "follower.A"] }}
            [joints.contact]
            type = "cam"
            markers = ["cam.O", "follower.A"]
            follower = "knife"
            profile = "scale*(0.12 + 0.03*cos(2*theta) + 0.03*exp((cos(theta - 1) - 1)/0.0025))"
            [drivers]
            u = {{ coordinate = "angle", markers = ["ground.O", "cam.O"], start = 0 }}
            "#
        )));
        straight_to(&solver, &mut path, 3.0);
        let progress = solver.track(&path).expect("it turns fully");
        // The slope of the lobe is below 1 m/rad: an eps of the angle is one of the height.
        let height = solver.pose().q[4] / scale;
        assert!((height - radius(0.5 * PI - 3.0)).abs() < 1e-14);
        progress.substeps
    });
    let [small, middle, large] = runs.map(f64::from);
    for other in [small, large] {
        let ratio = other / middle;
        assert!((0.5..=2.0).contains(&ratio), "{runs:?}");
    }
}
