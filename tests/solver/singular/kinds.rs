//! Positions that are crossed, dead points, and refusals by name, on mechanisms of all kinds
//! of blocks.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::common::{assembled, parse, straight_to};
use crate::generated::{BAR, scissor_lift};
use biela::kinematics::{
    Blocked, End, Progress, RangeSettings, Rates, Reason, SingularKind, Solver,
};
use biela::mechanism::{DriverId, Jet};

/// Moves the first driver to a value.
fn go(solver: &mut Solver, target: f64) -> Result<Progress, Blocked> {
    let mut path = biela::kinematics::Path::new(solver.mechanism());
    straight_to(solver, &mut path, target);
    solver.track(&path)
}

/// Parallelograms in a row, each hung on the one before: all of them flat at once.
fn row(cranks: usize) -> String {
    use std::fmt::Write as _;
    let mut text = "format = 1\nname = 'row'\n[ground.markers]\n".to_owned();
    for k in 0..cranks {
        let _ = writeln!(text, "O{k} = [{}, 0]", 0.2 * k as f64);
    }
    for k in 0..cranks {
        let x = 0.2 * k as f64;
        let _ = writeln!(
            text,
            "[bodies.crank{k}]\nmarkers = {{ O = [0, 0], A = [0.1, 0] }}\nestimate = [{x}, 0, 1]"
        );
        if k > 0 {
            let _ = writeln!(
                text,
                "[bodies.rod{k}]\nmarkers = {{ A = [0, 0], B = [0.2, 0] }}\n\
                 estimate = [{}, 0.08, 0]",
                x - 0.15
            );
        }
    }
    text += "[joints]\n";
    for k in 0..cranks {
        let _ = writeln!(
            text,
            "O{k} = {{ type = 'revolute', markers = ['ground.O{k}', 'crank{k}.O'] }}"
        );
        if k > 0 {
            let _ = writeln!(
                text,
                "A{k} = {{ type = 'revolute', markers = ['crank{}.A', 'rod{k}.A'] }}\n\
                 B{k} = {{ type = 'revolute', markers = ['rod{k}.B', 'crank{k}.A'] }}",
                k - 1
            );
        }
    }
    text + "[drivers]\nu = { coordinate = 'angle', markers = ['ground.O0', 'crank0.O'], start = 1 }\n"
}

#[test]
fn blocks_that_depend_on_each_other_cross_together() {
    let (mut solver, _) = assembled(&parse(&row(6)));
    let mut rates = Rates::new(solver.pose().q.len());
    let driver = Jet::new(0.0, [1.0, 0.4]);
    for target in [3.13, PI, 3.15, 4.0, PI + 4e-4, 2.0, 2.0 + 3.0 * TAU] {
        go(&mut solver, target).unwrap_or_else(|blocked| panic!("{target}: {blocked:?}"));
        solver
            .solve_rates(|_| driver, &mut rates)
            .expect("it moves");
        let mechanism = solver.mechanism();
        for (index, body) in mechanism.bodies.iter().enumerate() {
            let turns = f64::from(u8::from(body.name.starts_with("crank")));
            let phi = 3 * index + 2;
            assert!(
                (solver.pose().q[phi] - turns * target).abs() < 1e-11,
                "{target}"
            );
            assert!((rates.velocity()[phi] - turns).abs() < 1e-9, "{target}");
            assert!(
                (rates.acceleration()[phi] - 0.4 * turns).abs() < 1e-6,
                "{target}"
            );
        }
    }
    // Five loops, six times.
    let passed = go(&mut solver, 2.0 + 6.0 * TAU).expect("they turn fully");
    assert_eq!(passed.crossings, 5 * 6);
}

