//! Ropes: lengths and radii that move, and pulleys that ropes leave.

use biela::kinematics::{DriverPath, Error, GeometryWarningKind, Reason};

use crate::common::{assembled, parse, shipped, straight_to};

/// Returns the height of the counterweight of `mechanisms/sash_window.toml`, with the sash at a
/// height, for a length of the cord and a radius of both pulleys.
fn counterweight(lift: f64, cord: f64, radius: f64) -> f64 {
    let (first, second) = ([0.07_f64, 1.6], 0.3);
    let (x, y) = (first[0], first[1] - lift);
    let distance = x.hypot(y);
    let tangent = (distance * distance - radius * radius).sqrt();
    let direction = y.atan2(x) + (radius / distance).asin();
    let arcs = radius * (direction + std::f64::consts::FRAC_PI_2);
    first[1] - (cord - tangent - arcs - (second - first[0]))
}

#[test]
fn cords_and_pulleys_that_change_at_once_end_at_the_closed_form() {
    let mechanism = shipped("sash_window");
    let (mut solver, mut path) = assembled(&mechanism);
    let [cord, radius] = ["cord_length", "pulley_radius"].map(|name| {
        let mut parameters = mechanism.parameters.iter();
        parameters.position(|p| p.name == name).expect("it has it")
    });
    let weight = 3 * mechanism.body_id("weight").expect("it has it").index();
    for (lift, length, size) in [(1.1, 1.9, 0.02), (0.45, 2.3, 0.06), (1.2, 2.0, 0.01)] {
        path.from.copy_from_slice(&solver.pose().parameters);
        path.to.copy_from_slice(&solver.pose().parameters);
        (path.to[cord], path.to[radius]) = (length, size);
        straight_to(&solver, &mut path, lift);
        solver.track(&path).expect("the way is free");
        let [x, y] = [0, 1].map(|k| solver.pose().q[weight + k]);
        // Some ulp of sums of lengths of up to 2 m.
        assert!((x - 0.3 - size).abs() < 1e-14);
        let expected = counterweight(lift, length, size);
        assert!((y - expected).abs() < 4e-15, "{y} is not {expected}");
    }
}

/// A rope that leaves its pulley where its far end is low.
pub(super) const LOWERED: &str = r#"
    format = 1
    name = "lowered"
    [ground.markers]
    track = [0, 0]
    F = [1, 0]
    guide = [2, 0, "90*deg"]
    [bodies]
    near = { markers = { P = [0, 0] } }
    far = { markers = { Q = [0, 0, "90*deg"] }, estimate = [2, 0.5, 0] }
    [joints]
    track = { type = "translational", markers = ["ground.track", "near.P"] }
    guide = { type = "translational", markers = ["ground.guide", "far.Q"] }
    rope = { type = "rope", markers = ["near.P", { marker = "ground.F", radius = 0.1, side = "left" }, "far.Q"], length = 2.1 }
    [drivers]
    height = { coordinate = "x", markers = ["ground.guide", "far.Q"], start = 0.5 }
"#;

/// A rope from the height of the pulley's centre passes below it until the far end is so low that
/// the straight line from end to end touches the circle.
#[test]
fn a_rope_that_leaves_its_pulley_is_told_once_per_excursion() {
    let mechanism = parse(LOWERED);
    let (mut solver, mut path) = assembled(&mechanism);
    assert!(solver.geometry_warnings().is_empty());
    let mut off = vec![false; mechanism.pulleys()];
    let mut told = |height: f64| {
        straight_to(&solver, &mut path, height);
        solver.track(&path).expect("the way is free");
        let q = &solver.pose().q;
        let along = (q[3] - q[0]).hypot(q[4]);
        // The distance of the pulley's centre from that line, positive above it.
        let above = -q[4] * (1.0 - q[0]) / along;
        let left: Vec<_> = solver
            .off_pulleys(&mut off)
            .map(|l| l.to_string())
            .collect();
        (above > 0.1, left)
    };
    for (height, tells) in [
        (0.2, 0),
        (-0.15, 0),
        (-0.4, 1),
        (-0.6, 0),
        (0.1, 0),
        (-0.5, 1),
    ] {
        let (is_off, left) = told(height);
        assert_eq!(is_off, height < -0.3, "{height}");
        assert_eq!(left.len(), tells, "{height}: {left:?}");
        let named = left
            .iter()
            .all(|l| l.contains("rope `rope` would leave its pulley at `ground.F`"));
        assert!(named, "{left:?}");
    }
    let warnings = solver.geometry_warnings();
    let [warning] = &warnings[..] else {
        panic!("{warnings:?}")
    };
    assert!(
        warning
            .to_string()
            .contains("does not touch its pulley at `ground.F`")
    );
}

