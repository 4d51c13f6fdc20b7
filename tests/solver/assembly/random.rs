//! Random four-bars, near their limits and away from them.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

use crate::common::parse;
use biela::kinematics::{DriverPath, Error, Path, Solver, Verdict};

/// A stream of numbers from 0 to 1, always the same (SplitMix64).
struct Stream(u64);

impl Stream {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as f64 / u64::MAX as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
}

/// A four-bar with everything a parameter: lengths of crank, coupler, rocker and base, then the
/// nine estimates.
const ANY_FOUR_BAR: &str = r#"
    format = 1
    name = "any"
    [parameters]
    a = 1
    b = 1
    c = 1
    d = 1
    a1 = 0
    a2 = 0
    a3 = 0
    b1 = 0
    b2 = 0
    b3 = 0
    c1 = 0
    c2 = 0
    c3 = 0
    [ground.markers]
    O2 = [0, 0]
    O4 = ["d", 0]
    [bodies.crank]
    markers = { O = [0, 0], A = ["a", 0] }
    estimate = ["a1", "a2", "a3"]
    [bodies.coupler]
    markers = { A = [0, 0], B = ["b", 0] }
    estimate = ["b1", "b2", "b3"]
    [bodies.rocker]
    markers = { O = [0, 0], B = ["c", 0] }
    estimate = ["c1", "c2", "c3"]
    [joints]
    O2 = { type = "revolute", markers = ["ground.O2", "crank.O"] }
    A  = { type = "revolute", markers = ["crank.A", "coupler.A"] }
    B  = { type = "revolute", markers = ["coupler.B", "rocker.B"] }
    O4 = { type = "revolute", markers = ["ground.O4", "rocker.O"] }
    [drivers]
    angle = { coordinate = "angle", markers = ["ground.O2", "crank.O"], start = 0 }
"#;

/// Lengths a, b, c, d of one of nine classes: those of Grashof by their shortest link, the others
/// by their longest, and change points.
fn lengths(class: usize, stream: &mut Stream) -> [f64; 4] {
    let size = 10_f64.powf(stream.between(-3.0, 3.0));
    loop {
        let mut l = [0; 4].map(|_| stream.between(0.05, 1.0));
        l.sort_by(f64::total_cmp);
        if class == 8 {
            // s + l = p + q, to rounding.
            l[3] = l[1] + l[2] - l[0];
        }
        let [shortest, _, _, longest] = l;
        let grashof = shortest + longest < l[1] + l[2];
        let closes = longest < shortest + l[1] + l[2];
        if class < 8 && (grashof != (class < 4) || !closes) {
            continue;
        }
        // Put the link that names the class in its place, the others anywhere.
        let special = if class < 4 { 0 } else { 3 };
        let place = if class < 8 {
            class % 4
        } else {
            (4.0 * stream.next()) as usize % 4
        };
        l.swap(special, place);
        let mut others: Vec<_> = (0..4).filter(|&k| k != place).collect();
        let first = others.swap_remove((3.0 * stream.next()) as usize % 3);
        let second = others[(2.0 * stream.next()) as usize % 2];
        l.swap(first, second);
        return l.map(|length| size * length);
    }
}

/// Both ways in which coupler and rocker close, as their angles, for a crank at `theta`.
fn two_ways([a, b, c, d]: [f64; 4], theta: f64) -> [[f64; 2]; 2] {
    let (x, y) = (d - a * theta.cos(), -a * theta.sin());
    let diagonal = x.hypot(y);
    let direction = y.atan2(x);
    let at_a = ((diagonal * diagonal + b * b - c * c) / (2.0 * diagonal * b)).clamp(-1.0, 1.0);
    let at_o4 = ((diagonal * diagonal + c * c - b * b) / (2.0 * diagonal * c)).clamp(-1.0, 1.0);
    [1.0, -1.0].map(|side| {
        let coupler = direction + side * at_a.acos();
        let rocker = direction + PI - side * at_o4.acos();
        [coupler, rocker]
    })
}

/// The difference of two angles, from −π to π.
fn apart(a: f64, b: f64) -> f64 {
    (a - b) - TAU * ((a - b) / TAU).round()
}

