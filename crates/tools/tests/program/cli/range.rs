//! `biela range`

use crate::cli::program::{biela, column, stderr, stdout};
use crate::common::mechanisms::crank;

#[test]
fn range_tells_the_limits() {
    let folder = tempfile::tempdir().unwrap();
    let [csv, plot] = ["range.csv", "range.svg"].map(|name| folder.path().join(name));
    let [csv, plot] = [&csv, &plot].map(|path| path.to_str().unwrap());
    let range = |arguments: &[&str]| {
        let mut all = vec!["range"];
        all.extend(arguments);
        biela(&all)
    };
    let tlv = range(&["mechanisms/tlv.toml", "--csv", csv, "--plot", plot]).success();
    // Base minus and plus arm: 0.4 m and 0.25 m.
    for wanted in [
        "side_length, from 0.35 m\n",
        "  down to 0.15 m: dead point, where body `arm` and body `rod` line up\n",
        "  up to   0.65 m: dead point, where body `arm` and body `rod` line up\n",
    ] {
        assert!(stdout(&tlv).contains(wanted), "{}", stdout(&tlv));
    }
    let table = std::fs::read_to_string(csv).unwrap();
    let lengths = column(&table, "side_length.position");
    assert!(lengths.is_sorted() && (lengths[0] - 0.15).abs() < 1e-12);
    for (length, phi) in lengths.iter().zip(column(&table, "arm.phi")) {
        let expected = (0.4_f64 * 0.4 + 0.25 * 0.25 - length * length) / (2.0 * 0.4 * 0.25);
        // At a limit the angle goes with the root of the distance from it.
        assert!(
            (phi.cos() - expected.clamp(-1.0, 1.0)).abs() < 1e-12,
            "{length}"
        );
    }
    assert!(
        column(&table, "rcond")
            .iter()
            .all(|rcond| (0.0..=1.0).contains(rcond))
    );
    let picture = std::fs::read_to_string(plot).unwrap();
    assert!(picture.contains(">side_length [m]<") && picture.contains(">arm_angle<"));

    // A table on stdout stands alone.
    let printed = stdout(&range(&["mechanisms/four_bar.toml", "--csv", "-"]).success());
    assert_eq!(column(&printed, "transmission_angle").len(), 361);
    let text = stdout(&range(&["mechanisms/four_bar.toml"]).success());
    assert!(
        text.contains("turns fully: after a turn the mechanism is where it was"),
        "{text}"
    );
    // 0.25 m and 0.30 m span 0.5 m there.
    assert!(
        text.contains("transmission angle from 49.46 deg, at 180 deg"),
        "{text}"
    );
    // With a base that is too long for the crank to turn.
    let text = stdout(&range(&["mechanisms/four_bar.toml", "--set", "base=0.48"]).success());
    let limit = ((0.1_f64 * 0.1 + 0.48 * 0.48 - 0.55 * 0.55) / (2.0 * 0.1 * 0.48)).acos();
    let found = text.split("up to   ").nth(1);
    let found = found.and_then(|rest| rest.split(' ').next());
    let found: f64 = found
        .expect("there is a limit")
        .parse()
        .expect("it is a number");
    // Ten decimals are shown.
    assert!((found - limit.to_degrees()).abs() < 1e-10, "{text}");
    assert!(text.contains("dead point"), "{text}");

    let both = stdout(&range(&["mechanisms/pantograph.toml"]).success());
    assert!(
        both.contains("tracer_x, from") && both.contains("\ntracer_y, from"),
        "{both}"
    );
    // Numbers of few digits where more say nothing.
    for (file, expected) in [
        (
            "mechanisms/scotch_yoke.toml",
            "  reciprocal condition 1.00 everywhere\n",
        ),
        (
            "mechanisms/pick_and_place.toml",
            "  up to   10.04 m and farther: no limit was found\n",
        ),
    ] {
        let text = stdout(&range(&[file]).success());
        assert!(text.contains(expected), "{text}");
    }
    for (arguments, expected) in [
        (
            &["mechanisms/pantograph.toml", "--plot", plot][..],
            "--csv and --plot need one",
        ),
        (
            &["mechanisms/tlv.toml", "--driver", "side"],
            "--driver: no driver `side`; did you mean `side_length`?",
        ),
        (
            &["mechanisms/tlv.toml", "--plot", "x.pdf"],
            "neither the extension",
        ),
    ] {
        let message = stderr(&range(arguments).code(2));
        assert!(message.contains(expected), "{message}");
    }
}

