//! Profiles of cams: the polar radius of a contour as a function of the polar angle.

mod closed_points;
mod moving;
mod sectors;

use std::cell::Cell;
use std::f64::consts::TAU;

use super::expression::ExpressionInForce;
use super::{Dual, Expression, Interpolation, Interval, Jet3, ParameterId, Table};
use closed_points::ClosedPoints;
pub use moving::MovingProfile;
use sectors::{Contour, Sectors, overlapping};

/// A closed contour R(θ), θ counter-clockwise from the cam marker's x-axis \[rad, m\].
#[derive(Clone, Debug)]
pub enum Profile {
    /// An expression in `theta`, which goes from 0 to 2π, and the parameters.
    Expression(Expression),
    /// Points of the contour, which go once round; the first is not repeated.
    Table {
        /// Polar angles \[rad\], rising, and radii \[m\].
        table: Table,
        /// Course from one point to the next: a closed cubic spline, or a rise, dwell or return by
        /// a motion law.
        interpolation: Interpolation,
    },
}

impl Profile {
    /// Returns the parameters that it uses; one may come twice.
    pub fn parameters(&self) -> Box<dyn Iterator<Item = ParameterId> + '_> {
        match self {
            Self::Expression(expression) => Box::new(expression.parameters()),
            Self::Table { table, .. } => Box::new(table.parameters()),
        }
    }
}

/// A contour that no follower can run on.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProfileError {
    /// Radius, slope or curvature are not finite somewhere.
    #[error(
        "radius, slope and curvature of a contour must be finite; they are not at theta = {} deg",
        degrees(*.theta)
    )]
    NotFinite {
        /// Polar angle \[rad\].
        theta: f64,
    },
    /// The radius is not positive somewhere.
    #[error(
        "the radius of a contour must be positive; it is {radius:.3e} m at theta = {} deg",
        degrees(*.theta)
    )]
    NotPositive {
        /// Polar angle \[rad\].
        theta: f64,
        /// R \[m\].
        radius: f64,
    },
    /// After a turn the contour is not where it began.
    #[error("the contour does not close: its {what} is {start} at theta = 0 and {end} at 2*pi")]
    Open {
        /// Radius, slope or second derivative.
        what: &'static str,
        /// Its value at the start of the turn.
        start: f64,
        /// Its value at the end.
        end: f64,
    },
    /// The slope jumps, or the radius.
    #[error("the contour has a corner at theta = {} deg", degrees(*.theta))]
    Corner {
        /// Polar angle \[rad\].
        theta: f64,
    },
    /// The angles of a table do not rise within one turn.
    #[error("the angles of the contour's table do not rise within one turn")]
    Disordered,
}

fn degrees(theta: f64) -> f64 {
    (theta.to_degrees() * 10.0).round() / 10.0
}

/// A profile with parameter values in force.
///
/// Made once; [`set_parameters`](Self::set_parameters) then changes it without allocating.
#[derive(Clone, Debug)]
pub struct ProfileInForce {
    curve: ContourInForce,
    /// Values of all parameters.
    parameters: Vec<f64>,
    /// Parameters that the profile uses.
    used: Vec<ParameterId>,
    /// Whether the parameters make a contour.
    valid: bool,
    /// Continuity where pieces of the contour meet.
    joint: Joint,
    /// Results of the last calls. The rows of a contact ask for the same again and again.
    last: Last,
}

/// The last polar angle with its radius and its point, and the last range with its bounds.
#[derive(Clone, Debug, Default)]
struct Last {
    radius: Cell<Option<(u64, Jet3)>>,
    point: Cell<Option<(u64, ContourPoint)>>,
    bounds: Cell<Option<([u64; 2], Option<ProfileBounds>)>>,
}

/// Continuity of a contour where pieces of it meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Joint {
    /// Not examined, or the slope jumps.
    Kink,
    /// The slope is continuous, the second derivative jumps.
    Slope,
    /// The second derivative is continuous.
    Curvature,
}

/// A contour at one polar angle, in the frame of the cam's marker.
#[derive(Clone, Copy, Debug)]
pub struct ContourPoint {
    /// Vector from the pole \[m\].
    pub arm: [f64; 2],
    /// Unit tangent, counter-clockwise round the cam.
    pub tangent: [f64; 2],
    /// Arc length per angle, v = √(R² + R′²), and its derivative \[m/rad, m/rad²\].
    pub speed: [f64; 2],
    /// First and second derivative of the tangent's direction: v times the curvature, positive
    /// where the contour is convex.
    pub turn: [f64; 2],
}

