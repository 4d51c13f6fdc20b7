//! A proof that a block has no solution: its angles are divided into boxes until in each of them
//! an equation has a bound that keeps it from zero.
//!
//! Given the angles, the rows that hold points together give x and y of each body as a sum of
//! constants and of waves α cos φ + β sin φ, one an angle, whose range over an interval is known
//! in closed form. The rows that are left must contain zero.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use crate::kinematics::constraint::{Axis, Projection, Relation};
use crate::kinematics::plan::Work;
use crate::mechanism::{Interval, MarkerId, Scalar};

/// Into so many boxes angles are divided at the most.
const MOST_BOXES: usize = 20_000;
/// A box narrower than this \[rad\] is not divided: there the block closes, or nearly so.
const NARROWEST: f64 = 1e-6;
/// How far off, scaled, what was found before may be.
const SLACK: f64 = 1e-12;
/// A gap below this, scaled, may be rounding.
const MARGIN: f64 = 1e-10;

/// Whether the rows have no solution in the unknowns, and into how many boxes their angles had to
/// be divided. All other unknowns are known in `work`.
pub(in crate::kinematics) fn exclude(
    rows: &[usize],
    columns: &[usize],
    work: &Work<'_>,
) -> (bool, usize) {
    let Some(loops) = Loops::new(rows, columns, work) else {
        return (false, 0);
    };
    let whole = vec![Interval::new(-PI.next_up(), PI.next_up()); loops.torn];
    let mut boxes = vec![whole];
    let mut count = 0;
    while let Some(angles) = boxes.pop() {
        count += 1;
        if loops.exclude(&angles) {
            continue;
        }
        let width = |angle: &Interval| angle.high - angle.low;
        let widest = (0..angles.len()).max_by(|&a, &b| {
            let widths = [a, b].map(|k| width(&angles[k]));
            widths[0].total_cmp(&widths[1]).then(b.cmp(&a))
        });
        let Some(widest) = widest.filter(|&k| width(&angles[k]) > NARROWEST) else {
            return (false, count);
        };
        if count + boxes.len() >= MOST_BOXES {
            return (false, count);
        }
        let middle = angles[widest].midpoint();
        let (mut low, mut high) = (angles.clone(), angles);
        low[widest] = Interval::new(low[widest].low, middle);
        high[widest] = Interval::new(middle, high[widest].high);
        boxes.extend([high, low]);
    }
    (true, count)
}

/// The angle of a body.
#[derive(Clone, Copy, Debug)]
enum Angle {
    Known(Interval),
    /// A torn angle and what is added to it.
    Torn(usize, Interval),
}

impl Angle {
    fn plus(self, turn: Interval) -> Self {
        match self {
            Self::Known(angle) => Self::Known(angle + turn),
            Self::Torn(torn, offset) => Self::Torn(torn, offset + turn),
        }
    }

    fn over(self, angles: &[Interval]) -> Interval {
        match self {
            Self::Known(angle) => angle,
            Self::Torn(torn, offset) => angles[torn] + offset,
        }
    }
}

/// A constant and α cos φ + β sin φ for each torn angle.
#[derive(Clone, Debug)]
struct Form {
    constant: Interval,
    waves: Vec<[Interval; 2]>,
}

impl Form {
    fn constant(constant: Interval, torn: usize) -> Self {
        Self {
            constant,
            waves: vec![[Interval::point(0.0); 2]; torn],
        }
    }

    /// self + other · factor.
    fn plus(mut self, other: &Self, factor: Interval) -> Self {
        self.constant = self.constant + other.constant * factor;
        for (wave, other) in self.waves.iter_mut().zip(&other.waves) {
            for (part, other) in wave.iter_mut().zip(other) {
                *part = *part + *other * factor;
            }
        }
        self
    }

    fn minus(self, other: &Self) -> Self {
        self.plus(other, Interval::point(-1.0))
    }

    /// Its range over a box of angles.
    fn over(&self, angles: &[Interval]) -> Interval {
        let waves = self.waves.iter().zip(angles);
        waves.fold(self.constant, |sum, (wave, angle)| {
            sum + range(*wave, *angle)
        })
    }
}

