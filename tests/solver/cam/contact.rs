//! The contact over many turns and large steps.

use std::f64::consts::{PI, TAU};

use biela::kinematics::{Path, Rates, Reason};
use biela::mechanism::Jet;
use proptest::prelude::*;

use crate::cam::{follower_height, with_profile};
use crate::common::{assembled, parse, shipped, straight_to};

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

/// A slip in a unit, such as an angle of 1e9 rad, is given up after a number of sub-steps that takes
/// less than a second.
#[test]
fn a_path_without_end_is_given_up_soon() {
    let (mut solver, mut path) = assembled(&shipped("cam_knife"));
    straight_to(&solver, &mut path, 1e9);
    let blocked = solver.track(&path).expect_err("it is too long");
    assert_eq!(blocked.reason, Reason::TooLong);
    // Two fiftieths of the most sub-steps.
    assert!(blocked.progress.substeps < 4_100, "{blocked:?}");
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