impl ContourPoint {
    /// Makes the point from R and its derivatives.
    fn new(theta: f64, radius: Jet3) -> Self {
        let (r, [r1, r2, r3]) = (radius.value, radius.derivatives);
        let (sin, cos) = theta.sin_cos();
        let square = r * r + r1 * r1;
        let v = square.sqrt();
        // The angle from the radial direction to the tangent is atan(R/R′): the derivative of the
        // tangent's direction is (R² + 2R′² − R R″)/(R² + R′²).
        let (per_v, per_square) = (1.0 / v, 1.0 / square);
        let turn = (square + r1 * r1 - r * r2) * per_square;
        let numerator_rate = 2.0 * r * r1 + 3.0 * r1 * r2 - r * r3;
        let turn_rate = (numerator_rate - 2.0 * turn * (r * r1 + r1 * r2)) * per_square;
        Self {
            arm: [r * cos, r * sin],
            tangent: [(r1 * cos - r * sin) * per_v, (r1 * sin + r * cos) * per_v],
            speed: [v, (r * r1 + r1 * r2) * per_v],
            turn: [turn, turn_rate],
        }
    }
}

/// Bounds of a contour over a range of polar angles.
#[derive(Clone, Copy, Debug)]
pub struct ProfileBounds {
    /// R and its first three derivatives; at single angles the third one may not exist.
    pub radius: Jet3<Interval>,
    /// Whether the second derivative may jump in the range.
    pub jumps: bool,
}

impl ProfileBounds {
    /// Returns bounds over both ranges.
    fn hull(self, other: Self) -> Self {
        Self {
            radius: self.radius.hull(other.radius),
            jumps: self.jumps || other.jumps,
        }
    }
}

#[derive(Clone, Debug)]
enum ContourInForce {
    Expression {
        expression: Expression,
        in_force: Box<ExpressionInForce>,
        sectors: Sectors,
    },
    Points {
        table: Table,
        points: ClosedPoints<f64>,
    },
}

/// Number of samples of a whole contour.
const SAMPLES: u32 = 720;
/// Largest gap where a contour closes, in radius and derivatives \[radii\].
const SEAM: f64 = 1e-9;
/// Width down to which a range that cannot be shown to be smooth is divided \[rad\].
const CORNER_WIDTH: f64 = 1e-7;
/// Largest change of a smooth contour across that width, in radii and radii per radian: more takes
/// a second derivative of over a thousand radii.
const CORNER_JUMP: f64 = 1e-4;
/// Largest number of ranges that are divided; a contour that needs more is examined less finely.
const MOST_LOOKS: u32 = 20_000;

impl ProfileInForce {
    /// Makes the profile for `parameters` parameters, whose values are set later.
    #[must_use]
    pub fn new(profile: &Profile, parameters: usize) -> Self {
        let curve = match profile {
            Profile::Expression(expression) => ContourInForce::Expression {
                expression: expression.clone(),
                in_force: Box::default(),
                sectors: Sectors::new(),
            },
            Profile::Table {
                table,
                interpolation,
            } => ContourInForce::Points {
                points: ClosedPoints::new(table.points.len(), *interpolation),
                table: table.clone(),
            },
        };
        Self {
            curve,
            parameters: vec![0.0; parameters],
            used: profile.parameters().collect(),
            valid: false,
            joint: Joint::Kink,
            last: Last::default(),
        }
    }

    /// Sets the parameter values.
    ///
    /// # Errors
    ///
    /// They make no contour. The profile is not usable until others are set.
    pub fn set_parameters(
        &mut self,
        parameter: impl Fn(ParameterId) -> f64,
    ) -> Result<(), ProfileError> {
        let kept =
            |id: &ParameterId| self.parameters[id.index()].to_bits() == parameter(*id).to_bits();
        if self.valid && self.used.iter().all(kept) {
            return Ok(());
        }
        self.valid = false;
        self.last = Last::default();
        for (index, value) in self.parameters.iter_mut().enumerate() {
            *value = parameter(ParameterId(index));
        }
        match &mut self.curve {
            ContourInForce::Points { table, points } => points.set(table, &parameter)?,
            ContourInForce::Expression {
                expression,
                in_force,
                sectors,
            } => {
                in_force.set(expression, &|p| self.parameters[p.index()]);
                sectors.forget();
            }
        }
        self.check()?;
        self.joint = Joint::Kink;
        if let ContourInForce::Expression { expression, .. } = &self.curve
            && expression.has_pieces()
        {
            self.joint = self.examine_joints();
        }
        self.valid = true;
        Ok(())
    }

