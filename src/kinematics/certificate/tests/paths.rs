//! Random paths with steps between 0.001° and 179°: a step always ends on the branch of tiny steps,
//! and no step on a regular path is blocked.

use std::f64::consts::{PI, TAU};

use proptest::prelude::*;

use super::shipped;
use crate::kinematics::reference::{Part, assembled, grown, part};
use crate::kinematics::{DriverPath, Path, Solver};
use crate::mechanism::{Mechanism, Source};

/// Length of a tiny step, in radians or characteristic lengths.
const TINY: f64 = 0.01;
/// Reciprocal condition above which no step may be blocked.
const REGULAR: f64 = 1e-6;

/// A step of the drivers: the move of every second one, and the ratio of the others to it.
#[derive(Clone, Copy, Debug)]
struct Step {
    way: f64,
    share: f64,
}

/// Draws steps from 0.001° to 179°, logarithmically distributed.
fn step() -> impl Strategy<Value = Step> {
    (-3.0..2.2528_f64, -1.0..1.0_f64, any::<bool>()).prop_map(|(power, share, back)| {
        let way = 10_f64.powf(power).to_radians();
        Step {
            way: if back { -way } else { way },
            share,
        }
    })
}

fn set_targets(solver: &Solver, path: &mut Path, targets: &[f64]) {
    path.start = solver.pose().time;
    path.duration = 0.0;
    let drivers = targets.iter().zip(&solver.pose().drivers);
    for (driver_path, (target, now)) in path.driver_paths.iter_mut().zip(drivers) {
        *driver_path = DriverPath::Input {
            position: *target,
            velocity: 0.0,
            acceleration: 0.0,
            jump: now - target,
        };
    }
}

/// Counts of a run of large and tiny steps side by side.
#[derive(Clone, Copy, Debug, Default)]
struct Met {
    steps: u32,
    dead_points: u32,
    substeps: u32,
}

/// Takes each step at once with one solver, and by tiny steps with the other.
fn track_both(
    solver: &mut Solver,
    other: &mut Solver,
    steps: &[Step],
    scale: f64,
    what: &str,
) -> Met {
    let mut path = Path::new(solver.mechanism());
    let mut met = Met::default();
    for step in steps {
        let from = solver.pose().drivers.clone();
        other.restore(&solver.pose().clone());
        let mut targets = from.clone();
        for (k, target) in targets.iter_mut().enumerate() {
            *target += scale * step.way * if k % 2 == 0 { 1.0 } else { step.share };
        }
        let mut regular = true;
        let mut blocked = false;
        let count = (step.way.abs() / TINY).ceil();
        for part in 1..=count as u32 {
            let s = f64::from(part) / count;
            let now: Vec<_> = from
                .iter()
                .zip(&targets)
                .map(|(a, b)| a + s * (b - a))
                .collect();
            set_targets(other, &mut path, &now);
            if other.track(&path).is_err() {
                blocked = true;
                break;
            }
            regular &= other.rcond() > REGULAR;
        }
        set_targets(solver, &mut path, &targets);
        let home = solver.pose().clone();
        let large = solver.track(&path);
        met.steps += 1;
        match large {
            Ok(progress) => {
                assert!(
                    !blocked,
                    "{what}: {step:?} passed what tiny steps cannot, from {from:?}"
                );
                met.substeps += progress.substeps;
                // Both are at rounding, times the condition; turns make it larger.
                let tolerance = 1e-9 / other.rcond().max(1e-4);
                for (large, tiny) in solver.pose().q.iter().zip(&other.pose().q) {
                    assert!(
                        (large - tiny).abs() < tolerance,
                        "{what}: {step:?} from {from:?}"
                    );
                }
            }
            Err(refused) => {
                assert!(
                    blocked || !regular,
                    "{what}: {step:?} from {from:?}: {refused:?}"
                );
                met.dead_points += 1;
                solver.restore(&home);
            }
        }
    }
    met
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// Four-bars, slider-cranks, swivels and geared wheels, one behind another.
    #[test]
    fn random_mechanisms_keep_their_branch(
        parts in prop::collection::vec(part(), 1..3),
        steps in prop::collection::vec(step(), 1..8),
    ) {
        let text = grown(&parts);
        let (mechanism, _) = Mechanism::parse(&Source::new("grown", &text)).expect("it has no errors");
        let path = Path::new(&mechanism);
        let mechanism = std::sync::Arc::new(mechanism);
        let mut solver = Solver::new(mechanism.clone()).expect("the drivers match");
        // Some of them do not close.
        prop_assume!(solver.assemble(&path).is_ok());
        let mut other = Solver::new(mechanism).expect("the drivers match");
        let met = track_both(&mut solver, &mut other, &steps, 1.0, &text);
        // Half a turn takes a few dozen sub-steps, rejected ones included; more near a singular
        // position.
        prop_assert!(met.substeps < 200 * met.steps, "{met:?}");
    }

    #[test]
    fn shipped_mechanisms_keep_their_branch(
        index in 0..5_usize,
        steps in prop::collection::vec(step(), 1..4),
    ) {
        let (name, scale) = [
            ("five_bar_robot", 0.3), ("stephenson_six_bar", 1.0), ("cam_knife", 1.0),
            ("cam_flat_arm", 0.3), ("excavator_arm", 0.02),
        ][index];
        let source = shipped().find(|source| source.name() == name).expect("it is shipped");
        let (mut solver, _) = assembled(&source);
        let (mut other, _) = assembled(&source);
        track_both(&mut solver, &mut other, &steps, scale, name);
    }

}

