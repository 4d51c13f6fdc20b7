//! Prescribed motions: a driver's value as a function of time and the parameters.

mod corner;
mod law;
mod moving;

pub use law::Law;

use super::{
    Ends, Expression, Interpolation, Interval, Jet, Jet3, Number, ParameterId, PointFunction,
    Spline, Variable, joins,
};

/// A prescribed motion u(t, parameters) \[m or rad\].
#[derive(Clone, Debug)]
pub enum PrescribedMotion {
    /// An expression in `t` and the parameters.
    Expression(Expression),
    /// Points of the motion with their interpolation.
    Table(PointFunction),
}

impl PrescribedMotion {
    /// Returns whether it moves at all.
    #[must_use]
    pub fn uses_time(&self) -> bool {
        match self {
            Self::Expression(expression) => expression.uses(Variable::Time),
            Self::Table(_) => true,
        }
    }

    /// Returns the parameters that it uses; one may come twice.
    pub fn parameters(&self) -> Box<dyn Iterator<Item = ParameterId> + '_> {
        match self {
            Self::Expression(expression) => Box::new(expression.parameters()),
            Self::Table(motion) => Box::new(motion.table.parameters()),
        }
    }
}

/// A prescribed motion with parameter values in force: ready to be evaluated at any time.
///
/// Made once; [`set_parameters`](Self::set_parameters) then changes it without allocating.
/// On [`Jet`]s it gives value, velocity and acceleration.
#[derive(Clone, Debug)]
pub struct MotionInForce<N = Jet> {
    motion: PrescribedMotion,
    parameters: Vec<N>,
    /// Through the table's points, for parameters that may move.
    spline: Option<Spline<N>>,
    /// Whether the table's times rise.
    valid: bool,
}

/// Eight times the distance from its chord below which a rough bound of a motion will do \[m or
/// rad\].
const ROUGH: f64 = 1e-5;

impl<N: Number> MotionInForce<N> {
    /// Makes the motion for `parameters` parameters, whose values are set later.
    #[must_use]
    pub fn new(motion: &PrescribedMotion, parameters: usize) -> Self {
        let spline = match motion {
            PrescribedMotion::Expression(_) => None,
            PrescribedMotion::Table(motion) => {
                Some(Spline::new(motion.table.points.len(), motion.ends))
            }
        };
        Self {
            motion: motion.clone(),
            parameters: vec![N::constant(0.0); parameters],
            spline,
            valid: false,
        }
    }

    /// Sets the parameter values, with their derivatives with respect to the variable of
    /// evaluation.
    pub fn set_parameters(&mut self, parameter: impl Fn(ParameterId) -> N) {
        for (index, value) in self.parameters.iter_mut().enumerate() {
            *value = parameter(ParameterId(index));
        }
        if let (PrescribedMotion::Table(motion), Some(spline)) = (&self.motion, &mut self.spline) {
            let (times, values) = spline.points_mut();
            motion.table.write(&parameter, times, values);
            self.valid = spline.is_valid();
            if self.valid && motion.interpolation == Interpolation::Spline {
                spline.fit();
            }
        }
    }

    /// Returns the value and its derivatives at time `t`, itself a function of the variable of
    /// evaluation. Allocates nothing.
    ///
    /// At a point of a table the rates are those of the next piece. Not finite where an expression
    /// leaves its domain or the times of a table do not rise.
    #[must_use]
    pub fn evaluate(&self, t: N) -> N {
        match (&self.motion, &self.spline) {
            (PrescribedMotion::Expression(expression), _) => {
                expression.evaluate(&|p| self.parameters[p.index()], t)
            }
            (PrescribedMotion::Table(motion), Some(spline)) if self.valid => {
                motion.evaluate(&spline.laid(), t)
            }
            (PrescribedMotion::Table(_), _) => N::constant(f64::NAN),
        }
    }
}

impl MotionInForce {
    /// Returns an upper bound of |d²u/dt²| from `from` to `to`, between which no point of a table
    /// lies. `None` where the motion cannot be shown to be smooth. Allocates nothing.
    #[must_use]
    pub fn curvature(&self, from: f64, to: f64) -> Option<f64> {
        match (&self.motion, &self.spline) {
            (PrescribedMotion::Expression(expression), _) => {
                let parameter = |p: ParameterId| self.parameters[p.index()].value;
                let t = Interval::new(from, to);
                let constant = |p: ParameterId| Jet3::constant(parameter(p));
                let rough = expression.evaluate(&constant, Jet3::variable(t)).second();
                // The more exact bound takes six times as long.
                if rough.magnitude() * (to - from) * (to - from) <= ROUGH {
                    return Some(rough.magnitude());
                }
                Some(expression.enclose(&parameter, t)?.second().magnitude())
            }
            (PrescribedMotion::Table(motion), Some(spline)) if self.valid => {
                Some(motion.curvature(spline, from, to))
            }
            (PrescribedMotion::Table(_), _) => None,
        }
    }

