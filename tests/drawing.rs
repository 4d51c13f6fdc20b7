//! Drawings of mechanisms: what is in the scene, and that the pictures are whole.

mod common;
#[path = "common/generated.rs"]
#[allow(dead_code, reason = "each test file uses a part of this")]
mod generated;

use biela::drawing::{
    Anchor, Axis, Chart, Held, Line, Panel, Scene, Sheet, Symbol, WaySide, png, svg,
};
use biela::mechanism::BodyId;
use common::{assembled, folder, parse, shipped, stems};
use generated::{Ground, chain};
use quick_xml::Reader;
use quick_xml::events::Event;

const WIDTH: u32 = 640;

fn scene_of(text: &str) -> Scene {
    Scene::new(&mut assembled(&parse(text)).0, true)
}

fn picture(name: &str) -> String {
    let (mut solver, _) = assembled(&shipped(name));
    let scene = Scene::new(&mut solver, true);
    svg::write(&Sheet::new(&scene, &solver.pose().q), WIDTH, false)
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-12
}

#[test]
fn a_four_bar_has_its_bars_pins_and_pivots() {
    let (mut solver, _) = assembled(&shipped("four_bar"));
    let home = solver.pose().clone();
    let scene = Scene::new(&mut solver, true);
    assert_eq!(*solver.pose(), home, "the solver is back where it was");
    assert_eq!(scene.bodies, ["crank", "coupler", "rocker"]);

    let count =
        |wanted: &dyn Fn(&Symbol) -> bool| scene.symbols.iter().filter(|s| wanted(s)).count();
    for (body, corners) in [(0, 2), (1, 3), (2, 2)] {
        let link = |symbol: &Symbol| matches!(symbol, Symbol::Link { body: of, points } if *of == BodyId(body) && points.len() == corners);
        assert_eq!(count(&link), 1, "body {body}");
    }
    assert_eq!(count(&|s| matches!(s, Symbol::Pin { .. })), 4);
    assert_eq!(count(&|s| matches!(s, Symbol::Fixture { .. })), 2);
    assert_eq!(
        count(&|s| matches!(s, Symbol::AngleDriver { name, .. } if name == "crank_angle")),
        1
    );
    assert_eq!(
        count(&|s| matches!(s, Symbol::Point { name, .. } if name == "P")),
        1
    );
    assert_eq!(count(&|s| matches!(s, Symbol::Trace { .. })), 1);
    assert_eq!(scene.symbols.len(), 3 + 4 + 2 + 1 + 1 + 1);
}

#[test]
fn a_trace_is_the_path_of_the_point() {
    let (mut solver, _) = assembled(&shipped("four_bar"));
    let scene = Scene::new(&mut solver, true);
    let traces: Vec<_> = scene
        .symbols
        .iter()
        .filter_map(|s| match s {
            Symbol::Trace {
                body: Some(BodyId(1)),
                points,
            } => Some(points),
            _ => None,
        })
        .collect();
    let [points] = traces[..] else {
        panic!("{traces:?}")
    };
    // The crank turns fully, so the curve closes.
    let (first, last) = (points[0], points[points.len() - 1]);
    assert!(near(first[0], last[0]) && near(first[1], last[1]));
    // P is hypot(125, 50) mm from both ends of the coupler, one of which is on the crank's circle
    // of 100 mm about O2, the other on the rocker's of 300 mm about O4.
    let reach = f64::hypot(0.125, 0.05);
    for [x, y] in points {
        assert!((f64::hypot(*x, *y) - 0.1).abs() <= reach + 1e-12);
        assert!((f64::hypot(x - 0.4, *y) - 0.3).abs() <= reach + 1e-12);
    }
    let without = Scene::new(&mut solver, false);
    assert_eq!(without.symbols.len(), scene.symbols.len() - 1);
}