/// All links equal: where the rhombus lies on itself its other motion leaves the crank where it
/// is, and at 180° it crosses one in which the follower stands still.
#[test]
fn a_rhombus_turns_on() {
    let text = std::fs::read_to_string("mechanisms/parallelogram.toml")
        .expect("it is shipped")
        .replace(
            "base         = { value = 0.20",
            "base         = { value = 0.10",
        );
    let (mut solver, _) = assembled(&parse(&text));
    for step in 1..=300 {
        let target = 1.0 + TAU * f64::from(step) / 30.0;
        go(&mut solver, target).unwrap_or_else(|blocked| panic!("{target}: {blocked:?}"));
        assert!((solver.pose().q[8] - target).abs() < 1e-11);
        assert!(solver.pose().q[5].abs() < 1e-11);
    }
}

/// Driven by the angle of the follower against the coupler, which makes one block of all.
#[test]
fn a_parallelogram_driven_inside_its_loop_turns_on() {
    let text = std::fs::read_to_string("mechanisms/parallelogram.toml")
        .expect("it is shipped")
        .replace(
            "markers = [\"ground.O2\", \"crank.O\"], start",
            "markers = [\"coupler.B\", \"follower.B\"], start",
        );
    let (mut solver, _) = assembled(&parse(&text));
    for step in 1..=300 {
        let target = PI / 3.0 + TAU * f64::from(step) / 30.0;
        go(&mut solver, target).unwrap_or_else(|blocked| panic!("{target}: {blocked:?}"));
        assert!((solver.pose().q[8] - target).abs() < 1e-11);
        assert!((solver.pose().q[2] - target).abs() < 1e-11);
    }
}

/// A slider-crank with a rod as long as its crank: with the crank upright the slider is over the
/// pivot, where it could stay. The smooth motion takes it to the other side, x = 2 r cos u.
#[test]
fn an_isosceles_slider_crank_goes_through_the_middle() {
    let (mut solver, _) = assembled(&parse(
        "format = 1\nname = 'slider'\n[ground.markers]\nO = [0, 0]\n\
         [bodies.crank]\nmarkers = { O = [0, 0], A = [0.1, 0] }\nestimate = [0, 0, 1]\n\
         [bodies.rod]\nmarkers = { A = [0, 0], B = [0.1, 0] }\nestimate = [0.05, 0.08, -1]\n\
         [bodies.slider]\nmarkers = { B = [0, 0] }\nestimate = [0.1, 0, 0]\n\
         [joints]\nO = { type = 'revolute', markers = ['ground.O', 'crank.O'] }\n\
         A = { type = 'revolute', markers = ['crank.A', 'rod.A'] }\n\
         B = { type = 'revolute', markers = ['rod.B', 'slider.B'] }\n\
         way = { type = 'translational', markers = ['ground.O', 'slider.B'] }\n\
         [drivers]\nu = { coordinate = 'angle', markers = ['ground.O', 'crank.O'], start = 1 }\n",
    ));
    for step in 1..=300 {
        let target = 1.0 + TAU * f64::from(step) / 30.0;
        go(&mut solver, target).unwrap_or_else(|blocked| panic!("{target}: {blocked:?}"));
        assert!(
            (solver.pose().q[6] - 0.2 * target.cos()).abs() < 1e-12,
            "{target}"
        );
    }
    go(&mut solver, FRAC_PI_2 + 4.0 * TAU).expect("the middle is reached");
    assert!(solver.pose().q[6].abs() < 1e-12);
}

fn refused(blocked: Result<Progress, Blocked>) -> Box<biela::kinematics::SingularPoint> {
    match blocked {
        Err(Blocked {
            reason: Reason::Singular(point),
            ..
        }) => point,
        other => panic!("{other:?}"),
    }
}