/// The range of α cos φ + β sin φ.
fn range([alpha, beta]: [Interval; 2], phi: Interval) -> Interval {
    let zero = |x: Interval| x.low == 0.0 && x.high == 0.0;
    if zero(alpha) && zero(beta) {
        return Interval::point(0.0);
    }
    let parts = alpha * phi.cos() + beta * phi.sin();
    // √(α² + β²) cos(φ − atan2(β, α)), from the side on which the angle does not jump.
    let amplitude = alpha.hypot(beta);
    let wave = if alpha.low > 0.0 || beta.low > 0.0 || beta.high < 0.0 {
        amplitude * (phi - beta.atan2(alpha)).cos()
    } else {
        -(amplitude * (phi - (-beta).atan2(-alpha)).cos())
    };
    let both = parts.intersection(wave);
    if both.is_finite() { both } else { parts }
}

/// A row that is left once x and y are eliminated.
#[derive(Debug)]
enum Closure {
    /// form = 0.
    Sum(Form),
    /// √(x² + y²) = u.
    Distance([Form; 2], Interval),
    /// cos(angle) x + sin(angle) y = u.
    Projection(Angle, [Form; 2], Interval),
}

/// The equations of a block in its torn angles.
#[derive(Debug)]
struct Loops {
    torn: usize,
    closures: Vec<Closure>,
    /// What a row may be off by \[m\].
    margin: f64,
}

impl Loops {
    /// `None` if the block has rows or unknowns of other kinds.
    fn new(rows: &[usize], columns: &[usize], work: &Work<'_>) -> Option<Self> {
        let mut builder = Builder {
            work,
            columns: columns.iter().copied().collect(),
            rows: rows.to_vec(),
            angles: BTreeMap::new(),
            places: BTreeMap::new(),
            torn: 0,
        };
        let bodies = work.system.mechanism().bodies.len();
        if columns.iter().any(|&column| column >= 3 * bodies) {
            return None;
        }
        builder.find_angles()?;
        builder.find_places();
        let closures: Option<Vec<_>> = builder
            .rows
            .iter()
            .map(|&row| builder.closure(row))
            .collect();
        Some(Self {
            torn: builder.torn,
            closures: closures?,
            margin: MARGIN * work.at.size(),
        })
    }

    /// Whether an equation has no solution in a box of angles.
    fn exclude(&self, angles: &[Interval]) -> bool {
        self.closures.iter().any(|closure| {
            let value = match closure {
                Closure::Sum(form) => form.over(angles),
                Closure::Distance([x, y], u) => x.over(angles).hypot(y.over(angles)) - *u,
                Closure::Projection(angle, [x, y], u) => {
                    let angle = angle.over(angles);
                    angle.cos() * x.over(angles) + angle.sin() * y.over(angles) - *u
                }
            };
            // What is not defined contains everything.
            value.low > self.margin || value.high < -self.margin
        })
    }
}

/// Eliminates what it can of a block's unknowns.
struct Builder<'a> {
    work: &'a Work<'a>,
    columns: std::collections::BTreeSet<usize>,
    /// Those that are not used yet.
    rows: Vec<usize>,
    /// Of the bodies whose angle is an unknown of the block.
    angles: BTreeMap<usize, Angle>,
    /// The unknowns x and y of the block that are found.
    places: BTreeMap<usize, Form>,
    torn: usize,
}

