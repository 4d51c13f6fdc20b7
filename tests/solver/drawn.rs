//! Slips of coordinates: markers of a joint that were drawn apart.

use std::sync::Arc;

use biela::kinematics::{Path, Solver};
use biela::mechanism::Mechanism;

use crate::common::{parse, shipped};

/// A hinge that is drawn in one pose.
const DRAWN: &str = r#"
format = 1
name = "hinge"
[ground.markers]
A = [0, 0]
B = [0.14, 0.05]
[bodies]
rear = { markers = { A = [0, 0], C = [-0.02, 0.18] } }
front = { markers = { B = [0.14, 0.05], D = [0.16, 0.19] } }
bonnet = { markers = { C = [-0.02, 0.18], D = [0.16, 0.19] } }
[joints]
A = { type = "revolute", markers = ["ground.A", "rear.A"] }
B = { type = "revolute", markers = ["ground.B", "front.B"] }
C = { type = "revolute", markers = ["rear.C", "bonnet.C"] }
D = { type = "revolute", markers = ["front.D", "bonnet.D"] }
[drivers]
opening = { coordinate = "angle", markers = ["ground.A", "rear.A"], start = 0 }
"#;

/// A crank that turns a yoke, with frames at their own points and without estimates.
const AT_PINS: &str = r#"
format = 1
name = "yoke"
[ground.markers]
O = [0, 0]
guide = [0, 0]
[bodies]
crank = { markers = { O = [0, 0], A = [0.1, 0] } }
yoke = { markers = { guide = [0, 0], slot = [0, 0, "90*deg"] } }
[joints]
O = { type = "revolute", markers = ["ground.O", "crank.O"] }
guide = { type = "translational", markers = ["ground.guide", "yoke.guide"] }
slot = { type = "slot", markers = ["yoke.slot", "crank.A"] }
[drivers]
turn = { coordinate = "angle", markers = ["ground.O", "crank.O"], start = 0.5 }
"#;

fn warnings(mechanism: &Arc<Mechanism>) -> Vec<String> {
    let path = Path::new(mechanism);
    let solver = Solver::assembled(Arc::clone(mechanism), &path).expect("it closes");
    let apart = solver.drawn_apart();
    apart.iter().map(ToString::to_string).collect()
}

#[test]
fn a_slip_in_a_drawing_is_told_with_its_distance() {
    assert!(warnings(&parse(DRAWN)).is_empty());
    // A drawing is measured to a millimetre.
    assert!(
        warnings(&parse(
            &DRAWN.replace("0.19] } }\nbonnet", "0.191] } }\nbonnet")
        ))
        .is_empty()
    );
    let slip = DRAWN.replace("0.19] } }\nbonnet", "0.28] } }\nbonnet");
    assert_eq!(
        warnings(&parse(&slip)),
        ["`front.D` and `bonnet.D` were drawn 90.00 mm apart: a slip in a coordinate?"]
    );
    // The bonnet on a pin of its own that slides on the car: its line is 40 mm above the pin.
    let sliding = DRAWN
        .replace("B = [0.14, 0.05]\n", "B = [0.14, 0.05]\nrail = [0, 0.23]\n")
        .replace(
            "front = { markers = { B = [0.14, 0.05], D = [0.16, 0.19] } }\n",
            "",
        )
        .replace(
            "B = { type = \"revolute\", markers = [\"ground.B\", \"front.B\"] }\n",
            "",
        )
        .replace(
            "\"revolute\", markers = [\"front.D\"",
            "\"slot\", markers = [\"ground.rail\"",
        );
    assert_eq!(
        warnings(&parse(&sliding)),
        ["`bonnet.D` was drawn 40.00 mm off the line of `ground.rail`: a slip in a coordinate?"]
    );
}

#[test]
fn frames_at_pins_and_rough_estimates_are_no_slips() {
    assert!(warnings(&parse(AT_PINS)).is_empty());
    for name in [
        "drag_link",
        "four_bar",
        "scotch_yoke",
        "wiper",
        "garage_door_track",
    ] {
        assert!(warnings(&shipped(name)).is_empty(), "{name}");
    }
}