/// A cam lifts one end of a rod of 0.5 m almost upright over its other end, a slider, which is at
/// x = √(0.25 − R²) = √(0.1 + …) sin² u: at u = 0 the motions to both sides touch.
#[test]
fn motions_that_touch_are_refused() {
    let (mut solver, _) = assembled(&parse(
        "format = 1\nname = 'touch'\n[ground.markers]\nO = [0, 0]\nup = [0, 0, '90*deg']\n\
         [bodies.cam]\nmarkers = { O = [0, 0] }\nestimate = [0, 0, 1]\n\
         [bodies.follower]\nmarkers = { edge = [0, 0, '90*deg'] }\nestimate = [0, 0.4, 0]\n\
         [bodies.slider]\nmarkers = { B = [0, 0] }\nestimate = [0.1, 0, 0]\n\
         [joints]\nO = { type = 'revolute', markers = ['ground.O', 'cam.O'] }\n\
         guide = { type = 'translational', markers = ['ground.up', 'follower.edge'] }\n\
         contact = { type = 'cam', markers = ['cam.O', 'follower.edge'], follower = 'knife', \
         profile = '0.5 - 0.1*sin(theta - pi/2)^4' }\n\
         way = { type = 'translational', markers = ['ground.O', 'slider.B'] }\n\
         rod = { type = 'link', markers = ['follower.edge', 'slider.B'], length = 0.5 }\n\
         [drivers]\nu = { coordinate = 'angle', markers = ['ground.O', 'cam.O'], start = 1 }\n",
    ));
    let x = |u: f64| (0.25 - (0.5 - 0.1 * u.sin().powi(4)).powi(2)).sqrt();
    go(&mut solver, 0.5).expect("it is far from upright");
    assert!((solver.pose().q[6] - x(0.5)).abs() < 1e-12);
    for target in [-0.1, -0.5] {
        let point = refused(go(&mut solver, target));
        assert_eq!(point.kind, SingularKind::TangentBranches);
        assert!(point.drivers[0].abs() < 1e-6, "{point:?}");
        assert!(solver.pose().q[6] > 0.0);
        go(&mut solver, 0.5).expect("the way back is open");
    }
}

/// A cam turned by its knife edge, R = 0.5 + 0.1 sin³: the cam stops where the edge moves on.
#[test]
fn a_cusp_is_refused() {
    let (mut solver, _) = assembled(&parse(
        "format = 1\nname = 'cusp'\n[ground.markers]\nO = [0, 0]\nup = [0, 0, '90*deg']\n\
         [bodies.cam]\nmarkers = { O = [0, 0] }\nestimate = [0, 0, -1]\n\
         [bodies.follower]\nmarkers = { edge = [0, 0, '90*deg'] }\nestimate = [0, 0.55, 0]\n\
         [joints]\nO = { type = 'revolute', markers = ['ground.O', 'cam.O'] }\n\
         guide = { type = 'translational', markers = ['ground.up', 'follower.edge'] }\n\
         contact = { type = 'cam', markers = ['cam.O', 'follower.edge'], follower = 'knife', \
         profile = '0.5 + 0.1*sin(theta - pi/2)^3' }\n\
         [drivers]\nu = { coordinate = 'x', markers = ['ground.up', 'follower.edge'], \
         start = 0.55 }\n",
    ));
    for target in [0.45, 0.499, 0.5] {
        let point = refused(go(&mut solver, target));
        assert_eq!(point.kind, SingularKind::Cusp, "{point:?}");
        assert!((point.drivers[0] - 0.5).abs() < 1e-9, "{point:?}");
        assert!(solver.pose().drivers[0] > 0.5);
        go(&mut solver, 0.55).expect("the way back is open");
    }
    // Its highest point is a dead point.
    let point = refused(go(&mut solver, 0.7));
    assert_eq!(point.kind, SingularKind::DeadPoint);
    assert!((point.drivers[0] - 0.6).abs() < 1e-14);
}

