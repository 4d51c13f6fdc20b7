//! Contacts end a driven motion where a closed form says so, whatever the step.

use std::sync::Arc;

use crate::common::{assembled, parse, straight_to};
use biela::kinematics::{End, Error, Path, RangeSettings, Reason, Solver};
use biela::mechanism::{DriverId, Mechanism, Source};

/// A place of a contact is known as that of a stop is.
const PLACE: f64 = 1e-12;

/// A bar of 1.2 m and 2 cm that turns, and a post of 4 cm at a distance of 1 m.
fn bar(more: &str) -> Arc<Mechanism> {
    parse(&format!(
        "format = 1\nname = 'bar'\n[ground.markers]\nO = [0, 0]\nP = [0.6, 0.8]\n\
         [ground.shapes]\npost = {{ disc = 'P', radius = 0.04 }}\n\
         [bodies.bar]\nmarkers = {{ O = [0, 0], T = [1.2, 0] }}\n\
         shapes.arm = {{ bar = ['O', 'T'], radius = 0.02 }}\n\
         [joints]\npin = {{ type = 'revolute', markers = ['ground.O', 'bar.O'] }}\n\
         [drivers]\nturn = {{ coordinate = 'angle', markers = ['ground.O', 'bar.O'], start = 0 }}\n\
         [contacts]\nhit = {{ shapes = ['bar.arm', 'ground.post'] }}\n{more}"
    ))
}

/// Angle at which the bar touches: its middle line is 6 cm from the post.
fn touching() -> f64 {
    0.8_f64.atan2(0.6) - 0.06_f64.asin()
}

/// Moves the only driver until the motion ends, and returns the driver's value and the message.
fn ending(mechanism: &Arc<Mechanism>, to: f64) -> (f64, String, u64) {
    let (mut solver, mut path) = assembled(mechanism);
    straight_to(&solver, &mut path, to);
    let blocked = solver.track(&path).expect_err("something is in the way");
    let Reason::Stop(limit) = &blocked.reason else {
        panic!("{:?}", blocked.reason);
    };
    let substeps = u64::from(blocked.progress.substeps);
    (solver.pose().drivers[0], limit.to_string(), substeps)
}

#[test]
fn a_bar_meets_a_post_in_one_step_of_any_size() {
    let mechanism = bar("");
    assert!((touching() - 0.867_259_160).abs() < 5e-10);
    assert!((touching().to_degrees() - 49.690_289_586_6).abs() < 5e-11);
    for to in [0.8673, 0.93, 1.1, 3.0, 6.2, 40.0] {
        let (at, told, substeps) = ending(&mechanism, to);
        assert!((at - touching()).abs() < PLACE, "{to}: {at}");
        assert_eq!(
            told,
            "contact `hit` reached: `bar.arm` touches `ground.post`"
        );
        assert!(substeps < 80, "{to}: {substeps}");
    }
    // From the other side, and away from it.
    let (at, ..) = ending(&mechanism, -40.0);
    let other = 2.0 * 0.8_f64.atan2(0.6) - touching() - std::f64::consts::TAU;
    assert!((at - other).abs() < PLACE, "{at}");
    let (mut solver, mut path) = assembled(&mechanism);
    straight_to(&solver, &mut path, 3.0);
    solver.track(&path).expect_err("the post is in the way");
    straight_to(&solver, &mut path, -1.0);
    solver.track(&path).expect("it leads away");
}

#[test]
fn range_names_the_contacts_that_limit_a_driver() {
    let more =
        "[measures]\nair = { coordinate = 'clearance', shapes = ['bar.arm', 'ground.post'] }";
    let mechanism = bar(more);
    let (mut solver, _) = assembled(&mechanism);
    let range = solver.range(DriverId(0), &RangeSettings::default());
    let End::Stop { value, limit } = &range.upper else {
        panic!("{:?}", range.upper);
    };
    assert!((value - touching()).abs() < PLACE);
    assert_eq!(limit.stop, "hit");
    let [least, most] = range.measures[0];
    assert!(least.value.abs() < PLACE, "{least:?}");
    // The pivot is the nearest place where the bar points away from the post.
    assert!((most.value - (1.0 - 0.06)).abs() < PLACE, "{most:?}");
}