#[test]
fn a_rocking_point_draws_its_arc_once() {
    // The left rocker's end moves on a circle about O2, forth and back.
    let (mut solver, _) = assembled(&shipped("chebyshev"));
    let length = |points: &[[f64; 2]]| -> f64 {
        points
            .windows(2)
            .map(|p| f64::hypot(p[1][0] - p[0][0], p[1][1] - p[0][1]))
            .sum()
    };
    let drawn: f64 = Scene::new(&mut solver, true)
        .symbols
        .iter()
        .map(|s| match s {
            Symbol::Trace {
                body: Some(BodyId(0)),
                points,
            } => length(points),
            _ => 0.0,
        })
        .sum();
    // Turning points: coupler and right rocker in line, stretched (7 parts) and folded (3), on a
    // base of 4 with a left rocker of 5. The arc is the rocker's length times the difference.
    let angle = |far: f64| ((25.0 + 16.0 - far * far) / 40.0_f64).acos();
    let arc = 0.25 * (angle(7.0) - angle(3.0));
    assert!((drawn / arc - 1.0).abs() < 0.03, "{drawn} {arc}");
}

#[test]
fn ways_are_as_long_as_the_motion() {
    // The slider goes between sqrt((rod -+ crank)^2 - offset^2).
    let (mut solver, _) = assembled(&shipped("slider_crank"));
    let scene = Scene::new(&mut solver, true);
    let way = scene.symbols.iter().find_map(|s| match s {
        Symbol::SlideWay { range, side, .. } => Some((*range, *side)),
        _ => None,
    });
    let ([low, high], side) = way.expect("the slider is guided");
    let end = |length: f64| f64::sqrt(length * length - 0.01 * 0.01);
    // The nearest of 240 poses a turn is within 0.75° of the end: 50 mm (1 - cos 0.75°).
    assert!((low - end(0.1)).abs() < 1e-5 && (high - end(0.2)).abs() < 1e-5);
    assert_eq!(side, WaySide::Below);
}

#[test]
fn a_block_on_a_moving_body_stretches_it() {
    // The arm's end is between 0.15 m and 0.65 m from the barrel's pivot.
    let (mut solver, _) = assembled(&shipped("tlv_crank"));
    let scene = Scene::new(&mut solver, true);
    let barrel = scene.symbols.iter().find_map(|s| match s {
        Symbol::Link {
            body: BodyId(1),
            points,
        } => Some(points.clone()),
        _ => None,
    });
    let longest = barrel
        .expect("it is drawn")
        .iter()
        .fold(0.0, |x: f64, p| x.max(p[0]));
    assert!((longest - 0.65).abs() < 1e-4);
    assert!(scene.symbols.iter().any(|s| matches!(
        s,
        Symbol::Block {
            at: Anchor {
                body: Some(BodyId(2)),
                ..
            },
            on: Some(BodyId(1))
        }
    )));
}

const WHEELS: &str = r#"
    format = 1
    name = "wheels"
    [ground.markers]
    A = [0, 0]
    B = [0.09, 0]
    C = [0.25, 0.02]
    [bodies.pinion]
    markers = { C = [0, 0] }
    [bodies.wheel]
    markers = { C = [0, 0] }
    estimate = [0.09, 0, 0]
    [bodies.pulley]
    markers = { C = [0, 0] }
    estimate = [0.25, 0.02, 0]
    [bodies.rack]
    markers = { R = [0, 0] }
    estimate = [0, -0.03, 0]
    [joints]
    A = { type = "revolute", markers = ["ground.A", "pinion.C"] }
    B = { type = "revolute", markers = ["ground.B", "wheel.C"] }
    C = { type = "revolute", markers = ["ground.C", "pulley.C"] }
    mesh = { type = "gear", markers = ["pinion.C", "wheel.C"], teeth = [12, 24] }
    belt = { type = "belt", markers = ["wheel.C", "pulley.C"], radii = [0.05, 0.03], crossed = true }
    drive = { type = "rack_and_pinion", markers = ["pinion.C", "rack.R"], radius = 0.03 }
    lift = { type = "revolute_translational", markers = ["ground.A", "rack.R"], offset = -0.03 }
    [constraints]
    level = { coordinate = "angle", markers = ["ground.A", "rack.R"], value = 0 }
    [drivers]
    turn = { coordinate = "angle", markers = ["ground.A", "pinion.C"], start = 0 }