/// x³ = u: a slider comes to u = 0 ever faster. Place and extreme are those of the cusp.
#[test]
fn a_motion_ends_at_its_cusp() {
    let text = "format = 1\nname = 'cusp'\n[ground.markers]\nO = [0, 0]\n[bodies.crank]\n\
         markers = { O = [0, 0] }\nestimate = [0, 0, 0.3]\n[bodies.slider]\n\
         markers = { S = [0, 0] }\nestimate = [0.67, 0, 0]\n[joints]\n\
         O = { type = 'revolute', markers = ['ground.O', 'crank.O'] }\n\
         S = { type = 'translational', markers = ['ground.O', 'slider.S'] }\n\
         c = { type = 'coupling', equation = 'x^3 = u' }\n[measures]\n\
         x = { coordinate = 'x', markers = ['ground.O', 'slider.S'] }\n[drivers]\n\
         u = { coordinate = 'angle', markers = ['ground.O', 'crank.O'], start = 0.3 }\n";
    let (mut solver, mut path) = assembled(&parse(text));
    let settings = RangeSettings {
        turns: 1,
        ..RangeSettings::default()
    };
    let range = solver.range(DriverId(0), &settings);
    let End::Singular(point) = &range.lower else {
        panic!("{:?}", range.lower)
    };
    assert_eq!(point.kind, SingularKind::Cusp);
    let [least, _] = range.measures[0];
    // The cube root of the rounding of u = 0.3 is 4e-6; the position is found in x, to 1e-13.
    assert!(
        least.value.abs() < 1e-12 && least.driver.abs() < 1e-12,
        "{least:?}"
    );

    straight_to(&solver, &mut path, -1.7);
    let blocked = solver.track(&path).expect_err("it ends at u = 0");
    // 0.3 of 2 radians, to the rounding of a place on a path.
    assert!((blocked.place() - 0.15).abs() < 1e-9, "{blocked:?}");
    assert_eq!(refused(Err(blocked)).kind, SingularKind::Cusp);
}

/// A scissor lift drawn out to its full height: each of its cells could fold to either side.
#[test]
fn a_lift_at_its_full_height_loses_a_rank_for_each_cell() {
    for (cells, kind) in [
        (1, SingularKind::DeadPoint),
        (2, SingularKind::HigherRank),
        (4, SingularKind::HigherRank),
    ] {
        let (mut solver, _) = assembled(&parse(&scissor_lift(cells)));
        let full = BAR * cells as f64;
        let point = refused(go(&mut solver, full + 0.1));
        assert_eq!(point.kind, kind, "{cells}: {point:?}");
        assert!((point.drivers[0] - full).abs() < 1e-9);
        go(&mut solver, 0.5 * full).expect("the way back is open");
    }
}

/// Three equal cranks carry a bar, tilted by 0.2 rad: flat at u = 0.2. There the third crank's own
/// rows are crossed with the others; where it points along x, at u = 0, they are singular again,
/// just before the end of the first crossing. Cranks stay parallel, the bar keeps its tilt.
#[test]
fn a_second_crossing_begins_at_the_end_of_the_first() {
    let (mut solver, _) = assembled(&parse(
        r#"
        format = 1
        name = "three_cranks"
        [parameters]
        tilt = 0.19667499062900618
        base = 0.57751
        along = 0.150837
        across = 0.070084
        crank = 0.13165
        [ground.markers]
        O = [0, 0]
        D = ["base*cos(tilt)", "base*sin(tilt)"]
        E = ["along*cos(tilt) - across*sin(tilt)", "along*sin(tilt) + across*cos(tilt)"]
        [bodies.first]
        markers = { a = [0, 0], b = ["crank", 0] }
        estimate = [0, 0, 1.2]
        [bodies.second]
        markers = { a = [0, 0], b = ["crank", 0] }
        estimate = [0.566, 0.113, 1.2]
        [bodies.third]
        markers = { a = [0, 0], b = ["crank", 0] }
        estimate = [0.134, 0.098, 1.2]
        [bodies.coupler]
        markers = { a = [0, 0], b = ["base", 0], c = ["along", "across"] }
        estimate = [0.05, 0.12, 0.2]
        [joints]
        O = { type = "revolute", markers = ["ground.O", "first.a"] }
        D = { type = "revolute", markers = ["ground.D", "second.a"] }
        E = { type = "revolute", markers = ["ground.E", "third.a"] }
        A = { type = "revolute", markers = ["first.b", "coupler.a"] }
        B = { type = "revolute", markers = ["coupler.b", "second.b"] }
        C = { type = "revolute", markers = ["coupler.c", "third.b"] }
        [drivers]
        u = { coordinate = "angle", markers = ["ground.O", "first.a"], start = 1.2145 }
        "#,
    ));
    let step = (1.2145 + 1.253) / 400.0;
    for k in 0..=400 {
        // One of them stops 1.5e-6 rad before the second singular position.
        let u = 1.508e-6 + step * f64::from(197 - k);
        go(&mut solver, u).unwrap_or_else(|blocked| panic!("at {u}: {blocked:?}"));
        let q = &solver.pose().q;
        // Next to a singular position Newton's method leaves eps / 1.5e-6.
        for phi in [q[5], q[8]] {
            assert!((phi - u).abs() < 1e-9, "{phi} at {u}");
        }
        assert!((q[11] - 0.196_674_990_629_006_18).abs() < 1e-9);
    }
}