    /// Checks samples of the whole contour, and its seam.
    fn check(&self) -> Result<(), ProfileError> {
        for theta in Self::sample_angles() {
            let radius = self.radius(theta);
            if !(radius.value + radius.first() + radius.second()).is_finite() {
                return Err(ProfileError::NotFinite { theta });
            }
            if radius.value <= 0.0 {
                return Err(ProfileError::NotPositive {
                    theta,
                    radius: radius.value,
                });
            }
        }
        let ContourInForce::Expression { expression, .. } = &self.curve else {
            return Ok(());
        };
        let [start, end] = [0.0, TAU].map(|theta| self.evaluate(expression, theta));
        let pairs = [
            ("radius", start.value, end.value),
            ("slope", start.first(), end.first()),
            ("second derivative", start.second(), end.second()),
        ];
        let meet =
            |(_, start, end): &(_, f64, f64)| (start - end).abs() <= SEAM * self.radius(0.0).value;
        match pairs.iter().find(|pair| !meet(pair)) {
            Some(&(what, start, end)) => Err(ProfileError::Open { what, start, end }),
            None => Ok(()),
        }
    }

    /// Searches for corners: places where the radius or its slope jumps. Divides the ranges in
    /// which the contour cannot be shown to be smooth.
    ///
    /// # Errors
    ///
    /// The first corner.
    pub fn check_smoothness(&self) -> Result<(), ProfileError> {
        self.visit_seams(|[low, high]| {
            let (before, after) = (self.radius(low), self.radius(high));
            let jump = CORNER_JUMP * before.value;
            let smooth = (before.value - after.value).abs() <= jump
                && (before.first() - after.first()).abs() <= jump;
            if smooth {
                Ok(())
            } else {
                let theta = low.midpoint(high);
                Err(ProfileError::Corner { theta })
            }
        })
    }

    /// Returns the continuity where pieces meet: each derivative changes across a seam by no more
    /// than the next one, on both sides, makes it.
    fn examine_joints(&self) -> Joint {
        let mut joint = Joint::Curvature;
        let visited = self.visit_seams(|[low, high]| {
            let width = high - low;
            if width > CORNER_WIDTH {
                return Err(());
            }
            let ends = [low, high].map(|theta| self.radius(theta));
            let [before, after] = ends;
            let continuous = |order: fn(&Jet3) -> f64, next: fn(&Jet3) -> f64| {
                let change = (order(&before) - order(&after)).abs();
                let slope = ends.iter().map(|end| next(end).abs()).sum::<f64>();
                change <= 2.0 * width * slope + SEAM * before.value
            };
            let slope =
                continuous(|r| r.value, |r| r.first()) && continuous(|r| r.first(), |r| r.second());
            if !slope {
                return Err(());
            }
            if !continuous(|r| r.second(), |r| r.third()) {
                joint = Joint::Slope;
            }
            Ok(())
        });
        visited.map_or(Joint::Kink, |()| joint)
    }

    /// Visits the narrow ranges in which the contour cannot be shown to be smooth. They overlap.
    fn visit_seams<E>(&self, mut visit: impl FnMut([f64; 2]) -> Result<(), E>) -> Result<(), E> {
        let ContourInForce::Expression { expression, .. } = &self.curve else {
            return Ok(());
        };
        let parameter = |p: ParameterId| self.parameters[p.index()];
        let mut looks = MOST_LOOKS;
        let sixteenth = TAU / 16.0;
        // Ranges still to be divided, the last one first.
        let mut open: Vec<[f64; 2]> = (0..16)
            .rev()
            .map(|part| [part, part + 1].map(|k| f64::from(k) * sixteenth))
            .collect();
        while let Some([low, high]) = open.pop() {
            // A kink between two ranges is in both.
            let range = overlapping([low, high]);
            if expression.enclose(&parameter, range).is_some() {
                continue;
            }
            looks = looks.saturating_sub(1);
            if high - low > CORNER_WIDTH && looks > 0 {
                let middle = low.midpoint(high);
                open.extend([[middle, high], [low, middle]]);
            } else {
                visit([range.low, range.high])?;
            }
        }
        Ok(())
    }

    /// Returns R and its first three derivatives at a polar angle, of any number of turns.
    /// Allocates nothing.
    ///
    /// The result has no meaning if the parameters make no contour.
    #[must_use]
    pub fn radius(&self, theta: f64) -> Jet3 {
        last_or_new(&self.last.radius, theta.to_bits(), || match &self.curve {
            ContourInForce::Expression {
                expression,
                in_force,
                ..
            } => {
                let turned = theta.rem_euclid(TAU);
                let radius = in_force.evaluate(turned);
                radius.unwrap_or_else(|| self.evaluate(expression, turned))
            }
            ContourInForce::Points { points, .. } => points.radius(theta),
        })
    }