/// An arc is counted up to 315°: beyond, the motion does not go on with another length.
#[test]
fn a_rope_that_winds_up_stops_where_its_arc_ends() {
    let mechanism = parse(
        r#"
        format = 1
        name = "capstan"
        ground.markers = { F = [0, 0], E = [-2, 0.1] }
        [bodies]
        arm = { markers = { O = [0, 0], A = [1, 0, "90*deg"] } }
        end = { markers = { Q = [0, 0, "90*deg"] }, estimate = [1, 0, 0] }
        [joints]
        O = { type = "revolute", markers = ["ground.F", "arm.O"] }
        guide = { type = "translational", markers = ["arm.A", "end.Q"] }
        rope = { type = "rope", markers = ["ground.E", { marker = "ground.F", radius = 0.1, side = "left" }, "end.Q"], length = 3.6 }
        [drivers]
        turn = { coordinate = "angle", markers = ["ground.F", "arm.O"], start = 0 }
        "#,
    );
    let (mut solver, mut path) = assembled(&mechanism);
    path.driver_paths[0] = DriverPath::held(7.0, 0.0);
    let blocked = solver.track(&path).expect_err("the arc ends at 315 deg");
    let Reason::Value(Error::RopeArc {
        rope,
        pulley,
        angle,
    }) = &blocked.reason
    else {
        panic!("{blocked:?}")
    };
    assert_eq!([rope, pulley], ["rope", "ground.F"]);
    assert!((angle.to_degrees() - 315.0).abs() < 1e-3, "{angle}");
    // Unwound, the arc ends at -45 deg.
    let now = solver.pose().drivers[0];
    path.driver_paths[0] = DriverPath::held(now - 7.0, now);
    let blocked = solver.track(&path).expect_err("the arc ends at -45 deg");
    let is_named =
        matches!(&blocked.reason, Reason::Value(Error::RopeArc { angle, .. }) if *angle < 0.0);
    assert!(is_named, "{blocked:?}");
}

/// Two points at one place leave the rope no direction, whether they rest or come there by chance.
#[test]
fn a_rope_over_points_at_one_place_is_named() {
    for (markers, [from, to]) in [
        (
            "'ground.A', 'ground.C', 'block.P'",
            ["ground.A", "ground.C"],
        ),
        (
            "'ground.A', { marker = 'ground.B', radius = 0.2, side = 'left' }, \
             { marker = 'ground.D', radius = 0.05, side = 'left' }, 'block.P'",
            ["ground.B", "ground.D"],
        ),
    ] {
        let mechanism = parse(&format!(
            "format = 1\nname = 'knot'\n[ground.markers]\nA = [0, 0]\nB = [1, 0]\nC = [0, 0]\n\
             D = [1, 0.1]\nV = [0.5, 0, '90*deg']\n[bodies.block]\nmarkers = {{ P = [0, 0] }}\n\
             estimate = [0.5, -0.5, '90*deg']\n[joints]\n\
             way = {{ type = 'translational', markers = ['ground.V', 'block.P'] }}\n\
             knot = {{ type = 'rope', markers = [{markers}], length = 2.5 }}\n"
        ));
        let (solver, _) = assembled(&mechanism);
        let warnings = solver.geometry_warnings();
        let expected = GeometryWarningKind::NoTangent {
            markers: [from.to_owned(), to.to_owned()],
        };
        let is_named = warnings.iter().any(|warning| warning.kind == expected);
        assert!(is_named, "{markers}: {warnings:?}");
    }
}
