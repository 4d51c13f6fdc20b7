//! Wheels, belts and racks.

use biela::mechanism::BodyId;
use biela_tools::drawing::symbol::{GuideContact, SlideWay, WaySide, Wheel};
use biela_tools::drawing::{Scene, Sheet, Symbol, svg};

use crate::common::{assembled, parse};
use crate::drawing::pictures::{WIDTH, check_picture};
use crate::drawing::scenes::{near, scene, scene_of};

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
            Symbol::Wheel(Wheel {
                at,
                radius,
                ring: false,
            }) => Some((at.body.map(BodyId::index), *radius)),
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
    // A wheel or a rack shows all of its body.
    assert!(!scene.symbols.iter().any(|s| matches!(s, Symbol::Link(_))));
    // One turn moves the pinion's centre by 2 pi r along the rack.
    let rack = scene.symbols.iter().find_map(|s| match s {
        Symbol::Rack(rack) if rack.above => Some(rack.range[1] - rack.range[0]),
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

#[test]
fn rack_is_guided_along_its_back() {
    let scene = scene("rack_drive");
    let rack = scene.symbols.iter().find_map(|s| match s {
        Symbol::Rack(rack) if rack.along.body.is_some() => Some(rack.range),
        _ => None,
    });
    let [low, high] = rack.expect("it is drawn");
    let guide = scene.symbols.iter().find_map(|s| match s {
        Symbol::SlideWay(SlideWay {
            range,
            side: WaySide::Above,
            contact: GuideContact::Rack,
            ..
        }) => Some(*range),
        _ => None,
    });
    // The rack goes twice as far as the carriage, from 140 mm to 260 mm: it always is between its
    // left end at 520 mm and its right one at 280 mm. The poses, 1.5 deg of the crank apart, are
    // within 0.75 deg of the ends, where 2 * 0.06 m * (1 + 60/140) * (1 - cos 0.75 deg) is lost.
    let [from, to] = guide.expect("it is guided");
    assert!((from - (0.52 + low)).abs() < 2e-5 && (to - (0.28 + high)).abs() < 2e-5);
}