/// A knife edge on an arm hardly shorter than the radius of its eccentric cam: arm and contour nearly
/// coincide, and thousands of sub-steps lead to the dead point, where the distance of their centres
/// is the difference of arm and radius.
#[test]
fn a_dead_point_is_found_where_curves_nearly_coincide() {
    /// Radius of the cam, and its eccentricity, which is also the distance of the pivots.
    const RADIUS: f64 = 0.33;
    const ECCENTRICITY: f64 = 0.1;
    for shorter in [1e-2, 3e-3] {
        let arm = RADIUS - shorter;
        let start = 1.0_f64;
        // The triangle of the two centres, 2 e sin(u/2) apart, and the edge.
        let apart = 2.0 * ECCENTRICITY * (0.5 * start).sin();
        let along = (arm * arm - RADIUS * RADIUS + apart * apart) / (2.0 * apart);
        let phi = 0.5 * (start + PI) + (along / arm).acos();
        let text = format!(
            "format = 1\nname = \"knife\"\n[ground.markers]\nO = [0, 0]\nQ = [{ECCENTRICITY}, 0]\n\
             [bodies.cam]\nmarkers = {{ O = [0, 0] }}\nestimate = [0, 0, {start}]\n\
             [bodies.arm]\nmarkers = {{ Q = [0, 0], K = [{arm}, 0] }}\n\
             estimate = [{ECCENTRICITY}, 0, {phi}]\n[joints]\n\
             O = {{ type = \"revolute\", markers = [\"ground.O\", \"cam.O\"] }}\n\
             Q = {{ type = \"revolute\", markers = [\"ground.Q\", \"arm.Q\"] }}\n\
             c = {{ type = \"cam\", markers = [\"cam.O\", \"arm.K\"], follower = \"knife\", profile = \
             \"{ECCENTRICITY}*cos(theta) + sqrt({RADIUS}^2 - ({ECCENTRICITY}*sin(theta))^2)\" }}\n\
             [drivers]\n\
             u = {{ coordinate = \"angle\", markers = [\"ground.O\", \"cam.O\"], start = {start} }}\n"
        );
        let (mut solver, _) = assembled(&parse(&text));
        assert!((solver.pose().q[5] - phi).abs() < 1e-9, "the other mode");
        let blocked = go(&mut solver, 0.0).expect_err("it turns back");
        let Reason::Singular(point) = &blocked.reason else {
            panic!("{shorter}: {:?}", blocked.reason)
        };
        assert_eq!(point.kind, SingularKind::DeadPoint);
        let truth = 2.0 * (0.5 * shorter / ECCENTRICITY).asin();
        // Some roundings of the lengths, where a length changes by e for a radian.
        let rounding = 16.0 * f64::EPSILON * RADIUS / ECCENTRICITY;
        let off = (point.drivers[0] - truth).abs();
        assert!(off < rounding, "{shorter}: {off:e}");
    }
}