#[test]
fn a_bar_passes_what_it_does_not_touch() {
    // A tip of 2 cm passes a post at 1.4 m by a micrometre, or touches it by one, in one step.
    let beside = |post: f64| {
        let text = format!(
            "format = 1\nname = 'tip'\n[ground.markers]\nO = [0, 0]\nP = [0, 1.4]\n\
             [ground.shapes]\npost = {{ disc = 'P', radius = {post} }}\n\
             [bodies.bar]\nmarkers = {{ O = [0, 0], T = [1.2, 0] }}\n\
             shapes.arm = {{ bar = ['O', 'T'], radius = 0.02 }}\n\
             [joints]\npin = {{ type = 'revolute', markers = ['ground.O', 'bar.O'] }}\n\
             [drivers]\nturn = {{ coordinate = 'angle', markers = ['ground.O', 'bar.O'], start = 0 }}\n\
             [contacts]\nhit = {{ shapes = ['ground.post', 'bar.arm'] }}\n"
        );
        parse(&text)
    };
    let (mut solver, mut path) = assembled(&beside(0.18 - 1e-6));
    straight_to(&solver, &mut path, 3.0);
    solver.track(&path).expect("it passes");
    let post = 0.18 + 1e-6;
    let (at, ..) = ending(&beside(post), 3.0);
    let cos = (1.4_f64.powi(2) + 1.2_f64.powi(2) - (post + 0.02).powi(2)) / (2.0 * 1.4 * 1.2);
    let touches = std::f64::consts::FRAC_PI_2 - cos.acos();
    // The place of a grazing contact is known to the root of what a clearance is.
    assert!((at - touches).abs() < 1e-8, "{at} {touches}");
}

#[test]
fn a_start_at_which_shapes_overlap_is_refused() {
    for (start, told) in [
        (
            "0.88",
            "the start pose is beyond contact `hit`: `bar.arm` and `ground.post` overlap by 12.7",
        ),
        // The middle line of the bar leads through the post, and the post lies in the bar.
        (
            "0.93",
            "the start pose is beyond contact `hit`: `bar.arm` and `ground.post` overlap",
        ),
    ] {
        let text = format!(
            "format = 1\nname = 'bar'\n[ground.markers]\nO = [0, 0]\nP = [0.6, 0.8]\n\
             [ground.shapes]\npost = {{ disc = 'P', radius = 0.04 }}\n\
             [bodies.bar]\nmarkers = {{ O = [0, 0], T = [1.2, 0] }}\n\
             shapes.arm = {{ bar = ['O', 'T'], radius = 0.02 }}\n\
             [joints]\npin = {{ type = 'revolute', markers = ['ground.O', 'bar.O'] }}\n\
             [drivers]\nturn = {{ coordinate = 'angle', markers = ['ground.O', 'bar.O'], start = {start} }}\n\
             [contacts]\nhit = {{ shapes = ['bar.arm', 'ground.post'] }}\n"
        );
        let mechanism = parse(&text);
        let error = Solver::assembled(Arc::clone(&mechanism), &Path::new(&mechanism));
        let error = error.expect_err("they overlap");
        assert!(matches!(error, Error::BeyondStop { .. }), "{error:?}");
        assert!(error.to_string().starts_with(told), "{error}");
    }
}