"#;

#[test]
fn wheels_have_their_pitch_circles() {
    let scene = scene_of(WHEELS);
    let wheels: Vec<_> = scene
        .symbols
        .iter()
        .filter_map(|s| match s {
            Symbol::Wheel {
                at,
                radius,
                ring: false,
            } => Some((at.body.map(BodyId::index), *radius)),
            _ => None,
        })
        .collect();
    // By teeth the pitch circles share the distance of the centres, 90 mm, as 12 : 24.
    let expected = [(0, 0.03), (1, 0.06), (1, 0.05), (2, 0.03)];
    assert_eq!(wheels.len(), expected.len());
    for (body, radius) in expected {
        assert!(
            wheels
                .iter()
                .any(|w| w.0 == Some(body) && near(w.1, radius)),
            "{wheels:?}"
        );
    }
    // A wheel or a rack is all there is of its body.
    assert!(
        !scene
            .symbols
            .iter()
            .any(|s| matches!(s, Symbol::Link { .. }))
    );
    // One turn moves the pinion's centre by 2 pi r along the rack.
    let rack = scene.symbols.iter().find_map(|s| match s {
        Symbol::Rack {
            range, above: true, ..
        } => Some(range[1] - range[0]),
        _ => None,
    });
    assert!(rack.expect("it is drawn") > std::f64::consts::TAU * 0.03);
    let (mut solver, _) = assembled(&parse(WHEELS));
    let scene = Scene::new(&mut solver, true);
    check_picture(
        "wheels",
        &svg::write(&Sheet::new(&scene, &solver.pose().q), WIDTH, true),
    );
}

/// The scene of a shipped mechanism.
fn scene(name: &str) -> Scene {
    Scene::new(&mut assembled(&shipped(name)).0, true)
}

/// The cam's contour.
fn contour(scene: &Scene) -> Vec<[f64; 2]> {
    let cam = scene.symbols.iter().find_map(|s| match s {
        Symbol::Cam { contour, .. } => Some(contour.clone()),
        _ => None,
    });
    cam.expect("the cam is drawn")
}

/// The guide of a follower's stem.
fn stem_guide(scene: &Scene) -> [f64; 2] {
    let guide = scene.symbols.iter().find_map(|s| match s {
        Symbol::SlideWay {
            range,
            side: WaySide::Both,
            holds: Held::Bar,
            ..
        } => Some(*range),
        _ => None,
    });
    guide.expect("the stem is guided")
}

/// The points of a body's link, if it has one.
fn link(scene: &Scene, body: usize) -> Option<Vec<[f64; 2]>> {
    scene.symbols.iter().find_map(|s| match s {
        Symbol::Link { body: of, points } if of.index() == body => Some(points.clone()),
        _ => None,
    })
}

#[test]
fn a_cam_is_its_contour_and_a_knife_touches_it() {
    let scene = scene("cam_knife");
    // R = 30 mm + 10 mm (1 - cos theta).
    for [x, y] in contour(&scene) {
        let radius = 0.03 + 0.01 * (1.0 - f64::atan2(y, x).cos());
        assert!(near(f64::hypot(x, y), radius));
    }
    assert_eq!(
        link(&scene, 0),
        None,
        "the contour is all there is of the cam"
    );
    let knife = scene.symbols.iter().find_map(|s| match s {
        Symbol::Knife { at } => Some(*at),
        _ => None,
    });
    let knife = knife.expect("it is drawn");
    assert_eq!((knife.body, knife.position), (Some(BodyId(1)), [0.0; 2]));
    assert!(
        near(knife.angle, std::f64::consts::FRAC_PI_2),
        "up the stem"
    );
    // The edge gets up to 50 mm, and the stem of 60 mm down to 90 mm.
    let [low, high] = stem_guide(&scene);
    assert!(0.05 < low && low < high && high < 0.09);
}

