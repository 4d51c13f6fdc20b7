//! Outputs on both sides of change points, against closed forms that lose nothing there.

use biela::kinematics::Rates;
use biela::mechanism::{Jet, Variable};
use proptest::prelude::*;

use crate::common::exact::Errors;
use crate::common::{assembled, parse, straight_to};

/// Distances of the driver from the change point \[rad\]: on the way to it, and beyond.
const DISTANCES: [f64; 16] = [
    0.3, 0.2, 0.13, 0.1, 0.07, 0.05, 0.03, 0.021, 0.02, 0.019, 0.01, 1e-3, 1e-4, 1e-6, 1e-9, 0.0,
];

/// A four-bar with a change point, and q as formulas in the driver's value `t`.
struct FourBar {
    /// Lengths of crank, coupler, rocker and base; two of them add up to as much as the others.
    lengths: [f64; 4],
    /// Angle of the base \[rad\].
    turn: f64,
    /// The crank's angle at the change point: 0 or pi.
    change: f64,
}

impl FourBar {
    /// Returns the four-bar in line where the crank is at pi, or at 0.
    fn new([crank, coupler, rest]: [f64; 3], turn: f64, at_pi: bool) -> Option<Self> {
        // rest: the rocker's length, or how much the base is longer than the crank.
        let (rocker, base, change) = if at_pi {
            (rest, coupler + rest - crank, std::f64::consts::PI)
        } else {
            (coupler + rest, crank + rest, 0.0)
        };
        let lengths = [crank, coupler, rocker, base];
        // A second change point, or one of another kind, has a closed form of its own.
        let other = if at_pi {
            (base - crank).abs() - (coupler - rocker).abs()
        } else {
            (coupler + rocker) - (base + crank)
        };
        (base > 0.1 && other.abs() > 0.1).then_some(Self {
            lengths,
            turn,
            change,
        })
    }

    /// The formulas of x, y and phi of all bodies.
    ///
    /// With the diagonal f from crank pin to rocker pivot, 16 (area of the triangle of f, coupler
    /// and rocker)² = ((b + c)² − f²)(f² − (b − c)²). One factor is 4ad cos²(t/2), or
    /// 4ad sin²(t/2): its root changes sign on the smooth motion.
    fn formulas(&self) -> [String; 9] {
        let at_pi = self.change != 0.0;
        let ax = "(a*cos(t))";
        let ay = "(a*sin(t))";
        let square = "(a^2 + d^2 - 2*a*d*cos(t))";
        let area = if at_pi {
            format!("(2*sqrt(a*d)*cos(t/2)*sqrt({square} - (b - c)^2))")
        } else {
            format!("(2*sqrt(a*d)*sin(t/2)*sqrt((b + c)^2 - {square}))")
        };
        let diagonal = format!("atan2(-{ay}, d - {ax})");
        let coupler = format!("{diagonal} + atan2({area}, {square} + b^2 - c^2)");
        // Beyond the crank at 0 the rocker lies over its pivot: the angle is near pi.
        let beside = if at_pi {
            format!("atan2({area}, {square} + c^2 - b^2)")
        } else {
            format!("(pi - atan2({area}, b^2 - c^2 - {square}))")
        };
        let beside = if !at_pi && self.lengths[2] > self.lengths[1] {
            format!("atan2({area}, {square} + c^2 - b^2)")
        } else {
            beside
        };
        let coupler = if !at_pi && self.lengths[2] > self.lengths[1] {
            format!("{diagonal} + pi - atan2({area}, c^2 - b^2 - {square})")
        } else {
            coupler
        };
        let rocker = format!("{diagonal} + pi - {beside}");
        [
            "0".to_owned(),
            "0".to_owned(),
            "g + t".to_owned(),
            "a*cos(g + t)".to_owned(),
            "a*sin(g + t)".to_owned(),
            format!("g + {coupler}"),
            "d*cos(g)".to_owned(),
            "d*sin(g)".to_owned(),
            format!("g + {rocker}"),
        ]
    }