/// A slide whose disc runs in a pocket, and a post that grows.
fn pocket(outline: &str) -> Arc<Mechanism> {
    parse(&format!(
        "format = 1\nname = 'pocket'\n\
         [parameters]\ngrown = {{ value = 0.05, unit = 'm', tunable = true }}\n\
         [ground.markers]\nO = [0, 0]\nA = [-0.3, 0.2]\nB = [-0.3, -0.2]\nC = [0.7, -0.2]\nD = [0.7, 0.2]\n\
         E = [0.6, 0.2]\nF = [0.6, -0.1]\nG = [-0.2, -0.1]\nH = [-0.2, 0.2]\nQ = [0.2, 0.4]\n\
         [ground.shapes]\ntray = {{ outline = [{outline}] }}\npost = {{ disc = 'Q', radius = 'grown' }}\n\
         [bodies.slide]\nmarkers = {{ O = [0, 0] }}\nshapes.pin = {{ disc = 'O', radius = 0.06 }}\n\
         [joints]\nway = {{ type = 'translational', markers = ['ground.O', 'slide.O'] }}\n\
         [drivers]\nfeed = {{ coordinate = 'x', markers = ['ground.O', 'slide.O'], start = 0 }}\n\
         [contacts]\nside = {{ shapes = ['ground.tray', 'slide.pin'] }}\n\
         top = {{ shapes = ['ground.post', 'slide.pin'] }}\n"
    ))
}

const TRAY: &str = "'A', 'B', 'C', 'D', 'E', 'F', 'G', 'H'";

#[test]
fn a_disc_ends_at_both_sides_of_a_pocket() {
    let mut corners: Vec<&str> = TRAY.split(", ").collect();
    corners.reverse();
    for outline in [TRAY.to_owned(), corners.join(", ")] {
        let mechanism = pocket(&outline);
        for (to, end) in [(5.0, 0.54), (-5.0, -0.14), (0.6, 0.54)] {
            let (at, told, _) = ending(&mechanism, to);
            assert!((at - end).abs() < PLACE, "{at}");
            assert_eq!(
                told,
                "contact `side` reached: `ground.tray` touches `slide.pin`"
            );
        }
    }
}

#[test]
fn a_shape_that_grows_ends_at_a_contact() {
    let mechanism = pocket(TRAY);
    let (mut solver, mut path) = assembled(&mechanism);
    // The disc is at rest, the post grows to 1 m.
    path.to[0] = 1.0;
    let blocked = solver.track(&path).expect_err("it grows into the disc");
    assert!(
        matches!(blocked.reason, Reason::Stop(_)),
        "{:?}",
        blocked.reason
    );
    let grown = solver.pose().parameters[0];
    let right = 0.2_f64.hypot(0.4) - 0.06;
    assert!((grown - right).abs() < PLACE, "{grown} {right}");
}

/// The same contact seen from another frame, by another name, mirrored, or with ground and body
/// exchanged, ends the motion at the same angle.
#[test]
fn a_contact_does_not_depend_on_its_description() {
    let build = |[x, y, phi]: [f64; 3], side: f64, swapped: bool, more: bool| {
        let at = |[px, py]: [f64; 2]| {
            let (sin, cos) = phi.sin_cos();
            let py = side * py;
            format!("[{}, {}]", x + cos * px - sin * py, y + sin * px + cos * py)
        };
        let still = format!(
            "markers = {{ O = {}, A = {}, B = {}, C = {}, D = {} }}\n",
            at([0.0, 0.0]),
            at([0.5, 0.7]),
            at([0.9, 0.6]),
            at([0.8, 0.9]),
            at([0.7, 0.65]),
        );
        let list = if more {
            "'A', 'D', 'B', 'C'"
        } else {
            "'C', 'B', 'A'"
        };
        let still = format!("{still}shapes.wedge = {{ outline = [{list}], fillet = 0.01 }}\n");
        let arm = "markers = { O = [0, 0], T = [1.2, 0] }\n\
                   shapes.arm = { bar = ['O', 'T'], radius = 0.02 }\n";
        let [ground, body] = if swapped {
            [arm, &still]
        } else {
            [&*still, arm]
        };
        let shapes = if swapped {
            "'body.wedge', 'ground.arm'"
        } else {
            "'body.arm', 'ground.wedge'"
        };
        parse(&format!(
            "format = 1\nname = 'wedge'\n[ground]\n{ground}[bodies.body]\n{body}\
             [joints]\npin = {{ type = 'revolute', markers = ['ground.O', 'body.O'] }}\n\
             [drivers]\nturn = {{ coordinate = 'angle', markers = ['ground.O', 'body.O'], start = {} }}\n\
             [contacts]\nhit = {{ shapes = [{shapes}] }}\n",
            if swapped { -phi } else { phi },
        ))
    };
    let plain = build([0.0; 3], 1.0, false, false);
    let (right, ..) = ending(&plain, 3.0);
    for (frame, side, swapped, more) in [
        ([0.0; 3], 1.0, false, true),
        ([0.3, -0.2, 0.9], 1.0, false, false),
        ([0.0; 3], -1.0, false, true),
        ([0.0; 3], 1.0, true, false),
        ([3.0, 1.0, -0.4], 1.0, true, true),
    ] {
        let mechanism = build(frame, side, swapped, more);
        let way = if swapped { -side } else { side };
        let start = if swapped { -frame[2] } else { frame[2] };
        let (at, ..) = ending(&mechanism, start + 3.0 * way);
        assert!(((at - start) * way - right).abs() < 1e-11, "{at} {right}");
    }
}

