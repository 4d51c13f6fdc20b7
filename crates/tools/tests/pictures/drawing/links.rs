//! Bars, pins, pivots and blocks.

use biela::mechanism::BodyId;
use biela_tools::drawing::{Scene, Symbol};

use crate::common::{assembled, shipped};
use crate::drawing::scenes::link;

#[test]
fn four_bar_has_bars_pins_and_pivots() {
    let (mut solver, _) = assembled(&shipped("four_bar"));
    let home = solver.pose().clone();
    let scene = Scene::new(&mut solver, true);
    assert_eq!(*solver.pose(), home, "the solver is back where it was");
    assert_eq!(scene.bodies, ["crank", "coupler", "rocker"]);

    let count =
        |wanted: &dyn Fn(&Symbol) -> bool| scene.symbols.iter().filter(|s| wanted(s)).count();
    for (body, corners) in [(0, 2), (1, 3), (2, 2)] {
        let link = |symbol: &Symbol| matches!(symbol, Symbol::Link(link) if link.body == BodyId(body) && link.points.len() == corners);
        assert_eq!(count(&link), 1, "body {body}");
    }
    assert_eq!(count(&|s| matches!(s, Symbol::Pin(_))), 4);
    assert_eq!(count(&|s| matches!(s, Symbol::Fixture(_))), 2);
    assert_eq!(
        count(&|s| matches!(s, Symbol::AngleDriver(driver) if driver.name == "crank_angle")),
        1
    );
    assert_eq!(
        count(&|s| matches!(s, Symbol::InterestPoint(point) if point.name == "P")),
        1
    );
    assert_eq!(count(&|s| matches!(s, Symbol::Trace(_))), 1);
    assert_eq!(scene.symbols.len(), 3 + 4 + 2 + 1 + 1 + 1);
}

#[test]
fn block_stretches_the_body_that_it_slides_on() {
    // The arm's end is between 0.15 m and 0.65 m from the barrel's pivot.
    let (mut solver, _) = assembled(&shipped("tlv_crank"));
    let scene = Scene::new(&mut solver, true);
    let longest = link(&scene, 1)
        .expect("it is drawn")
        .iter()
        .fold(0.0, |x: f64, p| x.max(p[0]));
    assert!((longest - 0.65).abs() < 1e-4);
    assert!(scene.symbols.iter().any(|s| matches!(
        s,
        Symbol::Block(block) if block.at.body == Some(BodyId(2)) && block.on == Some(BodyId(1))
    )));
}
