//! Parameters that move take the mechanism along.

use crate::common::{assembled, parse, shipped};
use crate::stepping::{SAME_POSE, difference};

#[test]
fn parameters_move_the_mechanism_continuously() {
    let mechanism = shipped("four_bar");
    let (mut solver, mut path) = assembled(&mechanism);
    let rocker = mechanism
        .parameter_id("rocker_length")
        .expect("it is in the file");
    path.to[rocker.index()] = 0.35;
    solver.track(&path).expect("a longer rocker closes as well");
    // The same mechanism, written with the longer rocker.
    let text = std::fs::read_to_string("mechanisms/four_bar.toml")
        .expect("it is shipped")
        .replace("value = 0.30", "value = 0.35");
    let (longer, _) = assembled(&parse(&text));
    assert!(difference(&solver.pose().q, &longer.pose().q) < SAME_POSE);
    assert_eq!(solver.pose().parameters, longer.pose().parameters);
}

/// A platform on three legs of held lengths, of which markers on ground and on the platform move.
/// The truth is the same path in tiny parts.
#[test]
fn parameters_of_a_coupled_block_keep_to_the_motion() {
    let mechanism = parse(
        "format = 1\nname = 'platform'\n[parameters]\n\
         ax1 = { value = -0.07223632809180103, tunable = true }\n\
         bx1 = { value = -2.0114817526932045, tunable = true }\n\
         [ground.markers]\nA0 = [-1.0866542967255155, 1.0289542987520632]\n\
         A1 = ['ax1', 1.9191844705871113]\nA2 = [1.8960046370176933, -0.632748805538845]\n\
         [bodies.p]\nmarkers = { B0 = [-0.0031255749362728014, -1.4014883191453933], \
         B1 = ['bx1', -0.12565325423701357], B2 = [-0.16717283627790813, 1.775573902857885] }\n\
         estimate = [0.4445476906170683, 0.1519500280064077, -1.2986763296839756]\n[drivers]\n\
         u0 = { coordinate = 'distance', markers = ['ground.A0', 'p.B0'], \
         start = 1.2636272543926257 }\n\
         u1 = { coordinate = 'distance', markers = ['ground.A1', 'p.B1'], \
         start = 0.19902556736581078 }\n\
         u2 = { coordinate = 'distance', markers = ['ground.A2', 'p.B2'], \
         start = 1.4389280532955118 }\n",
    );
    let target = [-0.4471217504207009, -1.8663575853641738];
    let follow = |parts: u32| {
        let (mut solver, mut path) = assembled(&mechanism);
        let from = path.from.clone();
        for part in 1..=parts {
            let s = f64::from(part) / f64::from(parts);
            path.from.copy_from_slice(&path.to);
            for (to, (from, target)) in path.to.iter_mut().zip(from.iter().zip(target)) {
                *to = from + s * (target - from);
            }
            solver.track(&path).expect("the platform follows");
        }
        solver.pose().q.clone()
    };
    let (whole, truth) = (follow(1), follow(2000));
    assert!(difference(&whole, &truth) < 1e-9, "{whole:?} {truth:?}");
    assert!((truth[0] + 0.0435).abs() < 1e-4, "{truth:?}");
}

/// A length runs until links line up, and back, as a driver does.
#[test]
fn a_parameter_comes_back_from_a_dead_point() {
    let mechanism = shipped("jansen_leg");
    for (name, far) in [
        ("m", 0.1),
        ("j", 0.2),
        ("k", 0.2),
        ("a", 0.2),
        ("b", 0.12),
        ("f", 0.2),
    ] {
        let (mut solver, mut path) = assembled(&mechanism);
        let home = solver.pose().clone();
        let index = mechanism.parameter_id(name).expect("it has it").index();
        path.to[index] = far;
        solver.track(&path).expect_err("links line up");
        path.from.clone_from(&solver.pose().parameters);
        path.to.clone_from(&home.parameters);
        let back = solver.track(&path);
        assert!(back.is_ok(), "{name}: {back:?}");
        let off = difference(&solver.pose().q, &home.q);
        assert!(off < SAME_POSE, "{name}: {off}");
    }
}