impl Builder<'_> {
    fn relation(&self, row: usize) -> Relation {
        self.work.system.equations()[row].constraint.relation()
    }

    fn target(&self, row: usize) -> Interval {
        let Work {
            system,
            targets,
            drivers,
            ..
        } = self.work;
        Interval::point(system.target(row, targets, drivers))
    }

    fn body_of(&self, marker: MarkerId) -> Option<usize> {
        self.work.at.marker(marker).body.map(|body| body.index())
    }

    /// A value found before.
    fn known(&self, column: usize) -> Interval {
        let scale = self.work.system.column_scale(column, self.work.at.size());
        let value = self.work.at.coordinate(column);
        let slack = SLACK * (scale + value.abs());
        Interval::new(value - slack, value + slack)
    }

    /// The direction of a marker, if that of its body is found.
    fn direction(&self, marker: MarkerId) -> Option<Angle> {
        let own = Interval::point(self.work.at.local(marker).1);
        Some(match self.body_of(marker) {
            None => Angle::Known(own),
            Some(body) => self.angle(body)?.plus(own),
        })
    }

    fn angle(&self, body: usize) -> Option<Angle> {
        if self.columns.contains(&(3 * body + 2)) {
            self.angles.get(&body).copied()
        } else {
            Some(Angle::Known(self.known(3 * body + 2)))
        }
    }

    /// Takes the first unused row for which `use_row` finds something.
    fn use_one(&mut self, use_row: impl Fn(&mut Self, usize) -> bool) -> bool {
        for place in 0..self.rows.len() {
            let row = self.rows[place];
            if use_row(self, row) {
                self.rows.retain(|&other| other != row);
                return true;
            }
        }
        false
    }

    /// Ties angles together by the rows that hold their difference; the rest is torn. `None` if
    /// that leaves a row of angles.
    fn find_angles(&mut self) -> Option<()> {
        let bodies: Vec<_> = self
            .columns
            .iter()
            .filter(|&column| column % 3 == 2)
            .map(|column| column / 3)
            .collect();
        for body in bodies {
            while self.use_one(Self::tie_angle) {}
            if !self.angles.contains_key(&body) {
                let root = Angle::Torn(self.torn, Interval::point(0.0));
                self.angles.insert(body, root);
                self.torn += 1;
            }
        }
        while self.use_one(Self::tie_angle) {}
        let left = self.rows.iter();
        let mut left = left.map(|&row| self.relation(row));
        left.all(|relation| !matches!(relation, Relation::Angle(_) | Relation::Other))
            .then_some(())
    }

    fn tie_angle(&mut self, row: usize) -> bool {
        let Relation::Angle(measured) = self.relation(row) else {
            return false;
        };
        let target = self.target(row);
        let own = |marker| Interval::point(self.work.at.local(marker).1);
        let found = match (self.direction(measured.from), self.direction(measured.to)) {
            (Some(from), None) => (measured.to, from.plus(target - own(measured.to))),
            (None, Some(to)) => (measured.from, to.plus(-target - own(measured.from))),
            _ => return false,
        };
        let body = self.body_of(found.0);
        body.map(|body| self.angles.insert(body, found.1)).is_some()
    }

    /// Finds x and y along the rows that give them with a factor of one: first those that hold
    /// points together, so that a line is left to be met.
    fn find_places(&mut self) {
        loop {
            let found = self.use_one(Self::join_points)
                || self.use_one(Self::place_on_axes)
                || self.use_one(Self::place_on_line);
            if !found {
                break;
            }
        }
    }

    /// x or y of a body's origin.
    fn origin(&self, column: usize) -> Option<Form> {
        if self.columns.contains(&column) {
            self.places.get(&column).cloned()
        } else {
            Some(Form::constant(self.known(column), self.torn))
        }
    }

    /// x (0) or y (1) of a marker's arm.
    fn arm(&self, marker: MarkerId, component: usize) -> Option<Form> {
        let s = self.work.at.local(marker).0;
        let body = self.body_of(marker)?;
        self.turned(
            [s.x, s.y].map(Interval::point),
            self.angle(body)?,
            component,
        )
    }

    /// x or y of a vector turned by an angle.
    fn turned(&self, s: [Interval; 2], angle: Angle, component: usize) -> Option<Form> {
        let turn = |angle: Interval| {
            let (cos, sin) = (angle.cos(), angle.sin());
            [cos * s[0] - sin * s[1], sin * s[0] + cos * s[1]]
        };
        Some(match angle {
            Angle::Known(angle) => Form::constant(turn(angle)[component], self.torn),
            Angle::Torn(torn, offset) => {
                let [x, y] = if offset == Interval::point(0.0) {
                    s
                } else {
                    turn(offset)
                };
                let mut form = Form::constant(Interval::point(0.0), self.torn);
                form.waves[torn] = if component == 0 { [x, -y] } else { [y, x] };
                form
            }
        })
    }

    /// x or y of a marker's point, if it is found.
    fn point(&self, marker: MarkerId, component: usize) -> Option<Form> {
        let Some(body) = self.body_of(marker) else {
            let s = self.work.at.local(marker).0;
            return Some(Form::constant(Interval::point(s[component]), self.torn));
        };
        let origin = self.origin(3 * body + component)?;
        Some(origin.plus(&self.arm(marker, component)?, Interval::point(1.0)))
    }

    /// Places the origin of a marker's body, so that its point is at `point`.
    fn place(&mut self, marker: MarkerId, component: usize, point: Form) -> bool {
        let (Some(body), Some(arm)) = (self.body_of(marker), self.arm(marker, component)) else {
            return false;
        };
        self.places.insert(3 * body + component, point.minus(&arm));
        true
    }

    fn join_points(&mut self, row: usize) -> bool {
        let Relation::Coincidence(joined) = self.relation(row) else {
            return false;
        };
        let component = usize::from(joined.axis == Axis::Y);
        let off = Form::constant(self.target(row), self.torn);
        let ends = [joined.from, joined.to].map(|marker| self.point(marker, component));
        match ends {
            [Some(from), None] => {
                let point = from.plus(&off, Interval::point(1.0));
                self.place(joined.to, component, point)
            }
            [None, Some(to)] => self.place(joined.from, component, to.minus(&off)),
            _ => false,
        }
    }

    /// A pair of rows that give both places on the same axes.
    fn place_on_axes(&mut self, row: usize) -> bool {
        let Relation::Projection(along @ Projection { axis: Axis::X, .. }) = self.relation(row)
        else {
            return false;
        };
        let across = Projection {
            axis: Axis::Y,
            ..along
        };
        let mut others = self.rows.iter().copied();
        let Some(other) =
            others.find(|&other| self.relation(other) == Relation::Projection(across))
        else {
            return false;
        };
        let Some(axes) = self.direction(along.axes) else {
            return false;
        };
        let off = [self.target(row), self.target(other)];
        let mut placed = Vec::new();
        for component in [0, 1] {
            let Some(off) = self.turned(off, axes, component) else {
                return false;
            };
            let ends = [along.from, along.to].map(|marker| self.point(marker, component));
            placed.push(match ends {
                [Some(from), None] => (along.to, from.plus(&off, Interval::point(1.0))),
                [None, Some(to)] => (along.from, to.minus(&off)),
                _ => return false,
            });
        }
        let mut done = true;
        for (component, (marker, point)) in placed.into_iter().enumerate() {
            done &= self.place(marker, component, point);
        }
        self.rows.retain(|&unused| unused != other);
        done
    }

    /// A line along x or y of ground.
    fn place_on_line(&mut self, row: usize) -> bool {
        let Relation::Projection(on) = self.relation(row) else {
            return false;
        };
        if self.body_of(on.axes).is_some() {
            return false;
        }
        let u = self.work.at.marker(on.axes).axis;
        let e = match on.axis {
            Axis::X => [u.x, u.y],
            Axis::Y => [-u.y, u.x],
        };
        let component = match e {
            [_, 0.0] => 0,
            [0.0, _] => 1,
            _ => return false,
        };
        let off = Form::constant(self.target(row) * Interval::point(e[component]), self.torn);
        let ends = [on.from, on.to].map(|marker| self.point(marker, component));
        match ends {
            [Some(from), None] => {
                let point = from.plus(&off, Interval::point(1.0));
                self.place(on.to, component, point)
            }
            [None, Some(to)] => self.place(on.from, component, to.minus(&off)),
            _ => false,
        }
    }

    /// What a row that is left asks for.
    fn closure(&self, row: usize) -> Option<Closure> {
        let between = |from, to, component| {
            Some(
                self.point(to, component)?
                    .minus(&self.point(from, component)?),
            )
        };
        let both = |from, to| Some([between(from, to, 0)?, between(from, to, 1)?]);
        let target = self.target(row);
        Some(match self.relation(row) {
            Relation::Coincidence(joined) => {
                let component = usize::from(joined.axis == Axis::Y);
                let off = Form::constant(target, self.torn);
                Closure::Sum(between(joined.from, joined.to, component)?.minus(&off))
            }
            Relation::Distance(held) => Closure::Distance(both(held.from, held.to)?, target),
            Relation::Projection(on) => {
                let axes = self.direction(on.axes)?;
                let axes = match on.axis {
                    Axis::X => axes,
                    Axis::Y => {
                        axes.plus(Interval::new((0.5 * PI).next_down(), (0.5 * PI).next_up()))
                    }
                };
                Closure::Projection(axes, both(on.from, on.to)?, target)
            }
            Relation::Angle(_) | Relation::Other => return None,
        })
    }
}
