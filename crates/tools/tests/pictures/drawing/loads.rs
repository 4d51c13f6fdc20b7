//! Loads, springs and dampers.

use biela_tools::drawing::symbol::{LoadArrow, Torsion};
use biela_tools::drawing::{Scene, Sheet, Symbol, svg};

use crate::common::{assembled, parse};
use crate::drawing::pictures::{WIDTH, check_picture};
use crate::drawing::scenes::{near, scene, scene_of};

/// A slider along a line at 30°, with a lever on it.
const LOADED: &str = r#"
    format = 1
    name = "loaded"
    [ground.markers]
    O = [0, 0, "30*deg"]
    [bodies.slider]
    markers = { A = [0, 0], B = [0, 0.1] }
    estimate = [0.2, 0.1, "30*deg"]
    [bodies.lever]
    markers = { A = [0, 0], tip = [0.3, 0] }
    estimate = [0.2, 0.1, 0]
    [joints]
    way = { type = "translational", markers = ["ground.O", "slider.A"] }
    A = { type = "revolute", markers = ["slider.A", "lever.A"] }
    [drivers]
    travel = { coordinate = "x", markers = ["ground.O", "slider.A"], start = 0.2 }
    swing = { coordinate = "angle", markers = ["ground.O", "lever.A"], start = "40*deg" }
    [forces]
"#;

/// Returns the arrows of the load of one line in `[forces]`.
fn arrows(load: &str) -> Option<(Vec<[f64; 2]>, f64)> {
    let scene = scene_of(&format!("{LOADED}load = {{ {load} }}"));
    scene.symbols.into_iter().find_map(|symbol| match symbol {
        Symbol::LoadArrow(LoadArrow { arrows, turn, .. }) => Some((arrows, turn)),
        _ => None,
    })
}

#[test]
fn arrows_point_along_their_loads() {
    let at_tip = |more: &str| arrows(&format!("marker = 'lever.tip'{more}"));
    for (more, expected, turn) in [
        (", value = [3, -4]", vec![[0.6, -0.8]], 0.0),
        // It rises from zero.
        (", value = [0, '-5*t']", vec![[0.0, -1.0]], 0.0),
        (", torque = -2", vec![], -1.0),
        (", value = [1, 0], torque = 2", vec![[1.0, 0.0]], 1.0),
        // Inputs have their positive senses.
        ("", vec![[1.0, 0.0], [0.0, 1.0]], 1.0),
    ] {
        let (found, turning) = at_tip(more).expect("it has a symbol");
        assert!(near(turning, turn), "{more}");
        assert_eq!(found.len(), expected.len(), "{more}");
        for (found, expected) in found.into_iter().zip(expected) {
            let near = near(found[0], expected[0]) && near(found[1], expected[1]);
            assert!(near, "{more}: {found:?}");
        }
    }
    assert_eq!(at_tip(", value = [0, 0]"), None);
    let along = |kind: &str, more: &str| {
        let ends = match kind {
            "x" => "['ground.O', 'slider.A']",
            _ => "['ground.O', 'lever.A']",
        };
        arrows(&format!("coordinate = '{kind}', markers = {ends}{more}"))
    };
    let forwards = Some((vec![[1.0, 0.0]], 0.0));
    let backwards = Some((vec![[-1.0, 0.0]], 0.0));
    assert_eq!(along("x", ""), forwards);
    assert_eq!(along("x", ", value = -7"), backwards);
    // A spring by its law, which is stretched; a drag, which is zero at rest.
    assert_eq!(along("x", ", value = '10*(0.1 - position)'"), backwards);
    assert_eq!(along("x", ", value = '-4*velocity'"), backwards);
    assert_eq!(along("angle", ""), Some((vec![], 1.0)));
    assert_eq!(along("angle", ", value = -1"), Some((vec![], -1.0)));
    assert_eq!(along("angle", ", stiffness = 3, free = 0"), None);
}

#[test]
fn springs_and_dampers_of_angles_have_symbols() {
    let between = "coordinate = 'angle', markers = ['ground.O', 'lever.A']";
    for (law, expected) in [
        ("stiffness = 3, free = 0", [true, false]),
        ("damping = 1", [false, true]),
        ("stiffness = 3, free = 0, damping = 1", [true, true]),
    ] {
        let scene = scene_of(&format!("{LOADED}load = {{ {between}, {law} }}"));
        let found = scene.symbols.iter().find_map(|symbol| match symbol {
            Symbol::Torsion(Torsion {
                is_elastic,
                is_damped,
                ..
            }) => Some([*is_elastic, *is_damped]),
            _ => None,
        });
        assert_eq!(found, Some(expected), "{law}");
    }
}

#[test]
fn pictures_of_loads_are_whole() {
    let text = format!(
        "{LOADED}
        weight = {{ marker = 'lever.tip', value = [0, -5] }}
        hand = {{ marker = 'slider.B', axes = 'lever.tip' }}
        push = {{ coordinate = 'x', markers = ['ground.O', 'slider.A'], value = -3 }}
        motor = {{ coordinate = 'angle', markers = ['ground.O', 'lever.A'] }}
        coil = {{ coordinate = 'angle', markers = ['slider.A', 'lever.A'], stiffness = 3, free = 0, damping = 1 }}"
    );
    let (mut solver, _) = assembled(&parse(&text));
    let scene = Scene::new(&mut solver, true);
    let picture = svg::write(&Sheet::new(&scene, &solver.pose().q), WIDTH, false);
    let labels = check_picture("loaded", &picture);
    for name in ["weight", "hand"] {
        assert!(labels.iter().any(|label| label.text == name), "{name}");
    }
    assert!(picture.contains("class=\"forces\""));
}

#[test]
fn loads_of_shipped_mechanisms_are_shown() {
    for (name, expected) in [
        ("excavator_arm", [0.0, -1.0]),
        // The gas presses the piston towards the crank, the work holds the ram back.
        ("engine", [-1.0, 0.0]),
        ("toggle_press", [-1.0, 0.0]),
    ] {
        let scene = scene(name);
        let found = scene.symbols.iter().find_map(|symbol| match symbol {
            Symbol::LoadArrow(load) => load.arrows.first().copied(),
            _ => None,
        });
        let [x, y] = found.expect("it has an arrow");
        assert!(near(x, expected[0]) && near(y, expected[1]), "{name}");
    }
}