#[test]
fn a_roller_has_its_radius_and_its_guide_is_clear_of_it() {
    let scene = scene("cam_roller");
    assert!(scene.symbols.iter().any(|s| matches!(
        s,
        Symbol::Roller {
            at: Anchor {
                body: Some(BodyId(1)),
                ..
            },
            radius
        } if near(*radius, 0.01)
    )));
    // A slider-crank with crank 15 mm, rod 50 mm and offset 8 mm: the roller's centre gets up to
    // sqrt(65^2 - 8^2) mm, its top 10 mm higher.
    assert!(stem_guide(&scene)[0] > f64::sqrt(0.065 * 0.065 - 0.008 * 0.008) + 0.01);
    assert!(link(&scene, 1).is_some_and(|points| points.contains(&[0.0, 0.06])));
}

#[test]
fn a_face_is_where_contact_is() {
    let faces = |scene: &Scene| -> Vec<([f64; 2], bool)> {
        let face = |s: &Symbol| match s {
            Symbol::Face { range, above, .. } => Some((*range, *above)),
            _ => None,
        };
        scene.symbols.iter().filter_map(face).collect()
    };
    // As long as its markers.
    let shipped_scene = scene("cam_flat");
    assert_eq!(faces(&shipped_scene), [([-0.03, 0.03], false)]);
    // The stem goes from the face to the top.
    let stem = link(&shipped_scene, 1).expect("it is drawn");
    assert_eq!(stem, [[0.0, 0.0], [0.0, 0.05]]);

    // Without them as contact needs: e cos(angle) to both sides, and a quarter of that length on.
    let path = folder("mechanisms/cam_flat.toml");
    let text = std::fs::read_to_string(path).expect("it is shipped");
    let bare = text.replace(
        ", left = [-0.03, 0], right = [0.03, 0], top = [0, 0.05]",
        "",
    );
    assert_ne!(bare, text);
    let scene = scene_of(&bare);
    let faces = faces(&scene);
    let [([low, high], false)] = faces[..] else {
        panic!("{faces:?}")
    };
    // The contour's points are 1.5 deg apart: the highest is within half of that, as seen from
    // the axle, of the disc's highest, and a turn about the axle is at most 55/40 of one about
    // the disc's centre.
    let off = 0.04 * (0.75_f64 * 55.0 / 40.0).to_radians();
    assert!((high - 1.5 * 0.015).abs() < 1.5 * off && (low + 1.5 * 0.015).abs() < 1.5 * off);
    // It gets a stem all the same, which its guide holds.
    let stem = link(&scene, 1).expect("it is drawn");
    let [bottom, top] = stem_guide(&scene);
    let end = stem.iter().map(|p| p[1]).fold(0.0, f64::max);
    // The face is 25 mm to 55 mm above the axle.
    assert!(0.055 < bottom && bottom < top && top < 0.025 + end);
}

#[test]
fn a_lever_with_a_face_keeps_its_pivot() {
    let scene = scene("cam_flat_arm");
    assert_eq!(link(&scene, 1), Some(vec![[0.0; 2]]));
    let face = scene.symbols.iter().find_map(|s| match s {
        Symbol::Face { range, above, .. } => Some((*range, *above)),
        _ => None,
    });
    // The lever points to the left: what is below it is on its y-axis' side.
    assert_eq!(face, Some(([0.0, 0.12], true)));
}

#[test]
fn a_rack_is_guided_along_its_back() {
    let scene = scene("rack_drive");
    let rack = scene.symbols.iter().find_map(|s| match s {
        Symbol::Rack {
            along: Anchor { body: Some(_), .. },
            range,
            ..
        } => Some(*range),
        _ => None,
    });
    let [low, high] = rack.expect("it is drawn");
    let guide = scene.symbols.iter().find_map(|s| match s {
        Symbol::SlideWay {
            range,
            side: WaySide::Above,
            holds: Held::Rack,
            ..
        } => Some(*range),
        _ => None,
    });
    // The rack goes twice as far as the carriage, from 140 mm to 260 mm: it always is between its
    // left end at 520 mm and its right one at 280 mm. The poses, 1.5 deg of the crank apart, are
    // within 0.75 deg of the ends, where 2 * 0.06 m * (1 + 60/140) * (1 - cos 0.75 deg) is lost.
    let [from, to] = guide.expect("it is guided");
    assert!((from - (0.52 + low)).abs() < 2e-5 && (to - (0.28 + high)).abs() < 2e-5);
}

