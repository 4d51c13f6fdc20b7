//! Free motion ends at stops.

use biela::dynamics::Error;

use super::run::{Fed, Run};
use crate::common::parse;

/// A weight that falls, or is thrown up at 3 m/s, between a floor and a ceiling.
fn weight(stops: &str, velocity: f64) -> String {
    format!(
        r#"
format = 1
name = "weight"
[ground.markers]
O = [0, 0, "90*deg"]
[bodies.weight]
mass = 2
markers = {{ P = [0, 0, "90*deg"] }}
[joints]
guide = {{ type = "translational", markers = ["ground.O", "weight.P"] }}
[freedoms]
height = {{ coordinate = "x", markers = ["ground.O", "weight.P"], start = 0, velocity = {velocity} }}
[stops]
{stops}
"#
    )
}

/// Two weights of 1 kg on one guide, joined by a spring: two freedoms, whose motion is that of its
/// middle and of the spring.
const PAIR: &str = r#"
format = 1
name = "pair"
[ground.markers]
O = [0, 0]
[bodies.a]
mass = 1
markers = { P = [0, 0] }
[bodies.b]
mass = 1
estimate = [1.2, 0, 0]
markers = { P = [0, 0] }
[joints]
left = { type = "translational", markers = ["ground.O", "a.P"] }
right = { type = "translational", markers = ["ground.O", "b.P"] }
[forces]
spring = { coordinate = "distance", markers = ["a.P", "b.P"], stiffness = 50, free = 1 }
[freedoms]
x_a = { coordinate = "x", markers = ["ground.O", "a.P"], start = 0, velocity = 0.3 }
x_b = { coordinate = "x", markers = ["ground.O", "b.P"], start = 1.2, velocity = 0.3 }
[stops]
wall = { of = "x_b", max = 1.5 }
[simulation]
gravity = [0, 0]
"#;

fn ends_at(text: &str, until: f64, name: &str, instant: f64) {
    for steps in [1, 37] {
        let mut run = Run::new(&parse(text), 1e-10, Fed::default());
        let stop = (1..=steps)
            .find_map(|step| run.try_to(until * f64::from(step) / f64::from(steps)).err());
        let Some(Error::Stop { limit, time }) = stop else {
            panic!("{stop:?}")
        };
        assert_eq!(limit.stop, name);
        // The tolerance of the integration, relative to 1 + |value|.
        assert!((time - instant).abs() < 1e-8, "{time} {instant}");
        let reached = run.solver.pose().time;
        assert!((time - reached).abs() < 1e-12, "{time} {reached}");
        // The time of a stop is known to some roundings, at a few metres per second.
        let [.., value] = run.solver.pose().drivers[..] else {
            panic!("there are freedoms")
        };
        assert!((value - limit.value).abs() < 1e-12, "{value}");
        // It stays there.
        let again = run.try_to(until + 1.0);
        assert!(matches!(again, Err(Error::Stop { .. })), "{again:?}");
        assert!((run.solver.pose().time - reached).abs() < 1e-12);
    }
}

#[test]
fn a_weight_falls_to_the_floor() {
    let stops = "bottom = { of = \"height\", min = -0.5 }";
    ends_at(&weight(stops, 0.0), 2.0, "bottom", (1.0 / 9.81_f64).sqrt());
}

/// Thrown up at 3 m/s it rises by 0.4587 m: a ceiling that is higher is not met.
#[test]
fn a_weight_meets_the_ceiling_or_passes_below() {
    let stops =
        "bottom = { of = \"height\", min = -0.5 }\nceiling = { of = \"height\", max = 0.45 }";
    let rise = (3.0 - (9.0 - 2.0 * 9.81 * 0.45_f64).sqrt()) / 9.81;
    ends_at(&weight(stops, 3.0), 2.0, "ceiling", rise);
    let high = stops.replace("0.45 ", "0.459 ");
    let fall = (3.0 + (9.0 + 2.0 * 9.81 * 0.5_f64).sqrt()) / 9.81;
    ends_at(&weight(&high, 3.0), 2.0, "bottom", fall);
}

#[test]
fn a_pair_of_weights_meets_the_wall() {
    // x_b = 0.6 + 0.3 t + (1 + 0.2 cos 10 t)/2 = 1.5, by bisection.
    let gap = |t: f64| 1.5 - (0.6 + 0.3 * t + 0.5 * (1.0 + 0.2 * (10.0 * t).cos()));
    let mut t = 0.0;
    while gap(t) > 0.0 {
        t += 1e-3;
    }
    let (mut inside, mut outside) = (t - 1e-3, t);
    for _ in 0..50 {
        let middle = 0.5 * (inside + outside);
        if gap(middle) > 0.0 {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    ends_at(PAIR, 5.0, "wall", inside);
}
