//! Cams and what touches them.

use biela::mechanism::BodyId;
use biela_tools::drawing::symbol::{GuideContact, SlideWay, WaySide};
use biela_tools::drawing::{Scene, Symbol};

use crate::common::folder;
use crate::drawing::scenes::{link, near, scene, scene_of};

/// Returns the cam's contour.
fn contour(scene: &Scene) -> Vec<[f64; 2]> {
    let cam = scene.symbols.iter().find_map(|s| match s {
        Symbol::Cam(cam) => Some(cam.contour.clone()),
        _ => None,
    });
    cam.expect("the cam is drawn")
}

/// Returns the guide of a follower's stem.
fn stem_guide(scene: &Scene) -> [f64; 2] {
    let guide = scene.symbols.iter().find_map(|s| match s {
        Symbol::SlideWay(SlideWay {
            range,
            side: WaySide::Both,
            contact: GuideContact::Bar,
            ..
        }) => Some(*range),
        _ => None,
    });
    guide.expect("the stem is guided")
}

#[test]
fn cam_is_its_contour_and_knife_touches_it() {
    let scene = scene("cam_knife");
    // R = 30 mm + 10 mm (1 - cos theta).
    for [x, y] in contour(&scene) {
        let radius = 0.03 + 0.01 * (1.0 - f64::atan2(y, x).cos());
        assert!(near(f64::hypot(x, y), radius));
    }
    assert_eq!(link(&scene, 0), None, "the contour shows all of the cam");
    let knife = scene.symbols.iter().find_map(|s| match s {
        Symbol::Knife(knife) => Some(knife.at),
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
fn roller_has_its_radius_and_its_guide_keeps_clear() {
    let scene = scene("cam_roller");
    assert!(scene.symbols.iter().any(|s| matches!(
        s,
        Symbol::Roller(roller)
            if roller.at.body == Some(BodyId(1)) && near(roller.radius, 0.01)
    )));
    // A slider-crank with crank 15 mm, rod 50 mm and offset 8 mm: the roller's centre gets up to
    // sqrt(65^2 - 8^2) mm, its top 10 mm higher.
    assert!(stem_guide(&scene)[0] > f64::sqrt(0.065 * 0.065 - 0.008 * 0.008) + 0.01);
    assert!(link(&scene, 1).is_some_and(|points| points.contains(&[0.0, 0.06])));
}

#[test]
fn face_spans_the_contact() {
    let faces = |scene: &Scene| -> Vec<([f64; 2], bool)> {
        let face = |s: &Symbol| match s {
            Symbol::Face(face) => Some((face.range, face.above)),
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
fn lever_with_face_keeps_its_pivot() {
    let scene = scene("cam_flat_arm");
    assert_eq!(link(&scene, 1), Some(vec![[0.0; 2]]));
    let face = scene.symbols.iter().find_map(|s| match s {
        Symbol::Face(face) => Some((face.range, face.above)),
        _ => None,
    });
    // The lever points to the left: what is below it is on its y-axis' side.
    assert_eq!(face, Some(([0.0, 0.12], true)));
}