#[test]
fn a_trace_goes_on_until_the_mechanism_is_back() {
    let pieces = |name: &str| -> Vec<Vec<[f64; 2]>> {
        let trace = |s: &Symbol| match s {
            Symbol::Trace { points, .. } => Some(points.clone()),
            _ => None,
        };
        scene(name).symbols.iter().filter_map(trace).collect()
    };
    // The cranks are back after two turns of the first.
    let curve = pieces("geared_five_bar");
    assert_eq!(curve.len(), 1);
    let (first, last) = (curve[0][0], curve[0][curve[0].len() - 1]);
    assert!((0..2).all(|k| (first[k] - last[k]).abs() < 1e-9));
    // Planet and arm are back after four turns of the sun: a hypocycloid with three cusps, of
    // length 16 r. What is so near to a cusp that both sides look like one is left out.
    let length = |points: &Vec<[f64; 2]>| -> f64 {
        let steps = points.windows(2);
        let step = |p: &[[f64; 2]]| f64::hypot(p[1][0] - p[0][0], p[1][1] - p[0][1]);
        steps.map(step).sum()
    };
    let drawn: f64 = pieces("planetary_gear").iter().map(length).sum();
    assert!((drawn / (16.0 * 0.024) - 1.0).abs() < 0.03, "{drawn}");
}

#[test]
fn prescribed_motions_are_followed_until_the_stop_time() {
    let text = r#"
        format = 1
        name = "cart"
        [ground.markers]
        O = [0, 0]
        [bodies.cart]
        markers = { C = [0, 0] }
        [joints]
        way = { type = "translational", markers = ["ground.O", "cart.C"] }
        [drivers]
        travel = { coordinate = "x", markers = ["ground.O", "cart.C"], motion = "0.1*t" }
        [outputs]
        markers = ["cart.C"]
        [simulation]
        stop = 3.0
    "#;
    let scene = scene_of(text);
    let way = scene.symbols.iter().find_map(|s| match s {
        Symbol::SlideWay { range, .. } => Some(*range),
        _ => None,
    });
    let [low, high] = way.expect("the cart is guided");
    assert!(near(low, 0.0) && near(high, 0.3));
}

/// A text on the sheet: where its box begins and ends.
struct Label {
    text: String,
    x: [f64; 2],
    y: [f64; 2],
}

/// Reads a picture; fails unless it is well-formed and everything is on the sheet.
fn check_picture(name: &str, svg: &str) -> Vec<Label> {
    let mut reader = Reader::from_str(svg);
    let (mut size, mut labels, mut open): ([f64; 2], Vec<Label>, bool) =
        ([0.0; 2], Vec::new(), false);
    loop {
        match reader.read_event().expect("the picture is well-formed") {
            Event::Eof => break,
            Event::Start(element) | Event::Empty(element) => {
                let attribute = |key: &str| {
                    element
                        .try_get_attribute(key)
                        .expect("attributes are well-formed")
                        .map(|a| a.value.into_owned())
                };
                let value = |key: &str| attribute(key).map(|v| v.parse::<f64>().expect("a number"));
                open = element.name().as_ref() == "text";
                match element.name().as_ref() {
                    "svg" => {
                        let view = attribute("viewBox").expect("there is one");
                        let numbers: Vec<f64> = view
                            .split(' ')
                            .map(|n| n.parse().expect("a number"))
                            .collect();
                        size = [numbers[2], numbers[3]];
                    }
                    "path" => {
                        let data = attribute("d").expect("paths have data");
                        let numbers = data
                            .split(|c: char| c.is_ascii_alphabetic() || c == ' ')
                            .filter(|n| !n.is_empty());
                        for (index, number) in numbers.enumerate() {
                            let number: f64 = number.parse().expect("a number");
                            // Control points of curves may lie outside them, by less than the margin.
                            assert!(number >= 0.0 && number <= size[index % 2], "{name}: {data}");
                        }
                    }
                    "text" => {
                        let [x, y] = ["x", "y"].map(|key| value(key).expect("it has a place"));
                        let width = value("textLength").expect("it has a width");
                        // Capitals are 8.6 high.
                        labels.push(Label {
                            text: String::new(),
                            x: [x, x + width],
                            y: [y - 8.6, y],
                        });
                        assert!(
                            x >= 0.0 && x + width <= size[0] && y >= 8.6 && y <= size[1],
                            "{name}"
                        );
                    }
                    _ => {}
                }
            }
            Event::Text(text) if open => {
                labels.last_mut().expect("a text is open").text = text.to_string();
                open = false;
            }
            _ => {}
        }
    }
    labels
}

