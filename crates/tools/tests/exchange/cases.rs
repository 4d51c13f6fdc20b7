//! Imported motions in time, with their right values.

use std::sync::Arc;

use biela::dynamics::{FreeMotion, Given};
use biela::kinematics::{DriverPath, Solution, Solver};
use biela::mechanism::{DriverId, Jet, Mechanism, Signal};
use biela_tools::exchange::Format;

use crate::common::{assembled, folder, parse};
use crate::import;
use crate::motion::{Point, expected, place};

/// Returns the mechanism of a sample.
fn sample(path: &str) -> Arc<Mechanism> {
    let path = folder("crates/tools/tests/exchange/samples").join(path);
    let draft = import(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    parse(&draft.write("sample"))
}

/// Returns a mechanism of a text.
fn read(format: Format, text: &str) -> Arc<Mechanism> {
    let draft = format.read(text.as_bytes(), "it", None);
    parse(&draft.unwrap_or_else(|error| panic!("{error}")).write("it"))
}

/// Calls a function at each of some times of a prescribed motion.
fn follow(mechanism: &Arc<Mechanism>, times: &[f64], mut at: impl FnMut(&Solver, f64)) {
    let (mut solver, mut path) = assembled(mechanism);
    for &time in times {
        path.start = solver.pose().time;
        path.duration = time - path.start;
        if path.duration > 0.0 {
            let tracked = solver.track(&path);
            tracked.unwrap_or_else(|error| panic!("{} at {time} s: {error:?}", mechanism.name));
        }
        at(&solver, time);
    }
}

fn body_angle(solver: &Solver, name: &str) -> f64 {
    let bodies = &solver.mechanism().bodies;
    let body = bodies.iter().position(|body| body.name == name);
    solver.pose().q[3 * body.expect("it is there") + 2]
}

fn assert_near(found: Point, right: Point, tolerance: f64, what: &str) {
    let error = (found[0] - right[0]).hypot(found[1] - right[1]);
    assert!(error < tolerance, "{what}: {error} mm off {right:?}");
}

/// Six decimals of a 96th of an inch, moved by at most the ratio of the arms \[mm\].
const LINKAGE: f64 = 20e-6;
/// Half of ten micrometres, likewise \[mm\].
const PMKS: f64 = 0.1;

/// The four-bar with its crank at the angles that speed, limit and offset give.
#[test]
fn four_bars_turn_at_their_own_speeds() {
    type Crank = fn(f64) -> f64;
    let cases: [(&str, Crank, f64); 4] = [
        // Against the clock, a link with two anchors stands still.
        ("linkage2/ground_bar.linkage2", |t| 60.0 + 90.0 * t, LINKAGE),
        // Clockwise over 60°, 20° inside it at the start.
        (
            "linkage2/limitangle.linkage2",
            |t| {
                let way = (20.0 + 90.0 * t) % 120.0;
                60.0 + 20.0 - way.min(120.0 - way)
            },
            LINKAGE,
        ),
        ("pmks/own_speed.pmks.txt", |t| 60.0 + 48.0 * t, PMKS),
        ("pmks/link_flag.pmks.txt", |t| 60.0 + 120.0 * t, PMKS),
    ];
    for (path, crank, tolerance) in cases {
        follow(&sample(path), &[0.0, 0.25, 0.5, 1.0, 1.5], |solver, t| {
            for (name, right) in &expected("four_bar", crank(t).to_radians())[..2] {
                let found = place(solver, solver.mechanism(), name);
                assert_near(
                    found,
                    *right,
                    tolerance,
                    &format!("{path}: {name} at {t} s"),
                );
            }
        });
    }
    let angles = [60.0, 37.5, 25.0, 70.0, 45.0].into_iter();
    let mut angles = angles.map(f64::to_radians);
    let swept = sample("linkage2/limitangle.linkage2");
    follow(&swept, &[0.0, 0.25, 0.5, 1.0, 1.5], |solver, t| {
        let right = angles.next().expect("five");
        let crank = body_angle(solver, "crank");
        // Angles are written with six decimals of a degree.
        assert!((crank - right).abs() < 1e-8, "{crank} at {t} s");
    });
}

/// A slider on the arc to the right of the way between its limits: its centre is at (80, −90), its
/// radius 150 units of a 96th of an inch; a rod of √(180² + 20²) units joins it to the crank.
#[test]
fn a_negative_radius_is_an_arc_on_the_other_side() {
    let unit = 25.4 / 96.0;
    let rod = f64::hypot(180.0, 20.0);
    follow(
        &sample("linkage2/arc_concave.linkage2"),
        &[0.0, 1.0],
        |solver, t| {
            let crank = (180.0 + 60.0 * t).to_radians();
            let b = [300.0 + 40.0 * crank.cos(), 40.0 + 40.0 * crank.sin()];
            let c = crate::motion::dyad(b, rod, [80.0, -90.0], 150.0);
            // Above the chord from centre to crank the dyad is to the right of the way from the crank.
            let way = [80.0 - b[0], -90.0 - b[1]];
            let side = way[0] * (c[1] - b[1]) - way[1] * (c[0] - b[0]);
            let length = way[0].hypot(way[1]);
            let off = 2.0 * side / (length * length);
            let mirrored = [c[0] + off * way[1], c[1] - off * way[0]];
            let right = mirrored.map(|x| unit * x);
            assert_near(place(solver, solver.mechanism(), "C"), right, LINKAGE, "C");
            let published = [[21.166_667, 15.875], [28.203_895, 15.246_111]];
            assert_near(right, published[usize::from(t > 0.0)], 2e-6, "the case");
        },
    );
}

/// A lever through a pin on ground: its angle is that of the way from the crank to the pin.
#[test]
fn an_anchored_slider_is_no_body() {
    follow(
        &sample("linkage2/anchored_slider.linkage2"),
        &[0.0, 1.0, 2.0],
        |solver, t| {
            let crank = (90.0 + 72.0 * t).to_radians();
            let b = [40.0 * crank.cos(), 40.0 * crank.sin()];
            let right = (66.666_667 - b[1]).atan2(200.0 - b[0]);
            assert!((body_angle(solver, "lever") - right).abs() < 1e-8, "{t}");
        },
    );
}

/// An actuator from 364 units goes out by 72 and back, five times a minute, the lever with it.
#[test]
fn actuators_go_out_and_back_at_a_constant_speed() {
    let text = "<linkage2><program units='Millimeters'/>\
        <connector id='0' x='0' y='0' anchor='true'/>\
        <connector id='1' x='0' y='300'/>\
        <connector id='2' x='400' y='0' anchor='true'/>\
        <Link id='0' name='arm'><connector id='0'/><connector id='1'/></Link>\
        <Link id='1' actuator='true' throw='60' cpm='CPM'>\
        <connector id='1'/><connector id='2'/></Link></linkage2>";
    for (cpm, side) in [("6", 1.0), ("-6", -1.0)] {
        let mechanism = read(Format::Linkage, &text.replace("CPM", cpm));
        follow(
            &mechanism,
            &[0.0, 2.0, 5.0, 7.5, 10.0, 11.0],
            |solver, t| {
                // Ten seconds out and back.
                let phase = (t / 5.0) % 2.0;
                let length = 500.0 + side * 60.0 * phase.min(2.0 - phase);
                // The arm's angle by the law of cosines, to the left of the way to the foot.
                let cosine = (300.0_f64.powi(2) + 400.0_f64.powi(2) - length * length) / 240_000.0;
                let angle = body_angle(solver, "arm");
                assert!(
                    // The drawn places, over the arm's length.
                    (angle - cosine.acos()).abs() < LINKAGE / 79.375,
                    "{cpm}: {angle} at {t} s"
                );
            },
        );
    }
}

/// Returns a link with its check character.
fn link(query: &str) -> String {
    let digits = b"0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz";
    let last = char::from(digits[query.len() % 62]);
    format!("https://app.pmksplus.com/?{query}{last}")
}

/// A crank of 1 cm moves a block along the slot between the ends of a lever about (3, 0): the lever
/// points at the crank's end. One block is a link of its own, one slider is the crank's pin itself.
#[test]
fn slots_turn_with_their_links() {
    let (a, b) = ("6A,A,0,0,0.", "0B,B,Fe,0,0.");
    let (c, d) = ("4C,C,ku,0,0.", "0D,D,1VK,0,0.");
    let links = ".YRAB,AB,Fe,Fe,0,0,,A,B,,.YRCD,CD,Fe,Fe,0,0,,C,D,,.";
    let with_block = format!("{a}{b}{c}{d}1P,P,Fe,0,0,CD,C,D.{links}YPBP,BP,Fe,0,0,0,,B,P,,.");
    let own = format!("{a}1B,B,Fe,0,0,CD,C,D.{c}{d}{links}");
    for body in [with_block, own] {
        let mechanism = read(Format::Pmks, &link(&format!("0O.Ti.K,0.101.{body}..N")));
        follow(&mechanism, &[0.0, 0.2, 0.5, 0.9, 1.4], |solver, t| {
            let crank = (120.0 * t).to_radians();
            let to = [crank.cos() - 3.0, crank.sin()];
            // The lever is drawn along +x, and its slot passes both ends.
            let right = (-to[1]).atan2(-to[0]);
            let found = body_angle(solver, "CD");
            assert!(
                (found - right).sin().abs() < 1e-9,
                "{found}, not {right}, at {t} s"
            );
        });
    }
}

/// A cylinder of barrel A–B and rod C–D with its pin welded to its block: barrel and rod stay on one
/// line, so that the angle of both is that of the way between their mounts.
#[test]
fn rods_do_not_turn_in_their_barrels() {
    // A (0, 0) fixed, B (4, 0), C (3, 0) in the barrel, D (6, 0) on a crank about E (6, −1).
    let joints = "4A,A,0,0,0.0B,B,-W,0,0.8C,C,ku,0,0.0D,D,1Tm,0,0.\
        6E,E,1Tm,0Fe,0.1P,P,ku,0,0,AB,A,B.";
    let links = ".YRAB,AB,Fe,Fe,0,0,,A,B,,.YRCD,CD,Fe,Fe,0,0,,C,D,,.\
        YRED,ED,Fe,Fe,0,0,,E,D,,.YPCP,CP,Fe,0,0,0,,C,P,,.";
    let query = format!("0O.Ti.K,0.101.{joints}{links}..N");
    let mechanism = read(Format::Pmks, &link(&query));
    follow(&mechanism, &[0.0, 0.2, 0.5, 0.9, 1.4], |solver, t| {
        let crank = (90.0 + 120.0 * t).to_radians();
        let d = [6.0 + crank.cos(), -1.0 + crank.sin()];
        let right = d[1].atan2(d[0]);
        for body in ["AB", "CD"] {
            let found = body_angle(solver, body);
            assert!(
                (found - right).sin().abs() < 1e-9,
                "{body}: {found} at {t} s"
            );
        }
    });
}

struct Free;

impl Given for Free {
    fn driver(&self, _: DriverId, _: f64) -> Jet {
        unreachable!("nothing is driven")
    }

    fn loads(&self, _: f64, _: &mut [f64]) {}
}

/// Returns value and velocity of the first freedom at a time.
fn moved(mechanism: &Arc<Mechanism>, time: f64) -> [f64; 2] {
    let (mut solver, _) = assembled(mechanism);
    let free = FreeMotion::new(&solver, 1e-10).expect("it can move");
    let mut free = free.expect("it has freedoms");
    free.start(&mut solver, &Free).expect("it starts");
    let mut solution = Solution::new(&solver);
    let advanced = free.advance(&mut solver, &mut solution, &Free, time);
    advanced.expect("it moves");
    solution.driver_rates.copy_from_slice(free.drivers());
    let solved = solution.solve_rates(&mut solver);
    solved.expect("the pose is regular");
    let signal = Signal::Motion(free.freedoms()[0]);
    let jet = solver.signal(signal, &solution.rates, &solution.driver_rates);
    [jet.value, jet.first()]
}

/// Integrates φ″ = f(φ, φ′) by Runge and Kutta's method in 20,000 steps.
fn integrated(start: [f64; 2], time: f64, f: impl Fn(f64, f64) -> f64) -> [f64; 2] {
    let h = time / 20_000.0;
    let mut y = start;
    for _ in 0..20_000 {
        let slope = |y: [f64; 2]| [y[1], f(y[0], y[1])];
        let moved = |by: [f64; 2], h: f64| [y[0] + h * by[0], y[1] + h * by[1]];
        let a = slope(y);
        let b = slope(moved(a, h / 2.0));
        let c = slope(moved(b, h / 2.0));
        let d = slope(moved(c, h));
        y = [0, 1].map(|k| y[k] + h / 6.0 * (a[k] + 2.0 * b[k] + 2.0 * c[k] + d[k]));
    }
    y
}

/// A rod of 2 kg about its end, thrown with 3 rad/s from −0.5 rad.
#[test]
fn a_pendulum_is_thrown_with_its_start_velocity() {
    let mechanism = sample("asmt/thrown_pendulum.asmt");
    let right = integrated([-0.5, 3.0], 0.7, |phi, _| -9.81 / 0.67 * phi.cos());
    let found = moved(&mechanism, 0.7);
    for (found, right) in found.into_iter().zip(right) {
        // The tolerance of the integration with the growth of errors over a swing; angles are
        // written with nine decimals of a degree.
        assert!((found - right).abs() < 1e-8, "{found}, not {right}");
    }
}

/// A spring of 40 N/m and 0.25 m with a damper, from the ground at (0.5, −1) to the tip of the rod.
#[test]
fn springs_pull_along_the_line_of_their_markers() {
    let text = std::fs::read_to_string(folder(
        "crates/tools/tests/exchange/samples/asmt/thrown_pendulum.asmt",
    ));
    let text = text.expect("it is part of the project");
    let spring = "\tForceTorques\n\t\tInLineForceTorque\n\t\t\tName\n\t\t\t\tspring\n\t\t\tMarkerI\n\
        \t\t\t\t/Own/S\n\t\t\tMarkerJ\n\t\t\t\t/Own/rod/Tip\n\t\t\ttension\n\
        \t\t\t\t(0.0d + 40.0d*(rIJ(self) + (-0.25d)) + 1.5d*vrIJ(self))\n\
        \t\t\ttwist\n\t\t\t\t0\n";
    let start = text
        .find("\t\t\t\tMarker\n\t\t\t\t\tName\n\t\t\t\t\t\tO\n")
        .expect("it has O");
    let end = start + text[start..].find("\tRefCurves").expect("it ends");
    let marker = text[start..end].replace("\t\tO\n", "\t\tS\n").replacen(
        "0.0\t0.0\t0.0",
        "0.5\t-1.0\t0.0",
        1,
    );
    let text = format!("{}{marker}{}", &text[..end], &text[end..]);
    let text = text.replace("\tForceTorques\n", spring);
    let mechanism = read(Format::Asmt, &text);
    let right = integrated([-0.5, 3.0], 0.7, |phi, rate| {
        let tip = [phi.cos(), phi.sin()];
        let way = [0.5 - tip[0], -1.0 - tip[1]];
        let length = way[0].hypot(way[1]);
        let speed = -(way[0] * -tip[1] + way[1] * tip[0]) / length * rate;
        let tension = 40.0 * (length - 0.25) + 1.5 * speed;
        let torque = tension * (tip[0] * way[1] - tip[1] * way[0]) / length;
        (torque - 9.81 * phi.cos()) / 0.67
    });
    for (found, right) in moved(&mechanism, 0.7).into_iter().zip(right) {
        assert!((found - right).abs() < 1e-8, "{found}, not {right}");
    }
}

/// A motion by an integral of a ramp: 2 rad/s² from 0.25 to 3 s, then level.
#[test]
fn motions_by_integrals_have_their_values() {
    let path = folder("crates/tools/tests/exchange/samples/asmt/four_bar.asmt");
    let text = std::fs::read_to_string(path).expect("it is part of the project");
    let start = text.find("RotationZ").expect("it has a motion");
    let start = start + text[start..].find('\n').expect("it ends") + 1;
    let end = start + text[start..].find('\n').expect("it ends");
    let motion = "\t\t\t\t\tpi/3 + integral(time, rampstep(time, 0.25, 0.0, 3.0, 5.5))";
    let text = format!("{}{motion}{}", &text[..start], &text[end..]);
    for text in [text.clone(), text.replace('\t', "    ")] {
        follow(
            &read(Format::Asmt, &text),
            &[0.0, 0.2, 1.0, 2.9, 3.5],
            |solver, t| {
                let ramp = t.clamp(0.25, 3.0) - 0.25;
                let crank = 60_f64.to_radians() + ramp * ramp + 5.5 * (t.max(3.0) - 3.0);
                for (name, right) in expected("four_bar", crank) {
                    let found = place(solver, solver.mechanism(), name);
                    assert_near(found, right, 2e-8, &format!("{name} at {t} s"));
                }
            },
        );
    }
}

/// Drivers that are inputs keep their values; only prescribed ones follow time.
#[test]
fn sweeps_moved_by_hand_are_inputs_within_their_limits() {
    let path = folder("crates/tools/tests/exchange/samples/linkage2/limitangle.linkage2");
    let text = std::fs::read_to_string(path).expect("it is part of the project");
    let text = text.replace("input=\"true\"", "input=\"true\" alwaysmanual=\"true\"");
    let draft = Format::Linkage.read(text.as_bytes(), "it", None);
    let text = draft.expect("it is right").write("it");
    assert!(
        text.contains("start = \"60*deg\", min = \"20*deg\", max = \"80*deg\""),
        "{text}"
    );
    let (_, path) = assembled(&parse(&text));
    assert!(matches!(path.driver_paths[0], DriverPath::Input { .. }));
}