proptest! {
    #![proptest_config(ProptestConfig { max_global_rejects: 4000, ..ProptestConfig::with_cases(600) })]

    /// Any four-bar that closes agrees with its closed form: the distance from the crank's pin to
    /// the rocker's pivot stays between the difference and the sum of coupler and rocker.
    #[test]
    fn random_four_bars_agree_with_the_closed_form(
        lengths in prop::array::uniform4(0.1..1.0_f64),
        start in 0.0..TAU,
        up in any::<bool>(),
        steps in prop::collection::vec(step(), 1..12),
    ) {
        let [crank, coupler, rocker, base] = lengths;
        let distance = |angle: f64| (base - crank * angle.cos()).hypot(crank * angle.sin());
        let closes = |distance: f64, margin: f64| {
            distance < (coupler + rocker) * (1.0 - margin)
                && distance > (coupler - rocker).abs() + margin * (coupler + rocker)
        };
        prop_assume!(closes(distance(start), 1e-3));
        // phi of coupler and rocker.
        let exact = |angle: f64| {
            let span = distance(angle);
            let leaning = (-crank * angle.sin()).atan2(base - crank * angle.cos());
            let cosine = (span * span + coupler * coupler - rocker * rocker) / (2.0 * span * coupler);
            let opening = cosine.clamp(-1.0, 1.0).acos();
            let phi = leaning + if up { opening } else { -opening };
            let tip = [
                crank * angle.cos() + coupler * phi.cos() - base,
                crank * angle.sin() + coupler * phi.sin(),
            ];
            [phi, tip[1].atan2(tip[0])]
        };
        let [phi, psi] = exact(start);
        let [x, y] = [crank * start.cos(), crank * start.sin()];
        let text = format!(
            "format = 1\nname = 'four_bar'\n[ground.markers]\nO = [0, 0]\nQ = [{base}, 0]\n\
             [bodies.crank]\nmarkers = {{ O = [0, 0], A = [{crank}, 0] }}\nestimate = [0, 0, {start}]\n\
             [bodies.coupler]\nmarkers = {{ A = [0, 0], B = [{coupler}, 0] }}\n\
             estimate = [{x}, {y}, {phi}]\n\
             [bodies.rocker]\nmarkers = {{ O = [0, 0], B = [{rocker}, 0] }}\n\
             estimate = [{base}, 0, {psi}]\n[joints]\n\
             O = {{ type = 'revolute', markers = ['ground.O', 'crank.O'] }}\n\
             A = {{ type = 'revolute', markers = ['crank.A', 'coupler.A'] }}\n\
             B = {{ type = 'revolute', markers = ['coupler.B', 'rocker.B'] }}\n\
             Q = {{ type = 'revolute', markers = ['ground.Q', 'rocker.O'] }}\n[drivers]\n\
             u = {{ coordinate = 'angle', markers = ['ground.O', 'crank.O'], start = {start} }}\n"
        );
        let (mut solver, mut path) = assembled(&Source::new("four-bar", &text));
        for step in steps {
            let now = solver.pose().drivers[0];
            let target = now + step.way;
            // The distance has its extremes at the ends and where crank and base line up.
            let [low, high] = [now.min(target), now.max(target)];
            let lined_up = (0..).map(|k| ((low / PI).ceil() + f64::from(k)) * PI);
            let places = lined_up.take_while(|angle| *angle < high).chain([target]);
            let (mut open, mut near) = (false, false);
            for angle in places {
                open |= !closes(distance(angle), 0.0);
                near |= !closes(distance(angle), 1e-10);
            }
            let home = solver.pose().clone();
            set_targets(&solver, &mut path, &[target]);
            match solver.track(&path) {
                Ok(progress) => {
                    prop_assert!(!open || near, "passed a dead point: {step:?} from {now}");
                    let away = exact(target);
                    for (found, exact) in [solver.pose().q[5], solver.pose().q[8]].iter().zip(away) {
                        let off = (found - exact) / TAU;
                        // The closed form loses half of its digits at a limit.
                        prop_assert!((off - off.round()).abs() < 1e-6, "{step:?} from {now}");
                    }
                    prop_assert!(progress.substeps < 300, "{progress:?}");
                }
                Err(blocked) => {
                    prop_assert!(open || near, "{step:?} from {now}: {blocked:?}");
                    solver.restore(&home);
                }
            }
        }
    }
}

/// Every kind of part of the random mechanisms takes large steps.
#[test]
fn each_kind_of_part_takes_large_steps() {
    for kind in 0..4 {
        let parts = [Part {
            kind,
            size: 0.4,
            frame: 0.1,
        }];
        let (mut solver, _) = assembled(&Source::new("grown", grown(&parts)));
        let (mut other, _) = assembled(&Source::new("grown", grown(&parts)));
        let steps = [2.9, -3.1, 1.7, 0.4, 3.0].map(|way| Step { way, share: 1.0 });
        let met = track_both(
            &mut solver,
            &mut other,
            &steps,
            1.0,
            &format!("kind {kind}"),
        );
        assert!(met.substeps >= 5, "kind {kind}: {met:?}");
    }
}