fn check_apart(name: &str, labels: &[Label]) {
    for (index, a) in labels.iter().enumerate() {
        for b in &labels[..index] {
            let apart = [(a.x, b.x), (a.y, b.y)]
                .iter()
                .any(|(p, q)| p[1] <= q[0] || q[1] <= p[0]);
            assert!(apart, "{name}: {} and {}", a.text, b.text);
        }
    }
}

#[test]
fn pictures_are_whole_and_labels_apart() {
    for name in stems("mechanisms", "toml") {
        let labels = check_picture(&name, &picture(&name));
        let mechanism = shipped(&name);
        let bodies = mechanism.bodies.iter().map(|body| &body.name);
        let drivers = mechanism.drivers.iter().map(|driver| &driver.name);
        for wanted in bodies.chain(drivers) {
            assert!(
                labels.iter().any(|label| label.text == *wanted),
                "{name}: {wanted}"
            );
        }
        check_apart(&name, &labels);
    }
}

#[test]
fn the_gallery_shows_what_is_drawn() {
    let names = stems("mechanisms", "toml");
    assert_eq!(
        stems("mechanisms/pictures", "svg"),
        names,
        "run `make refresh`"
    );
    let page = std::fs::read_to_string(folder("mechanisms/README.md")).unwrap_or_default();
    for name in names {
        let path = folder("mechanisms/pictures").join(format!("{name}.svg"));
        let kept = std::fs::read_to_string(path).unwrap_or_default();
        assert!(
            picture(&name) == kept,
            "the picture of {name} has changed: run `make refresh` and look at mechanisms/pictures/{name}.svg"
        );
        assert!(
            page.contains(&format!("]({name}.toml)"))
                && page.contains(&format!("(pictures/{name}.svg)")),
            "{name}: run `make refresh`"
        );
    }
}

#[test]
fn the_gallery_lists_nothing_else() {
    let names = stems("mechanisms", "toml");
    let page = std::fs::read_to_string(folder("mechanisms/README.md")).unwrap_or_default();
    let listed: Vec<&str> = page
        .split("](")
        .skip(1)
        .filter_map(|rest| rest.split(')').next())
        .filter_map(|link| link.strip_suffix(".toml"))
        .collect();
    assert_eq!(listed, names, "run `make refresh`");
}

#[test]
fn large_and_small_mechanisms_look_alike() {
    let text = std::fs::read_to_string(folder("mechanisms/pendulum.toml")).expect("it is shipped");
    assert!(text.contains("value = 0.5") && text.contains("[0.1, -0.2"));
    let large = text
        .replace("value = 0.5", "value = 500")
        .replace("[0.1, -0.2", "[100, -200");
    let draw = |text: &str| {
        let (mut solver, _) = assembled(&parse(text));
        let scene = Scene::new(&mut solver, true);
        svg::write(&Sheet::new(&scene, &solver.pose().q), WIDTH, false)
    };
    let (small, large) = (draw(&text), draw(&large));
    // The two lengths have units of different width.
    let body = |svg: &str| svg[..svg.rfind("<text").expect("the scale is last")].to_owned();
    assert_eq!(body(&small), body(&large));
    assert!(small.contains(">200 mm<") && large.contains(">200 m<"));
}

