//! Texts of mechanisms with too many constraints or too few.

/// A file of these sections.
pub(crate) fn file(ground: &str, bodies: &str, joints: &str, drivers: &str) -> String {
    format!(
        "format = 1\nname = \"test\"\n[ground.markers]\n{ground}\n{bodies}\n[joints]\n{joints}\n\
         [drivers]\n{drivers}\n"
    )
}

/// A body with markers and an estimate.
pub(crate) fn body(name: &str, markers: &str, estimate: &str) -> String {
    format!("[bodies.{name}]\nmarkers = {{ {markers} }}\nestimate = [{estimate}]\n")
}

/// A joint of a kind that needs two markers only.
pub(crate) fn joint(name: &str, kind: &str, from: &str, to: &str) -> String {
    format!("{name} = {{ type = \"{kind}\", markers = [\"{from}\", \"{to}\"] }}\n")
}

pub(crate) fn angle_driver(name: &str, from: &str, to: &str, degrees: f64) -> String {
    format!(
        "{name} = {{ coordinate = \"angle\", markers = [\"{from}\", \"{to}\"], \
         start = \"{degrees}*deg\" }}\n"
    )
}

/// Two cranks of 0.1 m, 0.4 m apart, and more of them at these places, all on one coupler: all
/// turn alike.
pub(crate) fn parallelogram(more: &[[f64; 2]], start: f64, driver: bool) -> String {
    let (sin, cos) = start.to_radians().sin_cos();
    let mut ground = "O2 = [0, 0]\nO4 = [0.4, 0]\n".to_owned();
    let mut coupler = "A = [0, 0], B = [0.4, 0]".to_owned();
    let turned = |x: f64, y: f64| format!("{x}, {y}, \"{start}*deg\"");
    let mut bodies = body("crank", "O = [0, 0], A = [0.1, 0]", &turned(0.0, 0.0));
    bodies += &body("rocker", "O = [0, 0], B = [0.1, 0]", &turned(0.4, 0.0));
    let mut joints = joint("O2", "revolute", "ground.O2", "crank.O")
        + &joint("A", "revolute", "crank.A", "coupler.A")
        + &joint("B", "revolute", "coupler.B", "rocker.B")
        + &joint("O4", "revolute", "ground.O4", "rocker.O");
    for (k, &[x, y]) in more.iter().enumerate() {
        let k = k + 5;
        ground += &format!("O{k} = [{x}, {y}]\n");
        coupler += &format!(", C{k} = [{x}, {y}]");
        let name = format!("crank_{k}");
        bodies += &body(&name, "O = [0, 0], C = [0.1, 0]", &turned(x, y));
        let (pin, pivot) = (format!("C{k}"), format!("O{k}"));
        joints += &joint(
            &pin,
            "revolute",
            &format!("coupler.{pin}"),
            &format!("{name}.C"),
        );
        joints += &joint(
            &pivot,
            "revolute",
            &format!("ground.{pivot}"),
            &format!("{name}.O"),
        );
    }
    bodies += &body(
        "coupler",
        &coupler,
        &format!("{}, {}, 0", 0.1 * cos, 0.1 * sin),
    );
    let driver = if driver {
        angle_driver("crank_angle", "ground.O2", "crank.O", start)
    } else {
        String::new()
    };
    file(&ground, &bodies, &joints, &driver)
}

/// A slider-crank whose guide runs at an angle, with these joints before and after its own.
pub(crate) fn slider_crank(before: &str, after: &str, drivers: &str) -> String {
    let ground = "O = [0, 0]\nguide = [0, 0, \"20*deg\"]\n\
                  guide_2 = [\"0.1*cos(20*deg)\", \"0.1*sin(20*deg)\", \"20*deg\"]\n\
                  tilted = [0, 0, \"23*deg\"]\n";
    let bodies = body("crank", "O = [0, 0], A = [0.1, 0]", "0, 0, \"65*deg\"")
        + &body("rod", "A = [0, 0], B = [0.3, 0]", "0.04, 0.09, 0.1")
        + &body(
            "slider",
            "B = [0, 0], front = [0.05, 0]",
            "0.32, 0.12, \"20*deg\"",
        );
    let joints = before.to_owned()
        + &joint("guide", "translational", "ground.guide", "slider.B")
        + &joint("O", "revolute", "ground.O", "crank.O")
        + &joint("A", "revolute", "crank.A", "rod.A")
        + &joint("B", "revolute", "rod.B", "slider.B")
        + after;
    file(ground, &bodies, &joints, drivers)
}

pub(crate) fn crank_angle() -> String {
    angle_driver("crank_angle", "ground.O", "crank.O", 65.0)
}

/// A slider-crank in line, the crank's pin turned by so much; the rod is straight behind it.
pub(crate) fn lined_up(drivers: &str) -> String {
    let bodies = body("crank", "O = [0, 0], A = [0.1, 0]", "0, 0, 0")
        + &body("rod", "A = [0, 0], B = [0.3, 0]", "0.1, 0, 0")
        + &body("slider", "B = [0, 0]", "0.4, 0, 0");
    let joints = joint("O", "revolute", "ground.O", "crank.O")
        + &joint("A", "revolute", "crank.A", "rod.A")
        + &joint("B", "revolute", "rod.B", "slider.B")
        + &joint("guide", "translational", "ground.O", "slider.B");
    file("O = [0, 0]", &bodies, &joints, drivers)
}

