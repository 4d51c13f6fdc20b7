//! The ways of sliding bodies.

use biela_tools::drawing::symbol::WaySide;
use biela_tools::drawing::{Scene, Symbol};

use crate::common::{assembled, shipped};
use crate::drawing::scenes::{near, scene_of};

#[test]
fn ways_are_as_long_as_the_motion() {
    // The slider goes between sqrt((rod -+ crank)^2 - offset^2).
    let (mut solver, _) = assembled(&shipped("slider_crank"));
    let scene = Scene::new(&mut solver, true);
    let way = scene.symbols.iter().find_map(|s| match s {
        Symbol::SlideWay(way) => Some((way.range, way.side)),
        _ => None,
    });
    let ([low, high], side) = way.expect("the slider is guided");
    let end = |length: f64| f64::sqrt(length * length - 0.01 * 0.01);
    // The nearest of 240 poses a turn is within 0.75° of the end: 50 mm (1 - cos 0.75°).
    assert!((low - end(0.1)).abs() < 1e-5 && (high - end(0.2)).abs() < 1e-5);
    assert_eq!(side, WaySide::Below);
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
        Symbol::SlideWay(way) => Some(way.range),
        _ => None,
    });
    let [low, high] = way.expect("the cart is guided");
    assert!(near(low, 0.0) && near(high, 0.3));
}

#[test]
fn stops_have_the_points_that_meet_them() {
    let text = r#"
        format = 1
        name = "bolt"
        [ground.markers]
        O = [0, 0]
        [bodies.bolt]
        markers = { C = [0, 0], tip = [0.3, 0], heel = [-0.1, 0] }
        mass = 1
        inertia = 1
        [joints]
        way = { type = "translational", markers = ["ground.O", "bolt.C"] }
        [freedoms]
        throw = { coordinate = "x", markers = ["ground.O", "bolt.C"], start = 0.1 }
        [stops]
        ends = { of = "throw", min = 0, max = 0.2 }
    "#;
    let scene = scene_of(text);
    let limits = scene.symbols.iter().find_map(|s| match s {
        Symbol::EndStop(stop) => Some(stop.limits),
        _ => None,
    });
    let [least, most] = limits.expect("there is a stop");
    let [(least, heel), (most, tip)] = [least, most].map(|limit| limit.expect("it is given"));
    assert!(near(least, 0.0) && near(most, 0.2));
    assert!(near(heel.position[0], -0.1) && near(tip.position[0], 0.3));
}