/// The handle's angle there is the arcsine of 2/3.
#[test]
fn range_and_run_end_at_stops() {
    let limits = biela(&["range", "mechanisms/latch.toml"]).success();
    for wanted in [
        "  down to -40 deg: stop `rose` reached: handle_angle = -0.698131701 rad (-40.000000 deg)\n",
        "  up to   41.8103148958 deg: stop `strike` reached: throw = 0.020000000 m\n",
    ] {
        assert!(stdout(&limits).contains(wanted), "{}", stdout(&limits));
    }
    let drive = [
        "--drive",
        "handle_angle = t",
        "--stop",
        "1",
        "--step",
        "0.5",
    ];
    let run = biela(&[&["run", "mechanisms/latch.toml"], &drive[..]].concat()).code(1);
    assert_eq!(column(&stdout(&run), "time").last(), Some(&0.5));
    let message = "error: mechanisms/latch.toml: stop `strike` reached: throw = 0.020000000 m at \
                   t = 0.729727656 s: the mechanism cannot go on, with `handle_angle` at";
    assert!(stderr(&run).starts_with(message), "{}", stderr(&run));
}

#[test]
fn a_range_without_poses_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let [file, csv] = ["welded.toml", "range.csv"].map(|name| folder.path().join(name));
    let welded = r#"
        format = 1
        name = "welded"
        ground.markers.O = [0, 0]
        bodies.plate.markers.O = [0, 0]
        joints.O = { type = "weld", markers = ["ground.O", "plate.O"] }
    "#;
    std::fs::write(&file, welded).unwrap();
    let [file, table] = [&file, &csv].map(|path| path.to_str().unwrap());
    let message = stderr(&biela(&["range", file, "--csv", table]).code(2));
    assert_eq!(message, "error: range: the mechanism has no driver\n");
    // The side goes from 0.15 m to 0.65 m.
    for (option, value, limit) in [("--from", "0.7", "0.65"), ("--to", "0.1", "0.15")] {
        let arguments = [
            "range",
            "mechanisms/tlv.toml",
            option,
            value,
            "--csv",
            table,
        ];
        let message = stderr(&biela(&arguments).code(1));
        let expected = format!(
            "error: mechanisms/tlv.toml: side_length does not get to {option}, {value} m: it ends at \
             {limit} m: dead point, where body `arm` and body `rod` line up\n"
        );
        assert_eq!(message, expected);
    }
    assert!(!csv.exists());
}

#[test]
fn bounds_that_look_like_degrees_are_warned_of() {
    let warning = |option: &str| {
        format!(
            "warning: {option}: an angle of 90 rad is 5156.6 deg; degrees are written `90*deg`\n"
        )
    };
    let range = |more: &[&str]| {
        let mut arguments = vec!["range", "mechanisms/four_bar.toml"];
        arguments.extend(more);
        stderr(&biela(&arguments).success())
    };
    assert_eq!(range(&["--from", "0", "--to", "90"]), warning("--to"));
    assert_eq!(range(&["--from", "0", "--to", "90*deg"]), "");
    // A length of 90 m is no angle.
    let side = biela(&["range", "mechanisms/tlv.toml", "--to", "90"]).success();
    assert_eq!(stderr(&side), "");
    let arguments = ["draw", "mechanisms/four_bar.toml", "-o", "-", "--to", "90"];
    assert_eq!(stderr(&biela(&arguments).success()), warning("--to"));
}

/// The cylinder reaches from the difference to the sum of the distances 2 m and 0.5 m of its ends
/// from the pin. The link of 1.5 m cannot reach a lever of 0.3 m on the other side of its pin at
/// 2 m once the crank of 0.5 m has its end 1.8 m away: cos u = (0.25 + 4 - 1.8²)/2.
#[test]
fn a_dead_point_of_one_body_names_its_link_or_cylinder() {
    let folder = tempfile::tempdir().unwrap();
    let range = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        stdout(&biela(&["range", path.to_str().unwrap()]).success())
    };
    let tipper = r#"
        format = 1
        name = "tipper"
        ground = { markers = { hinge = [0, 0], foot = [2, 0] } }
        bodies.bed.markers = { hinge = [0, 0], end = [0, 0.5] }
        joints.hinge = { type = "revolute", markers = ["ground.hinge", "bed.hinge"] }
        drivers.cylinder = { coordinate = "distance", markers = ["ground.foot", "bed.end"], start = 2.1 }
    "#;
    let told = range("tipper.toml", tipper);
    for limit in ["1.5", "2.5"] {
        let line =
            format!("{limit} m: dead point, where body `bed` and driver `cylinder` line up\n");
        assert!(told.contains(&line), "{told}");
    }
    let linked = r#"
        format = 1
        name = "linked"
        ground = { markers = { A = [0, 0], D = [2, 0] } }
        bodies.crank.markers = { A = [0, 0], B = [0.5, 0] }
        bodies.lever = { markers = { D = [0, 0], C = [0.3, 0] }, estimate = [2, 0, 1.5] }
        joints.A = { type = "revolute", markers = ["ground.A", "crank.A"] }
        joints.D = { type = "revolute", markers = ["ground.D", "lever.D"] }
        joints.rod = { type = "link", markers = ["crank.B", "lever.C"], length = 1.5 }
        drivers.turn = { coordinate = "angle", markers = ["ground.A", "crank.A"], start = 0 }
    "#;
    let told = range("linked.toml", linked);
    let limit = ((0.25 + 4.0 - 1.8_f64.powi(2)) / 2.0).acos().to_degrees();
    let line = format!("{limit:.10} deg");
    assert!(told.contains(&line), "{line}: {told}");
    let line = "dead point, where body `lever` and joint `rod` line up\n";
    assert_eq!(told.matches(line).count(), 2, "{told}");
}