    /// Returns the contour at a polar angle, of any number of turns. Allocates nothing.
    #[must_use]
    pub fn point(&self, theta: f64) -> ContourPoint {
        last_or_new(&self.last.point, theta.to_bits(), || {
            ContourPoint::new(theta, self.radius(theta))
        })
    }

    fn evaluate(&self, expression: &Expression, theta: f64) -> Jet3 {
        let parameter = |p: ParameterId| Jet3::constant(self.parameters[p.index()]);
        expression.evaluate(&parameter, Jet3::variable(theta))
    }

    /// Returns bounds of R and its first three derivatives for polar angles up to `reach` from
    /// `theta`; `None` if the slope may jump there, or the radius. Allocates nothing.
    #[must_use]
    pub fn bounds(&self, theta: f64, reach: f64) -> Option<ProfileBounds> {
        let range = [theta, reach].map(f64::to_bits);
        last_or_new(&self.last.bounds, range, || match &self.curve {
            ContourInForce::Expression {
                expression,
                sectors,
                ..
            } => {
                let contour = Contour {
                    expression,
                    parameters: &self.parameters,
                    joint: self.joint,
                };
                sectors.bounds(contour, theta, reach)
            }
            ContourInForce::Points { points, .. } => Some(ProfileBounds {
                radius: points.bounds(theta, reach),
                jumps: points.jumps(),
            }),
        })
    }

    /// Returns the polar angles of the samples of a whole contour, evenly spread over a turn.
    pub fn sample_angles() -> impl Iterator<Item = f64> {
        (0..SAMPLES).map(|k| f64::from(k) * (TAU / f64::from(SAMPLES)))
    }

    /// Returns the polar angle among [`sample_angles`](Self::sample_angles) at which `cost`, a
    /// function of angle and radius, is least.
    #[must_use]
    pub fn angle_of_least(&self, cost: impl Fn(f64, f64) -> f64) -> f64 {
        let costs =
            Self::sample_angles().map(|theta| (theta, cost(theta, self.radius(theta).value)));
        costs
            .min_by(|(_, a), (_, b)| a.total_cmp(b))
            .map_or(0.0, |(theta, _)| theta)
    }
}

/// Returns the last result if it is that of `key`, otherwise a new one, which becomes the last.
#[inline]
fn last_or_new<K: Copy + PartialEq, V: Copy>(
    last: &Cell<Option<(K, V)>>,
    key: K,
    new: impl FnOnce() -> V,
) -> V {
    match last.get() {
        Some((known, result)) if known == key => result,
        _ => {
            let result = new();
            last.set(Some((key, result)));
            result
        }
    }
}

/// Profile whose parameters change along a direction.
#[derive(Clone, Debug)]
pub struct ProfileAlong(CurveAlong);

#[derive(Clone, Debug)]
enum CurveAlong {
    Expression {
        expression: Expression,
        /// All parameters.
        parameters: Vec<Jet3<Dual>>,
    },
    Points(ClosedPoints<Jet3<Dual>>),
}

impl ProfileInForce {
    /// Returns the profile with the parameters in force and their changes along a direction.
    #[must_use]
    pub fn along(&self, change: impl Fn(ParameterId) -> f64) -> ProfileAlong {
        let parameter =
            |p: ParameterId| Jet3::fixed(Dual::new(self.parameters[p.index()], [change(p)]));
        ProfileAlong(match &self.curve {
            ContourInForce::Expression { expression, .. } => CurveAlong::Expression {
                expression: expression.clone(),
                parameters: (0..self.parameters.len())
                    .map(|p| parameter(ParameterId(p)))
                    .collect(),
            },
            ContourInForce::Points { table, points } => {
                CurveAlong::Points(points.along(table, &parameter))
            }
        })
    }
}

impl ProfileAlong {
    /// Returns R and its first three derivatives at a polar angle, of any number of turns, each
    /// with its change along the direction.
    #[must_use]
    pub fn radius(&self, theta: Dual) -> Jet3<Dual> {
        match &self.0 {
            CurveAlong::Expression {
                expression,
                parameters,
            } => {
                let turn = Dual::new(theta.value.rem_euclid(TAU), theta.derivatives);
                expression.evaluate(&|p| parameters[p.index()], Jet3::variable(turn))
            }
            CurveAlong::Points(points) => points.radius_along(theta),
        }
    }
}

#[cfg(test)]
mod tests;