#[test]
fn pngs_have_their_size_and_are_the_same_each_time() {
    let (mut solver, _) = assembled(&shipped("four_bar"));
    let scene = Scene::new(&mut solver, true);
    let sheet = Sheet::new(&scene, &solver.pose().q);
    let picture = png::write(&sheet, 320, false).expect("it has a size");
    assert_eq!(&picture[..8], b"\x89PNG\r\n\x1a\n");
    let width = u32::from_be_bytes(picture[16..20].try_into().expect("four bytes"));
    assert_eq!(width, 320);
    assert!(picture == png::write(&sheet, 320, false).expect("it has a size"));
    assert!(picture != png::write(&sheet, 320, true).expect("it has a size"));
    assert_eq!(png::write(&sheet, 0, false), None);
    assert_eq!(png::write(&sheet, png::MOST_PIXELS + 1, false), None);
}

/// A chart of lines in several panels, with gaps, noise and long names.
fn chart() -> Chart {
    let at: Vec<f64> = (0..=4000).map(|k| f64::from(k) / 1000.0).collect();
    let line = |name: &str, look, f: &dyn Fn(f64) -> f64| Line {
        name: name.to_owned(),
        look,
        values: at.iter().map(|t| f(*t)).collect(),
    };
    let axis = |label: &str, unit: &str| Axis {
        label: label.to_owned(),
        unit: unit.to_owned(),
    };
    let many = (0..9).map(|k| {
        line(&format!("a_body_with_a_long_name_{k}.x"), k, &|t| {
            t + k as f64
        })
    });
    Chart {
        title: "chart".to_owned(),
        description: String::new(),
        x: axis("time", "s"),
        panels: vec![
            Panel {
                y: axis("position", "m"),
                lines: many.collect(),
            },
            Panel {
                y: axis("angle", "deg"),
                lines: vec![
                    line("turn", 0, &|t| 360.0 * t),
                    line("gap", 1, &|t| 1.0 / (t - 2.0).max(0.0)),
                ],
            },
            Panel {
                y: axis("acceleration", "m/s²"),
                lines: vec![line("noise", 2, &|t| 1e-13 * (50.0 * t).sin())],
            },
            Panel {
                y: axis("angular acceleration", "deg/s²"),
                lines: vec![line("large", 2, &|t| -2.5e6 * t)],
            },
        ],
        at,
    }
}

#[test]
fn charts_are_whole_and_labels_apart() {
    let svg = svg::write(&Sheet::chart(&chart()), WIDTH, false);
    let labels = check_picture("chart", &svg);
    check_apart("chart", &labels);
    for wanted in [
        "position [m]",
        "a_body_with_a_long_name_8.x",
        "angle [deg]",
        "1440",
        "acceleration [m/s²]",
        "angular acceleration [1e6 deg/s²]",
        "-10",
        "time [s]",
    ] {
        assert!(labels.iter().any(|label| label.text == wanted), "{wanted}");
    }
    assert!(png::write(&Sheet::chart(&chart()), WIDTH, false).is_some());
}