/// Three wheels on one line of shafts, in mesh, the first driven; and these joints.
pub(crate) fn wheels(more: &str) -> String {
    let mut bodies = String::new();
    let mut joints = String::new();
    for (name, x) in [("a", 0.0), ("b", 0.2), ("c", 0.5)] {
        bodies += &body(name, "O = [0, 0]", &format!("{x}, 0, 0"));
        let (ground, own) = (format!("ground.{name}"), format!("{name}.O"));
        joints += &joint(&format!("shaft_{name}"), "revolute", &ground, &own);
    }
    joints += &pair("ab", "gear", "[0.1, 0.1]");
    joints += &pair("bc", "gear", "[0.1, 0.2]");
    let ground = "a = [0, 0]\nb = [0.2, 0]\nc = [0.5, 0]";
    let driver = angle_driver("turn", "ground.a", "a.O", 40.0);
    file(ground, &bodies, &(joints + more), &driver)
}

/// A belt around the first and the last of the wheels. Open, it turns them as the gears do.
pub(crate) fn belt(crossed: bool) -> String {
    pair("ac", "belt", &format!("[0.05, 0.1], crossed = {crossed}"))
}

/// A joint of two wheels, whose names are its own.
fn pair(name: &str, kind: &str, radii: &str) -> String {
    let (from, to) = name.split_at(1);
    format!(
        "{name} = {{ type = \"{kind}\", markers = [\"{from}.O\", \"{to}.O\"], radii = {radii} }}\n"
    )
}

/// An arm turned by a driver, with plates welded to it in these ways.
pub(crate) fn welded(welds: &str) -> String {
    let bodies = body(
        "arm",
        "O = [0, 0], P = [0.2, 0], Q = [0.3, 0.001]",
        "0, 0, 0.5",
    ) + &body("plate", "P = [0, 0], Q = [0.1, 0]", "0.18, 0.1, 0.5");
    let joints = joint("O", "revolute", "ground.O", "arm.O") + welds;
    let driver = angle_driver("arm_angle", "ground.O", "arm.O", 30.0);
    file("O = [0, 0]", &bodies, &joints, &driver)
}

pub(crate) fn with_joints(text: &str, joints: &str) -> String {
    text.replacen("[drivers]", &format!("{joints}\n[drivers]"), 1)
}

pub(crate) fn without_driver(text: &str, name: &str) -> String {
    let lines = text.lines().filter(|line| !line.starts_with(name));
    lines.flat_map(|line| [line, "\n"]).collect()
}

/// A cam with its joint twice, each with a contact of its own to find.
pub(crate) fn cam_touched_twice() -> String {
    let text = std::fs::read_to_string("mechanisms/cam_roller.toml").expect("it is shipped");
    let start = text.find("[joints.contact]").expect("it has a cam");
    let length = text[start + 1..]
        .find("\n[")
        .expect("it is not the last table")
        + 2;
    let again = text[start..start + length].replace("joints.contact", "joints.again");
    let mut text = text;
    text.insert_str(start + length, &again);
    text
}

/// The same joint once more, declared behind all others on lines.
pub(crate) fn double(text: &str, name: &str) -> String {
    let joints = text.split_once("[joints]").expect("it has joints").1;
    let mut lines = joints.lines().filter_map(|line| line.split_once('='));
    let line = lines.find(|(key, _)| key.trim() == name);
    let (_, table) = line.expect("it has this joint on a line");
    let again = format!("{name}_again = {table}");
    let end = text.len() - joints.len() + joints.find("\n[").expect("it is not the last table");
    let mut text = text.to_owned();
    text.insert_str(end, &format!("\n{again}\n"));
    text
}

/// The rhombic drive of a Stirling engine: two cranks in mesh, four rods, two yokes, with the cranks
/// estimated as mirror images. The gears' phase has them half a turn off.
pub(crate) fn rhombic_drive() -> String {
    let text = r#"
format = 1
name = "rhombic_drive"
[parameters]
r = 0.01397
rod = 0.04602
e = "half - 0.02065"
half = 0.028
[ground.markers]
L = ["-half", 0]
R = ["half", 0]
axis = [0, 0, "90*deg"]
[bodies.left]
markers = { O = [0, 0], A = ["r", 0] }
estimate = ["-half", 0, "150*deg"]
[bodies.right]
markers = { O = [0, 0], A = ["r", 0] }
estimate = ["half", 0, "30*deg"]
[bodies.yoke_up]
markers = { C = [0, 0, "90*deg"], L = ["-e", 0], R = ["e", 0] }
estimate = [0, "45*mm", 0]
[bodies.yoke_down]
markers = { C = [0, 0, "90*deg"], L = ["-e", 0], R = ["e", 0] }
estimate = [0, "-35*mm", 0]
[joints]
L = { type = "revolute", markers = ["ground.L", "left.O"] }
R = { type = "revolute", markers = ["ground.R", "right.O"] }
mesh = { type = "gear", markers = ["left.O", "right.O"], radii = ["half", "half"] }
rod1 = { type = "link", markers = ["left.A", "yoke_up.L"], length = "rod" }
rod2 = { type = "link", markers = ["right.A", "yoke_up.R"], length = "rod" }
rod3 = { type = "link", markers = ["left.A", "yoke_down.L"], length = "rod" }
rod4 = { type = "link", markers = ["right.A", "yoke_down.R"], length = "rod" }
bore_up = { type = "translational", markers = ["ground.axis", "yoke_up.C"] }
bore_down = { type = "translational", markers = ["ground.axis", "yoke_down.C"] }
[drivers]
turn = { coordinate = "angle", markers = ["ground.L", "left.O"], start = "150*deg" }
"#;
    text.to_owned()
}