#[test]
fn contacts_that_cannot_be_are_refused() {
    let told = |contacts: &str, moved: &str| {
        let text = format!(
            "format = 1\nname = 'bar'\n[ground.markers]\nO = [0, 0]\nP = [2, 2]\nQ = [3, 2]\nR = [3, 3]\n\
             [ground.shapes]\npost = {{ disc = 'P', radius = 0.04 }}\nsharp = {{ outline = ['P', 'Q', 'R'] }}\n\
             [bodies.bar]\nmass = 1\ninertia = 1\nmarkers = {{ O = [0, 0], S = [0.1, 0.1], T = [1.2, 0] }}\n\
             shapes.arm = {{ bar = ['O', 'T'], radius = 0.02 }}\nshapes.tip = {{ outline = ['O', 'T', 'S'] }}\n\
             [joints]\npin = {{ type = 'revolute', markers = ['ground.O', 'bar.O'] }}\n\
             [{moved}]\nturn = {{ coordinate = 'angle', markers = ['ground.O', 'bar.O'], start = 0 }}\n\
             [contacts]\n{contacts}\n"
        );
        let source = Source::new("bar.toml", &*text);
        let problems = Mechanism::parse(&source).expect_err("it is wrong");
        problems[0].one_line(&source)
    };
    for (contacts, moved, message) in [
        (
            "hit = { shapes = ['bar.tip', 'ground.post'], stiffness = 1e5, restitution = 0.2 }",
            "freedoms",
            "contact `hit` has both `stiffness` and `restitution`",
        ),
        (
            "hit = { shapes = ['bar.arm', 'ground.sharp'], stiffness = 1e5 }",
            "drivers",
            "the contact `hit` of `bar.arm` and `ground.sharp` cannot have a `stiffness`",
        ),
        (
            "hit = { shapes = ['bar.tip', 'ground.sharp'] }",
            "drivers",
            "no shape of contact `hit` is round",
        ),
        (
            "hit = { shapes = ['bar.arm', 'bar.tip'] }",
            "drivers",
            "both shapes of contact `hit` are on `bar`",
        ),
        (
            "hit = { shapes = ['bar.arm', 'ground.pots'] }",
            "drivers",
            "did you mean `post`?",
        ),
        (
            "hit = { shapes = ['bar.arm', 'post'] }",
            "drivers",
            "no shape `post`",
        ),
        (
            "hit = { shapes = ['bar.arm', 'ground.post'], friction = 0.5 }",
            "drivers",
            "there is no friction between shapes",
        ),
        (
            "hit = { shapes = ['bar.arm', 'ground.post'] }\nagain = { shapes = ['ground.post', 'bar.arm'] }",
            "drivers",
            "have a contact already",
        ),
    ] {
        let told = told(contacts, moved);
        assert!(told.contains(message), "{told}");
    }
}