#[test]
fn lines_of_a_chart_are_where_their_values_are() {
    let svg = svg::write(&Sheet::chart(&chart()), WIDTH, false);
    let labels = check_picture("chart", &svg);
    // Grid lines lie at the middle of their numbers' height, capitals being 8.6 high.
    let place = |text: &str| {
        let label = labels.iter().find(|label| label.text == text);
        label.map(|label| {
            (
                0.5 * (label.x[0] + label.x[1]),
                0.5 * (label.y[0] + label.y[1]),
            )
        })
    };
    let (_, top) = place("1440").expect("it is a tick");
    let start = svg.find("class=\"curves\"").expect("there are curves");
    let data = svg[start..]
        .split("<path d=\"")
        .nth(10)
        .expect("the line `turn` is the tenth");
    let data = &data[..data.find('"').expect("it ends")];
    let points: Vec<[f64; 2]> = data
        .split(['M', 'L'])
        .filter(|point| !point.is_empty())
        .map(|point| {
            let mut numbers = point.split(' ').map(|n| n.parse().expect("a number"));
            [numbers.next(), numbers.next()].map(|n| n.expect("two numbers"))
        })
        .collect();
    let [first, last] = [points[0], points[points.len() - 1]];
    // Numbers have two decimals.
    assert!((last[1] - top).abs() < 0.02, "{last:?} {top}");
    assert!((place("4.0").expect("a tick").0 - last[0]).abs() < 10.0);
    for point in &points {
        let part = (point[0] - first[0]) / (last[0] - first[0]);
        let expected = first[1] + part * (last[1] - first[1]);
        assert!((point[1] - expected).abs() < 0.02, "{point:?}");
    }
    // Where a value is infinite the line has a gap: it starts once, in the middle.
    let gap = svg[start..]
        .split("<path d=\"")
        .nth(11)
        .expect("it is the eleventh");
    let begin: f64 = gap[1..gap.find(' ').expect("a number ends")]
        .parse()
        .expect("a number");
    assert!(begin > 0.5 * (first[0] + last[0]));
}

/// A row of bars on pins, the first driven, each turning with the one before.
fn row(count: usize) -> String {
    let mut ground = String::from("[ground.markers]\n");
    let mut rest = String::new();
    for k in 0..count {
        ground += &format!("O{k} = [{}, 0]\n", 0.2 * k as f64);
        rest += &format!(
            "[bodies.b{k}]\nmarkers = {{ O = [0, 0], A = [0.1, 0] }}\n\
             [joints.j{k}]\ntype = 'revolute'\nmarkers = ['ground.O{k}', 'b{k}.O']\n"
        );
        if let Some(before) = k.checked_sub(1) {
            rest += &format!(
                "[constraints.c{k}]\ncoordinate = 'angle'\n\
                 markers = ['b{before}.O', 'b{k}.O']\nvalue = 0\n"
            );
        }
    }
    format!(
        "format = 1\nname = 'row'\n{ground}{rest}[drivers.d]\ncoordinate = 'angle'\n\
         markers = ['ground.O0', 'b0.O']\nstart = 0.3\n"
    )
}

#[test]
fn the_names_of_very_many_bodies_are_left_out() {
    for (count, named) in [(60, true), (61, false)] {
        let (mut solver, _) = assembled(&parse(&row(count)));
        let scene = Scene::new(&mut solver, false);
        let picture = svg::write(&Sheet::new(&scene, &solver.pose().q), WIDTH, false);
        assert_eq!(picture.contains(">b59<"), named, "{count}");
        assert!(picture.contains(">d<"));
        check_apart("row", &check_picture("row", &picture));
    }
}

#[test]
fn long_chains_get_room_for_their_bars_and_names() {
    let (mut solver, _) = assembled(&parse(&chain(20, Ground::Straight)));
    let scene = Scene::new(&mut solver, false);
    let sheet = Sheet::new(&scene, &solver.pose().q);
    assert!(sheet.width() > WIDTH, "{}", sheet.width());
    let picture = svg::write(&sheet, sheet.width(), false);
    let labels = check_picture("chain", &picture);
    check_apart("chain", &labels);
    for body in &solver.mechanism().bodies {
        assert!(labels.iter().any(|l| l.text == body.name), "{}", body.name);
    }
    // Where there is no room the names of bodies give way, not that of the driver.
    let sheet = Sheet::small(&scene, &solver.pose().q);
    let labels = check_picture("chain", &svg::write(&sheet, sheet.width(), false));
    check_apart("chain", &labels);
    assert!(labels.iter().any(|label| label.text == "crank_angle"));
    // A mechanism of few bodies needs no more than usual.
    let (mut solver, _) = assembled(&shipped("four_bar"));
    let scene = Scene::new(&mut solver, false);
    assert_eq!(Sheet::new(&scene, &solver.pose().q).width(), WIDTH);
}