/// Random four-bars of all classes, as many near their limits as away from them, from estimates
/// off by up to 90 degrees and half a length.
#[allow(
    clippy::print_stdout,
    reason = "statistics, for who asks for the output"
)]
fn random_four_bars(count: usize) {
    let mechanism = parse(ANY_FOUR_BAR);
    let mut solver = Solver::new(Arc::clone(&mechanism)).expect("the driver matches");
    let mut path = Path::new(&mechanism);
    let mut stream = Stream(5);
    // In the band, assembled, proved impossible, and of those assembled the nearest.
    let mut counts = [[0_usize; 4]; 9];
    for index in 0..count {
        let class = index % 9;
        let links = lengths(class, &mut stream);
        let [a, b, c, d] = links;
        let size = a.max(b).max(c);
        let mut theta = stream.between(-PI, PI);
        if stream.next() < 0.5 {
            // Near where coupler and rocker are in line, if the crank comes there.
            let limit = if stream.next() < 0.5 {
                b + c
            } else {
                (b - c).abs()
            };
            let off = size * 10_f64.powf(stream.between(-10.0, -3.0));
            let diagonal = limit + if stream.next() < 0.5 { off } else { -off };
            let cos = (a * a + d * d - diagonal * diagonal) / (2.0 * a * d);
            if cos.abs() < 1.0 {
                theta = cos.acos() * theta.signum();
            }
        }
        let diagonal = (d - a * theta.cos()).hypot(a * theta.sin());
        let gap = (diagonal - (b + c)).max((b - c).abs() - diagonal);
        let ways = two_ways(links, theta);
        let meant = ways[(2.0 * stream.next()) as usize % 2];
        let (tip_x, tip_y) = (a * theta.cos(), a * theta.sin());
        let truth = [0.0, 0.0, theta, tip_x, tip_y, meant[0], d, 0.0, meant[1]];
        let mut estimate = truth;
        for (k, value) in estimate.iter_mut().enumerate() {
            let most = if k % 3 == 2 { FRAC_PI_2 } else { 0.5 * size };
            *value += stream.between(-most, most);
        }
        path.to[..4].copy_from_slice(&links);
        path.to[4..].copy_from_slice(&estimate);
        path.driver_paths[0] = DriverPath::Input {
            position: theta,
            velocity: 0.0,
            acceleration: 0.0,
            jump: 0.0,
        };
        let found = solver.assemble(&path);
        let case = || format!("{index}: {links:?} at {theta}, gap {gap:e}: {found:?}");
        // Within the band anything but a wrong pose may be said.
        if gap.abs() < 1e-9 * size {
            counts[class][0] += 1;
            continue;
        }
        if gap > 0.0 {
            let Err(Error::NotAssembled { verdict, open, .. }) = &found else {
                panic!("{}", case())
            };
            assert!(matches!(verdict, Verdict::Impossible { .. }), "{}", case());
            assert_eq!(open.len(), 1, "{}", case());
            // Some eps of the lengths, of which the base may be the largest.
            let rounding = 16.0 * f64::EPSILON * (size + d);
            assert!((open[0].gap - gap).abs() < rounding, "{}", case());
            counts[class][2] += 1;
            continue;
        }
        assert!(found.is_ok(), "{}", case());
        counts[class][1] += 1;
        let q = &solver.pose().q;
        let far = |way: [f64; 2]| {
            // The origins of coupler and rocker are the same in both ways.
            apart(way[0], estimate[5]).powi(2) + apart(way[1], estimate[8]).powi(2)
        };
        let nearest = usize::from(far(ways[1]) < far(ways[0]));
        let off = |way: [f64; 2]| apart(q[5], way[0]).abs().max(apart(q[8], way[1]).abs());
        let reached = usize::from(off(ways[1]) < off(ways[0]));
        // Near the limit, at least 1e-9 of the size away from it, half the digits are left.
        assert!(off(ways[reached]) < 1e-6, "{}", case());
        counts[class][3] += usize::from(nearest == reached);
    }
    println!("class: in the band, assembled, proved impossible; nearest branch reached");
    for (class, [band, assembled, impossible, nearest]) in counts.iter().enumerate() {
        println!("{class}: {band}, {assembled}, {impossible}; {nearest}");
    }
    let sum = |k: usize| counts.iter().map(|counts| counts[k]).sum::<usize>();
    // None of the three is rare, so that the test means something.
    assert!(sum(1) > count / 3 && sum(2) > count / 10 && sum(0) < count / 10);
    // Both ways differ in angles only, and the nearest is taken: always, but for ties.
    assert_eq!(sum(3), sum(1));
}

#[test]
fn random_four_bars_are_assembled_or_proved_impossible() {
    random_four_bars(10_000);
}