    /// Encloses the value over the range of `t` on all pieces of an expression whose parts jump
    /// together, with derivatives with respect to the variable of evaluation. `None` where it is no
    /// such expression, or jumps. Allocates nothing.
    #[must_use]
    pub fn enclose_joined(&self, t: Jet3<Interval>) -> Option<Jet3<Interval>> {
        let PrescribedMotion::Expression(expression) = &self.motion else {
            return None;
        };
        let parameter = |p: ParameterId| Jet3::constant(self.parameters[p.index()].value);
        let pieces = expression.enclose_all_pieces(&(&parameter, &|_| t))?;
        let bounds = |part| expression.evaluate(&parameter, Jet3::variable(part));
        joins(t.value, bounds, |t| self.evaluate(Jet::variable(t))).then_some(pieces)
    }

    /// Encloses the value over the range of `t` and of the parameters, with derivatives with
    /// respect to the variable of evaluation; bounds that are not known are not finite. `None` for
    /// a table. Allocates nothing.
    #[must_use]
    pub fn enclose(
        &self,
        t: Jet3<Interval>,
        parameter: &impl Fn(ParameterId) -> Jet3<Interval>,
    ) -> Option<Jet3<Interval>> {
        match &self.motion {
            PrescribedMotion::Expression(expression) => Some(expression.evaluate(parameter, t)),
            PrescribedMotion::Table(_) => None,
        }
    }
}

impl<N: Number> MotionInForce<N> {
    /// Returns the time of the next point of a table after `t`, where another piece of the motion
    /// begins. Infinite if there is none.
    #[must_use]
    pub fn next_point(&self, t: f64) -> f64 {
        let (PrescribedMotion::Table(motion), Some(spline), true) =
            (&self.motion, &self.spline, self.valid)
        else {
            return f64::INFINITY;
        };
        let times = spline.knots();
        let (start, end) = (times[0].real(), times[times.len() - 1].real());
        let laps = match motion.ends {
            Ends::Periodic => ((t - start) / (end - start)).floor() * (end - start),
            _ => 0.0,
        };
        let next = times.partition_point(|time| time.real() + laps <= t);
        times
            .get(next)
            .map_or(f64::INFINITY, |time| time.real() + laps)
    }
}

/// Returns the first of value, velocity and acceleration of a motion that is not finite.
pub fn not_finite(motion: Jet) -> Option<&'static str> {
    let parts = [
        (motion.value, "the value"),
        (motion.first(), "the velocity"),
        (motion.second(), "the acceleration"),
    ];
    let (_, what) = parts.into_iter().find(|(part, _)| !part.is_finite())?;
    Some(what)
}

impl PointFunction {
    /// Returns an upper bound of |d²u/dt²| between two times, between which no point lies.
    fn curvature(&self, spline: &Spline<Jet>, from: f64, to: f64) -> f64 {
        let times = spline.knots();
        let (start, end) = (times[0].value, times[times.len() - 1].value);
        let middle = from.midpoint(to);
        let laps = match self.ends {
            Ends::Periodic => ((middle - start) / (end - start)).floor() * (end - start),
            // Beyond its ends it runs straight, if it moves at all.
            _ if middle < start || middle >= end => return 0.0,
            _ => 0.0,
        };
        let segment = spline.segment(middle - laps);
        let law = match self.interpolation {
            Interpolation::Law(law) => law,
            Interpolation::Linear | Interpolation::Steps => return 0.0,
            Interpolation::Spline => {
                // Linear on each segment.
                let at = |t: f64| spline.curvature_on_segment(segment, Jet::constant(t - laps))[0];
                return at(from).value.abs().max(at(to).value.abs());
            }
        };
        let time = times[segment + 1].value - times[segment].value;
        let stroke = spline.values()[segment + 1].value - spline.values()[segment].value;
        law.peak_acceleration() * stroke.abs() / (time * time)
    }
}
