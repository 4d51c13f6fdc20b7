//! Sums of waves in the torn angles of a block, and the rows made of them.

use crate::mechanism::{Interval, Number};

/// The angle of a body.
#[derive(Clone, Copy, Debug)]
pub(super) enum Angle {
    Known(Interval),
    /// A torn angle and a constant that is added to it.
    Torn(usize, Interval),
}

impl Angle {
    pub(super) fn plus(self, turn: Interval) -> Self {
        match self {
            Self::Known(angle) => Self::Known(angle + turn),
            Self::Torn(torn, offset) => Self::Torn(torn, offset + turn),
        }
    }

    pub(super) fn over(self, angles: &[Interval]) -> Interval {
        match self {
            Self::Known(angle) => angle,
            Self::Torn(torn, offset) => angles[torn] + offset,
        }
    }
}

/// A constant and α cos φ + β sin φ for each torn angle.
#[derive(Clone, Debug)]
pub(super) struct Form {
    pub(super) constant: Interval,
    pub(super) waves: Vec<[Interval; 2]>,
}

impl Form {
    pub(super) fn constant(constant: Interval, torn: usize) -> Self {
        Self {
            constant,
            waves: vec![[Interval::point(0.0); 2]; torn],
        }
    }

    /// Returns self + other · factor.
    pub(super) fn plus(mut self, other: &Self, factor: Interval) -> Self {
        self.constant += other.constant * factor;
        for (wave, other) in self.waves.iter_mut().zip(&other.waves) {
            for (part, other) in wave.iter_mut().zip(other) {
                *part += *other * factor;
            }
        }
        self
    }

    pub(super) fn minus(self, other: &Self) -> Self {
        self.plus(other, Interval::point(-1.0))
    }

    /// Returns its range over a box of angles.
    pub(super) fn over(&self, angles: &[Interval]) -> Interval {
        let waves = self.waves.iter().zip(angles);
        waves.fold(self.constant, |sum, (wave, angle)| {
            sum + range(*wave, *angle)
        })
    }
}

impl Form {
    /// Returns the range of its derivative by an angle over a box.
    pub(super) fn slope(&self, angle: usize, angles: &[Interval]) -> Interval {
        let [alpha, beta] = self.waves[angle];
        range([beta, -alpha], angles[angle])
    }
}

/// Returns the range of α cos φ + β sin φ.
pub(super) fn range([alpha, beta]: [Interval; 2], phi: Interval) -> Interval {
    let zero = |x: Interval| x.low == 0.0 && x.high == 0.0;
    if zero(alpha) && zero(beta) {
        return Interval::point(0.0);
    }
    let parts = alpha * phi.cos() + beta * phi.sin();
    // √(α² + β²) cos(φ − atan2(β, α)), turned to the side on which the angle does not jump.
    let amplitude = alpha.hypot(beta);
    let wave = if alpha.low > 0.0 || beta.low > 0.0 || beta.high < 0.0 {
        amplitude * (phi - beta.atan2(alpha)).cos()
    } else {
        -(amplitude * (phi - (-beta).atan2(-alpha)).cos())
    };
    let both = parts.intersection(wave);
    if both.is_finite() { both } else { parts }
}

/// A row after the elimination of x and y.
#[derive(Debug)]
pub(super) enum Closure {
    /// form = 0.
    Sum(Form),
    /// √(x² + y²) = u.
    Distance([Form; 2], Interval),
    /// cos(angle) x + sin(angle) y = u.
    Projection(Angle, [Form; 2], Interval),
}

impl Closure {
    pub(super) fn forms(&self) -> &[Form] {
        match self {
            Self::Sum(form) => std::slice::from_ref(form),
            Self::Distance(forms, _) | Self::Projection(_, forms, _) => forms,
        }
    }

    /// Returns whether the row contains a torn angle.
    pub(super) fn contains(&self, torn: usize) -> bool {
        let zero = [Interval::point(0.0); 2];
        let turns = matches!(self, Self::Projection(Angle::Torn(k, _), ..) if *k == torn);
        turns || self.forms().iter().any(|form| form.waves[torn] != zero)
    }

    /// Drops the waves of torn angles that are eliminated.
    pub(super) fn keep(&mut self, kept: &[usize]) {
        let forms: &mut [Form] = match self {
            Self::Sum(form) => std::slice::from_mut(form),
            Self::Distance(forms, _) | Self::Projection(_, forms, _) => forms,
        };
        for form in forms {
            form.waves = kept.iter().map(|&k| form.waves[k]).collect();
        }
        if let Self::Projection(Angle::Torn(torn, _), ..) = self {
            *torn = kept.iter().position(|k| k == torn).unwrap_or_default();
        }
    }

    /// Returns whether the row is bounded away from zero by more than `margin` in a box of angles.
    pub(super) fn excludes(&self, angles: &[Interval], margin: f64) -> bool {
        let value = match self {
            // The bound of the distance is sharper than that of its square.
            Self::Distance([x, y], u) => x.over(angles).hypot(y.over(angles)) - *u,
            _ => self.over(angles),
        };
        // A range that is not defined excludes nothing.
        value.low > margin || value.high < -margin
    }

    /// Returns the range of the row over a box; the row of a distance u is (x² + y² − u²)/(2u).
    pub(super) fn over(&self, angles: &[Interval]) -> Interval {
        match self {
            Self::Sum(form) => form.over(angles),
            Self::Distance([x, y], u) => {
                let squares = x.over(angles).square() + y.over(angles).square();
                (squares - u.square()) / (*u + *u)
            }
            Self::Projection(angle, [x, y], u) => {
                let angle = angle.over(angles);
                angle.cos() * x.over(angles) + angle.sin() * y.over(angles) - *u
            }
        }
    }

    /// Returns the range of its derivative by an angle.
    pub(super) fn slope(&self, by: usize, angles: &[Interval]) -> Interval {
        match self {
            Self::Sum(form) => form.slope(by, angles),
            Self::Distance([x, y], u) => {
                let half =
                    x.over(angles) * x.slope(by, angles) + y.over(angles) * y.slope(by, angles);
                half / *u
            }
            Self::Projection(angle, [x, y], _) => {
                let turns = matches!(angle, Angle::Torn(torn, _) if *torn == by);
                let angle = angle.over(angles);
                let (cos, sin) = (angle.cos(), angle.sin());
                let slope = cos * x.slope(by, angles) + sin * y.slope(by, angles);
                if turns {
                    slope + cos * y.over(angles) - sin * x.over(angles)
                } else {
                    slope
                }
            }
        }
    }
}