/// A cam that lifts a knife edge by 0.5 mm within 3 deg: the steepest place of the cycloid, twice
/// the mean slope, lies between two degrees.
const CAM: &str = r#"
format = 1
name = "steep"
[ground.markers]
O = [0, 0]
G = [0, 0, "90*deg"]
[bodies.cam]
markers = { O = [0, 0] }
[bodies.follower]
markers = { K = [0, 0, "90*deg"] }
estimate = [0, 0.1, 0]
mass = 1
[joints]
O = { type = "revolute", markers = ["ground.O", "cam.O"] }
G = { type = "translational", markers = ["ground.G", "follower.K"] }
[joints.contact]
type = "cam"
markers = ["cam.O", "follower.K"]
follower = "knife"
profile = { table = [[0, 0.1], [3, 0.1005], [90, 0.1005], [200, 0.1]], scale = ["deg", 1], law = "cycloidal" }
[drivers]
q = { coordinate = "angle", markers = ["ground.O", "cam.O"], start = 0 }
"#;

const LIMITED: &str = "start = 1, min = '-90*deg', max = '90*deg'";

/// A crank without mass, loaded along its own angle.
fn loaded(load: &str) -> String {
    let force = "forces.f = { coordinate = 'angle', markers = ['ground.O', 'crank.O'], value = ";
    crank(LIMITED) + &format!("{force}'{load}' }}\n")
}

/// A spring of no free length from a point above the pivot of an arm balances its weight everywhere
/// if its stiffness times the two distances is m g l. With 1e-12 more of mass the effort is that
/// part of m g l, which `check` tells for a heavy arm; the rounding of the terms is 1e-15 of them.
#[test]
fn an_effort_of_rounding_is_told_as_zero() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("balance.toml");
    let balance = |mass: &str, weight: &str| {
        let arm = format!(
            "parameters.weight = {weight}\nground.markers.S = [0, 0.3]\n\
             bodies.crank.center = [0.5, 0]\nbodies.crank.mass = '{mass}'\n\
             forces.spring = {{ coordinate = 'distance', markers = ['ground.S', 'crank.A'], \
             value = '-position*weight/0.3' }}\n"
        );
        let text = crank("start = 0.3") + &arm;
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap()
    };
    let effort = |command: &str, file: &str, before: &str| {
        let text = stdout(&biela(&[command, file]).success());
        let (_, behind) = text.split_once(before).expect("it is there");
        let (number, _) = behind.split_once(" N.m").expect("it has a unit");
        number.to_owned()
    };
    let range = |mass, weight| effort("range", balance(mass, weight), "largest effort ");
    let check = |mass, weight| effort("check", balance(mass, weight), "turn.effort = ");
    assert_eq!(range("2", "19.62"), "0");
    assert_eq!(range("2e5", "19.62e5"), "0");
    assert_eq!(range("2e-12", "19.62e-12"), "0");
    assert_eq!(check("2e5", "19.62e5"), "0");
    let part = |found: String, size: f64| {
        let found: f64 = found.parse().expect("it is a number");
        (found.abs() / size * 1e12 - 1.0).abs() < 0.02
    };
    assert!(part(range("2*(1 + 1e-12)", "19.62"), 9.81));
    assert!(part(range("2e-12*(1 + 1e-12)", "19.62e-12"), 9.81e-12));
    let expected = 9.81e5 * 0.3_f64.cos();
    assert!(part(check("2e5*(1 + 1e-12)", "19.62e5"), expected));
}