    fn text(&self, start: f64, estimates: [f64; 9]) -> String {
        let [a, b, c, d] = self.lengths;
        let turn = self.turn;
        let [x1, y1, phi1, x2, y2, phi2, x3, y3, phi3] = estimates;
        format!(
            "format = 1\nname = 'bar'\n\
             [parameters]\na = {a:?}\nb = {b:?}\nc = {c:?}\nd = {d:?}\ng = {turn:?}\n\
             [ground.markers]\nO2 = [0, 0, 'g']\nO4 = ['d*cos(g)', 'd*sin(g)']\n\
             [bodies.crank]\nmarkers = {{ O = [0, 0], A = ['a', 0] }}\n\
             estimate = [{x1:?}, {y1:?}, {phi1:?}]\n\
             [bodies.coupler]\nmarkers = {{ A = [0, 0], B = ['b', 0] }}\n\
             estimate = [{x2:?}, {y2:?}, {phi2:?}]\n\
             [bodies.rocker]\nmarkers = {{ O = [0, 0], B = ['c', 0] }}\n\
             estimate = [{x3:?}, {y3:?}, {phi3:?}]\n\
             [joints]\nO2 = {{ type = 'revolute', markers = ['ground.O2', 'crank.O'] }}\n\
             A = {{ type = 'revolute', markers = ['crank.A', 'coupler.A'] }}\n\
             B = {{ type = 'revolute', markers = ['coupler.B', 'rocker.B'] }}\n\
             O4 = {{ type = 'revolute', markers = ['ground.O4', 'rocker.O'] }}\n\
             [drivers]\nu = {{ coordinate = 'angle', markers = ['ground.O2', 'crank.O'], \
             start = {start:?} }}\n"
        )
    }

    /// Returns the largest errors of position, velocity and acceleration over a motion through the
    /// change point, relative to the largest of their kind.
    fn errors(&self) -> [f64; 3] {
        let start = self.change - 0.4;
        let any = parse(&self.text(start, [0.0; 9]));
        let parameters = any.default_parameters();
        let formulas = self.formulas().map(|formula| {
            let formula = any.parse_expression(&formula, Some(Variable::Time));
            formula.expect("the formula is right")
        });
        let truth = |driver: Jet| {
            let formulas = formulas.each_ref();
            formulas.map(|f| f.evaluate(&|p| Jet::constant(parameters[p.index()]), driver))
        };
        let estimates = truth(Jet::constant(start)).map(|jet| jet.value);
        let mechanism = parse(&self.text(start, estimates));
        let (mut solver, mut path) = assembled(&mechanism);
        let mut rates = Rates::new(solver.pose().q.len());
        let mut errors = Errors::default();
        for (side, off) in [-1.0, 1.0]
            .into_iter()
            .flat_map(|side| DISTANCES.map(|off| (side, off)))
        {
            let target = self.change + side * off;
            straight_to(&solver, &mut path, target);
            solver
                .track(&path)
                .unwrap_or_else(|blocked| panic!("{:?} at {target}: {blocked:?}", self.lengths));
            let driver = Jet::new(target, [1.0, 0.3]);
            solver
                .solve_rates(|_| driver, &mut rates)
                .expect("rates exist on the smooth motion");
            errors.collect(&solver, &rates, &truth(driver));
        }
        errors.relative()
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    /// Positions keep twelve digits, velocities and accelerations ten, at any distance from the
    /// change point.
    #[test]
    fn outputs_next_to_change_points_of_four_bars_keep_their_digits(
        lengths in [0.2..1.0_f64, 0.2..1.0_f64, 0.2..1.0_f64],
        turn in -3.0..3.0_f64,
        at_pi in any::<bool>(),
    ) {
        let Some(four_bar) = FourBar::new(lengths, turn, at_pi) else {
            return Ok(());
        };
        let [position, velocity, acceleration] = four_bar.errors();
        prop_assert!(
            position < 1e-12 && velocity < 1e-10 && acceleration < 1e-10,
            "{position:e} {velocity:e} {acceleration:e}"
        );
    }
}

/// A short coupler turns 3.6 times as fast as the crank, past its change point nearly evenly: an
/// error counts for more where accelerations are small.
#[test]
fn a_short_coupler_keeps_the_digits_of_its_acceleration() {
    let lengths = [
        0.688_798_070_175_667_7,
        0.220_824_050_556_856_72,
        0.796_005_302_477_729_4,
    ];
    let four_bar = FourBar::new(lengths, 2.041_689_411_279_073_8, false);
    let [position, velocity, acceleration] = four_bar.expect("it has one change point").errors();
    assert!(
        position < 1e-12 && velocity < 1e-10 && acceleration < 1e-10,
        "{position:e} {velocity:e} {acceleration:e}"
    );
}

/// A step ends 0.02 rad before a change point that is farther in the other unknowns than Newton's
/// method looks at first: the motion goes on.
#[test]
fn a_change_point_is_told_from_a_touch_from_afar() {
    for turn in [0.3412805743701129, 0.34128057437011333, 0.3412805743701147] {
        let four_bar = FourBar {
            lengths: [
                0.861_014_154_086_361_4,
                0.967_167_627_060_669_6,
                1.174_595_102_399_911_7,
                1.068_441_629_425_603_6,
            ],
            turn,
            change: 0.0,
        };
        let [position, velocity, acceleration] = four_bar.errors();
        assert!(position < 1e-12 && velocity < 1e-10 && acceleration < 1e-10);
    }
}
