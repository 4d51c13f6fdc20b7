//! Mechanisms together with their exact solutions.

use biela::kinematics::{Rates, Solver};
use biela::mechanism::{Jet, Mechanism, Variable};

/// A shipped mechanism with one driver, and each of its generalized coordinates as a formula in
/// the driver's value `t`.
pub(crate) struct Exact {
    pub(crate) file: &'static str,
    /// Body, then x, y and phi. What stands in braces is replaced by the formula of that name.
    pub(crate) bodies: &'static [(&'static str, [&'static str; 3])],
    /// Formulas used by others, later ones using earlier ones.
    pub(crate) formulas: &'static [(&'static str, &'static str)],
    /// The driver's value goes from the first to the second over the motion.
    pub(crate) range: (f64, f64),
}

/// The angle of a dyad that closes a triangle comes from the law of cosines; the sign is the one
/// of the assembly mode of the file's estimates.
pub(crate) const EXACT: [Exact; 5] = [
    Exact {
        file: "pendulum",
        bodies: &[("rod", ["length/2*sin(t)", "-length/2*cos(t)", "t - pi/2"])],
        formulas: &[],
        range: (-2.0, 2.0),
    },
    Exact {
        file: "slider_crank",
        bodies: &[
            ("crank", ["0", "0", "t"]),
            (
                "connecting_rod",
                [
                    "{ax} + rod_length/2*cos({phi})",
                    "{ay} + rod_length/2*sin({phi})",
                    "{phi}",
                ],
            ),
            ("slider", ["{ax} + rod_length*cos({phi})", "offset", "0"]),
        ],
        formulas: &[
            ("ax", "crank_length*cos(t)"),
            ("ay", "crank_length*sin(t)"),
            ("phi", "asin((offset - {ay})/rod_length)"),
        ],
        range: (-1.0, 8.0),
    },
    Exact {
        file: "four_bar",
        bodies: &[
            ("crank", ["0", "0", "t"]),
            ("coupler", ["{ax}", "{ay}", "{coupler}"]),
            ("rocker", ["base", "0", "{rocker}"]),
        ],
        formulas: &[
            ("ax", "crank_length*cos(t)"),
            ("ay", "crank_length*sin(t)"),
            // The diagonal from the crank's pin to the rocker's pivot.
            ("d", "hypot(base - {ax}, {ay})"),
            ("delta", "atan2(-{ay}, base - {ax})"),
            (
                "coupler",
                "{delta} + acos(({d}^2 + coupler_length^2 - rocker_length^2)/(2*{d}*coupler_length))",
            ),
            (
                "rocker",
                "{delta} + pi - acos(({d}^2 + rocker_length^2 - coupler_length^2)/(2*{d}*rocker_length))",
            ),
        ],
        range: (0.5, 7.5),
    },
    Exact {
        file: "tlv",
        bodies: &[
            ("arm", ["0", "0", "{arm}"]),
            ("barrel", ["base", "0", "{barrel}"]),
            (
                "rod",
                ["arm_length*cos({arm})", "arm_length*sin({arm})", "{barrel}"],
            ),
        ],
        formulas: &[
            (
                "arm",
                "acos((base^2 + arm_length^2 - t^2)/(2*base*arm_length))",
            ),
            (
                "barrel",
                "atan2(arm_length*sin({arm}), arm_length*cos({arm}) - base)",
            ),
        ],
        range: (0.2, 0.6),
    },
    Exact {
        file: "tlv_crank",
        bodies: &[
            ("arm", ["0", "0", "t"]),
            ("barrel", ["base", "0", "{barrel}"]),
            (
                "rod",
                ["arm_length*cos(t)", "arm_length*sin(t)", "{barrel}"],
            ),
        ],
        // The barrel points to the left all the time; pi plus what it leans is continuous.
        formulas: &[(
            "barrel",
            "pi - atan2(arm_length*sin(t), base - arm_length*cos(t))",
        )],
        range: (-3.0, 9.0),
    },
];

impl Exact {
    /// q, q̇ and q̈ for the driver's value, velocity and acceleration.
    pub(crate) fn solution(&self, mechanism: &Mechanism, driver: Jet) -> Vec<Jet> {
        let parameters = mechanism.default_parameters();
        self.bodies
            .iter()
            .flat_map(|(_, formulas)| formulas)
            .map(|formula| {
                let expression = mechanism
                    .parse_expression(&self.expand(formula), Some(Variable::Time))
                    .expect("the formula is right");
                expression.evaluate(&|p| Jet::constant(parameters[p.index()]), driver)
            })
            .collect()
    }

    fn expand(&self, formula: &str) -> String {
        let mut text = formula.to_owned();
        for (name, meaning) in self.formulas.iter().rev() {
            text = text.replace(&format!("{{{name}}}"), &format!("({meaning})"));
        }
        text
    }
}

/// Largest error of q, q̇ and q̈ at the solver's pose, and the largest magnitude of each.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Errors {
    pub(crate) error: [f64; 3],
    pub(crate) magnitude: [f64; 3],
}

impl Errors {
    pub(crate) fn collect(&mut self, solver: &Solver, rates: &Rates, exact: &[Jet]) {
        let q = &solver.pose().q;
        assert_eq!(q.len(), exact.len());
        for (k, exact) in exact.iter().enumerate() {
            let found = [q[k], rates.velocity()[k], rates.acceleration()[k]];
            let truth = [exact.value, exact.first(), exact.second()];
            for order in 0..3 {
                self.error[order] = self.error[order].max((found[order] - truth[order]).abs());
                self.magnitude[order] = self.magnitude[order].max(truth[order].abs());
            }
        }
    }

    pub(crate) fn relative(&self) -> [f64; 3] {
        [0, 1, 2].map(|order| self.error[order] / self.magnitude[order])
    }
}