#[test]
fn the_largest_effort_is_found_between_samples() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("mechanism.toml");
    let range = |text: &str, more: &[&str]| {
        std::fs::write(&file, text).unwrap();
        let arguments = [&["range", file.to_str().unwrap()][..], more].concat();
        stdout(&biela(&arguments).success())
    };
    // Effort = weight · slope; below the follower the cam has turned 90 deg − 1.5 deg.
    let slope = 2.0 * 0.0005 / 3_f64.to_radians();
    let effort = format!("{:.6}", -9.81 * slope);
    let text = range(CAM, &[]);
    let expected = format!("at rest, largest effort {effort} N.m, at 88.5 deg\n");
    assert!(text.contains(&expected), "{expected}{text}");
    // A peak of 2 at 0.4 deg and one of 1 at 40.4 deg; a pole at a sample and one between two.
    let load = |load: &str, more: &[&str]| range(&loaded(load), more);
    let bells = "-2*exp(-((position - 0.4*deg)/(1*deg))^2) - exp(-((position - 40.4*deg)/deg)^2)";
    let text = load(bells, &[]);
    assert!(
        text.contains("largest effort 2 N.m, at 0.4 deg\n"),
        "{text}"
    );
    let text = load("1/position", &["--drive", "turn = 1*deg"]);
    let missing = "  at rest, no forces at 0 deg: force `f` has no finite value here\n";
    for expected in ["  at rest, effort grows without bound at 0 deg\n", missing] {
        assert!(text.contains(expected), "{expected}{text}");
    }
    let text = load("1/(position - 0.5*deg)", &["--drive", "turn = 1*deg"]);
    assert!(
        text.contains("effort grows without bound at 0.5 deg\n"),
        "{text}"
    );
    let text = load("sqrt(position)", &["--drive", "turn = 1*deg"]);
    let expected = "largest effort -1.25331 N.m, at 90 deg\n";
    assert!(text.contains(expected), "{text}");
    let expected =
        "no forces at 90 of 181 poses, first at -90 deg: force `f` has no finite value here\n";
    assert!(text.contains(expected), "{text}");
}

#[test]
fn computed_measures_have_their_range() {
    let folder = tempfile::tempdir().unwrap();
    let [file, csv, plot] =
        ["lever.toml", "range.csv", "range.svg"].map(|name| folder.path().join(name));
    let measures = "[measures]\n\
                    rise = { value = \"sin(turn.position)\", unit = \"m\" }\n\
                    reach = { value = \"-(crank.omega/turn.velocity)*cos(2*(turn.position - 0.5*deg))\" }\n\
                    power = { value = \"2*turn.velocity\", unit = \"W\" }\n\
                    pole = { value = \"1/(turn.position - 10*deg)\" }\n\
                    root = { value = \"sqrt(turn.position - 1)\" }\n";
    std::fs::write(&file, crank(LIMITED) + measures).unwrap();
    let [file, csv, plot] = [&file, &csv, &plot].map(|path| path.to_str().unwrap());
    let range = |more: &[&str]| {
        let arguments = [&["range", file, "--drive", "turn = 60*deg"][..], more].concat();
        stdout(&biela(&arguments).success())
    };
    let text = range(&["--csv", csv, "--plot", plot]);
    for expected in [
        "  rise from -1 m, at -90 deg, to 1 m, at 90 deg\n",
        "  at 1 rad/s, reach from -1, at 0.5 deg, to 1, at -89.5 deg\n",
        "  at 1 rad/s, power 2 W everywhere\n",
        "  pole from -infinity, at 10 deg, to infinity, at 10 deg\n",
        ", at 57.2958 deg, to 0.755511, at 90 deg\n",
        "  root has no value at 148 of 181 poses, first at -90 deg\n",
    ] {
        assert!(text.contains(expected), "{expected}{text}");
    }
    let table = std::fs::read_to_string(csv).unwrap();
    let angles = column(&table, "turn.position");
    for (angle, rise) in angles.iter().zip(column(&table, "rise")) {
        assert!((rise - angle.sin()).abs() < 1e-12);
    }
    assert!(column(&table, "root")[0].is_nan());
    let picture = std::fs::read_to_string(plot).unwrap();
    assert!(picture.contains(">rise<") && picture.contains(">power<"));
    // Velocities are those of the speed that is given, also without forces.
    let text = range(&["--speed", "-3"]);
    assert!(
        text.contains("  at -3 rad/s, power -6 W everywhere\n"),
        "{text}"
    );
    let text = range(&["--speed", "0"]);
    assert!(
        text.contains("  at rest, reach has no value at 181 of 181 poses"),
        "{text}"
    );
}

/// A stop on one side of an angle that turns freely the other way.
#[test]
fn range_tells_a_stop_on_one_side() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("lid.toml");
    let text = crank("start = '20*deg'") + "stops.closed = { of = 'turn', min = '-3*deg' }\n";
    std::fs::write(&file, text).unwrap();
    let told = stdout(&biela(&["range", file.to_str().unwrap()]).success());
    for wanted in [
        "  down to -3 deg: stop `closed` reached",
        "  up to   no limit\n",
    ] {
        assert!(told.contains(wanted), "{told}");
    }
}
