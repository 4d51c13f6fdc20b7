//! All the ways in which a block closes, by bounds over intervals: its angles are divided into
//! boxes until each holds no solution, as an equation has a bound that keeps it from zero, or
//! exactly one, by Krawczyk's test.
//!
//! Given the angles, the rows that hold points together give x and y of each body as a sum of
//! constants and of waves α cos φ + β sin φ, one an angle, whose range over an interval is known
//! in closed form. The rows that are left must be zero. An angle that only says where a link of a
//! known length points is eliminated as well: its two rows become one, of a distance.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::{PI, TAU};

use nalgebra::DMatrix;

use crate::kinematics::constraint::{Axis, Projection, Relation};
use crate::kinematics::plan::Work;
use crate::mechanism::{Interval, MarkerId, Scalar};

/// A block of more unknowns has too many angles for boxes.
const MOST_UNKNOWNS: usize = 60;
/// Into so many boxes angles are divided at the most.
const MOST_BOXES: usize = 10_000;
/// A box narrower than this \[rad\] is not divided: there the block nearly closes, or closes in a
/// nearly singular position.
const NARROWEST: f64 = 1e-6;
/// Krawczyk's test is of use in boxes narrower than this \[rad\].
const NARROW: f64 = 1.0;
/// By how much of its width a box is enlarged for that test: a solution may lie on its edge.
const ENLARGED: f64 = 0.1;
/// Angles that differ by less than this, in boxes known to hold one solution, are of the same.
const SAME: f64 = 1e-7;
/// How far off, scaled, what was found before may be.
const SLACK: f64 = 1e-12;
/// A gap below this, scaled, may be rounding.
const MARGIN: f64 = 1e-10;

/// The ways in which a block closes.
#[derive(Debug)]
pub(super) struct AllWays {
    /// The unknowns in the order of the block's columns, near a solution each; all there are.
    /// `None` if that could not be proved.
    pub(super) ways: Option<Vec<Vec<f64>>>,
    /// Into how many boxes the angles were divided.
    pub(super) boxes: usize,
}

/// Finds all ways in which the rows close in the unknowns `columns`. All other unknowns are known
/// in `work`.
pub(super) fn all_ways(
    rows: &[usize],
    columns: &[usize],
    work: &Work<'_>,
    estimate: &[f64],
) -> AllWays {
    let unknown = AllWays {
        ways: None,
        boxes: 0,
    };
    let bodies = work.system.mechanism().bodies.len();
    let from_joints = columns.iter().any(|&column| column >= 3 * bodies);
    if from_joints || columns.len() > MOST_UNKNOWNS {
        return unknown;
    }
    let mut builder = Builder {
        work,
        columns: columns.iter().copied().collect(),
        rows: rows.to_vec(),
        angles: BTreeMap::new(),
        places: BTreeMap::new(),
        torn: 0,
        links: Vec::new(),
    };
    let Some(loops) = builder.loops() else {
        return unknown;
    };
    let (solutions, boxes) = loops.solve();
    let ways = solutions.and_then(|solutions| {
        let at = |angles: &Vec<f64>| builder.unknowns(columns, &loops.kept, angles, estimate);
        solutions.iter().map(at).collect()
    });
    AllWays { ways, boxes }
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

impl Form {
    /// The range of its derivative by an angle over a box.
    fn slope(&self, angle: usize, angles: &[Interval]) -> Interval {
        let [alpha, beta] = self.waves[angle];
        range([beta, -alpha], angles[angle])
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

impl Closure {
    fn forms(&self) -> &[Form] {
        match self {
            Self::Sum(form) => std::slice::from_ref(form),
            Self::Distance(forms, _) | Self::Projection(_, forms, _) => forms,
        }
    }

    /// Whether a torn angle is in the row.
    fn contains(&self, torn: usize) -> bool {
        let zero = [Interval::point(0.0); 2];
        let turns = matches!(self, Self::Projection(Angle::Torn(k, _), ..) if *k == torn);
        turns || self.forms().iter().any(|form| form.waves[torn] != zero)
    }

    /// Counts only the torn angles that are left.
    fn keep(&mut self, kept: &[usize]) {
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

    /// Whether the row has no zero in a box of angles, by more than `margin`.
    fn excludes(&self, angles: &[Interval], margin: f64) -> bool {
        let value = match self {
            // Sharper than the square of the distance.
            Self::Distance([x, y], u) => x.over(angles).hypot(y.over(angles)) - *u,
            _ => self.over(angles),
        };
        // What is not defined contains everything.
        value.low > margin || value.high < -margin
    }

    /// The range of the row over a box; that of a distance u is (x² + y² − u²)/(2u).
    fn over(&self, angles: &[Interval]) -> Interval {
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

    /// The range of its derivative by an angle.
    fn slope(&self, by: usize, angles: &[Interval]) -> Interval {
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

/// The equations of a block in its torn angles.
#[derive(Debug)]
struct Loops {
    /// The torn angles that are left.
    kept: Vec<usize>,
    closures: Vec<Closure>,
    /// What a row may be off by \[m\].
    margin: f64,
}

/// What is known of a box of angles.
enum Content {
    /// It holds no solution.
    None,
    /// A box around it holds exactly one, near here.
    One(Vec<f64>),
    Unknown,
}

impl Loops {
    /// All solutions in the angles kept, or `None` if some box could not be decided, and the
    /// number of boxes.
    fn solve(&self) -> (Option<Vec<Vec<f64>>>, usize) {
        let half_turn = PI.next_up();
        let mut boxes = vec![vec![Interval::new(-half_turn, half_turn); self.kept.len()]];
        let mut solutions: Vec<Vec<f64>> = Vec::new();
        let mut count = 0;
        let width = |angle: &Interval| angle.high - angle.low;
        while let Some(angles) = boxes.pop() {
            count += 1;
            match self.content(&angles) {
                Content::None => continue,
                Content::One(found) => {
                    let same = |known: &Vec<f64>| {
                        let mut pairs = known.iter().zip(&found);
                        pairs.all(|(a, b)| (a - b - TAU * ((a - b) / TAU).round()).abs() < SAME)
                    };
                    if !solutions.iter().any(same) {
                        solutions.push(found);
                    }
                    continue;
                }
                Content::Unknown => {}
            }
            let widest = (0..angles.len()).max_by(|&a, &b| {
                let widths = [a, b].map(|k| width(&angles[k]));
                widths[0].total_cmp(&widths[1]).then(b.cmp(&a))
            });
            let widest = widest.filter(|&k| width(&angles[k]) > NARROWEST);
            let Some(widest) = widest.filter(|_| count + boxes.len() < MOST_BOXES) else {
                return (None, count);
            };
            let middle = angles[widest].midpoint();
            let (mut low, mut high) = (angles.clone(), angles);
            low[widest] = Interval::new(low[widest].low, middle);
            high[widest] = Interval::new(middle, high[widest].high);
            boxes.extend([high, low]);
        }
        (Some(solutions), count)
    }

    fn content(&self, angles: &[Interval]) -> Content {
        let mut rows = self.closures.iter();
        if rows.any(|row| row.excludes(angles, self.margin)) {
            return Content::None;
        }
        if self.kept.is_empty() {
            return Content::One(Vec::new());
        }
        let narrow = angles.iter().all(|angle| angle.high - angle.low < NARROW);
        let mut around: Vec<_> = angles
            .iter()
            .map(|angle| {
                let more = ENLARGED * (angle.high - angle.low);
                Interval::new(angle.low - more, angle.high + more)
            })
            .collect();
        let Some(inner) = (narrow && self.closures.len() == self.kept.len())
            .then(|| self.contract(&around))
            .flatten()
        else {
            return Content::Unknown;
        };
        let misses = |(inner, around): (&Interval, &Interval)| {
            inner.low > around.high || inner.high < around.low
        };
        if inner.iter().zip(&around).any(misses) {
            return Content::None;
        }
        let inside = |(inner, around): (&Interval, &Interval)| {
            inner.low > around.low && inner.high < around.high
        };
        if !inner.iter().zip(&around).all(inside) {
            return Content::Unknown;
        }
        // The solution stays in, however often it is contracted.
        around = inner;
        for _ in 0..4 {
            if let Some(inner) = self.contract(&around) {
                let both = around.iter().zip(inner).map(|(a, b)| a.intersection(b));
                let both: Vec<_> = both.collect();
                if both.iter().all(|angle| angle.is_finite()) {
                    around = both;
                }
            }
        }
        Content::One(around.iter().map(|angle| angle.midpoint()).collect())
    }

    /// Krawczyk's operator: m − Y f(m) + (1 − Y J)(x − m) contains all solutions in the box x, m
    /// being its middle and Y near the inverse of J(m). Inside x it proves that there is one and
    /// only one.
    fn contract(&self, angles: &[Interval]) -> Option<Vec<Interval>> {
        let order = self.kept.len();
        let middle: Vec<_> = angles
            .iter()
            .map(|x| Interval::point(x.midpoint()))
            .collect();
        let slope = |row: usize, col: usize, at: &[Interval]| self.closures[row].slope(col, at);
        let inverse =
            DMatrix::from_fn(order, order, |row, col| slope(row, col, &middle).midpoint())
                .try_inverse()?;
        let values: Vec<_> = self.closures.iter().map(|row| row.over(&middle)).collect();
        let slopes: Vec<Vec<_>> = (0..order)
            .map(|row| (0..order).map(|col| slope(row, col, angles)).collect())
            .collect();
        let zero = Interval::point(0.0);
        let contracted: Vec<_> = (0..order)
            .map(|k| {
                let newton =
                    (0..order).fold(middle[k], |sum, row| sum - values[row] * inverse[(k, row)]);
                (0..order).fold(newton, |sum, col| {
                    let product = (0..order)
                        .fold(zero, |sum, row| sum + slopes[row][col] * inverse[(k, row)]);
                    let unit = Interval::point(f64::from(u8::from(k == col)));
                    sum + (unit - product) * (angles[col] - middle[col])
                })
            })
            .collect();
        contracted
            .iter()
            .all(|x| x.is_finite())
            .then_some(contracted)
    }
}

/// Eliminates what it can of a block's unknowns.
struct Builder<'a> {
    work: &'a Work<'a>,
    columns: BTreeSet<usize>,
    /// Those that are not used yet.
    rows: Vec<usize>,
    /// Of the bodies whose angle is an unknown of the block.
    angles: BTreeMap<usize, Angle>,
    /// The unknowns x and y of the block that are found.
    places: BTreeMap<usize, Form>,
    torn: usize,
    /// Torn angles that were eliminated.
    links: Vec<Link>,
}

/// A torn angle in two rows x + α cos φ + β sin φ = 0 and y − β cos φ + α sin φ = 0.
#[derive(Debug)]
struct Link {
    torn: usize,
    /// α and β.
    wave: [Interval; 2],
    /// x and y.
    rest: [Form; 2],
}

impl Builder<'_> {
    /// The equations that are left; `None` if the block has rows or unknowns of other kinds.
    fn loops(&mut self) -> Option<Loops> {
        self.find_angles()?;
        self.find_places();
        let mut closures = self.closures()?;
        let mut kept: Vec<_> = (0..self.torn).collect();
        for torn in (0..self.torn).rev() {
            if kept.len() > 1 && self.eliminate(torn, &mut closures) {
                kept.retain(|&other| other != torn);
            }
        }
        for closure in &mut closures {
            closure.keep(&kept);
        }
        Some(Loops {
            kept,
            closures,
            margin: MARGIN * self.work.at.size(),
        })
    }

    /// Eliminates a torn angle that two rows contain as that of a link: they become one.
    fn eliminate(&mut self, torn: usize, closures: &mut Vec<Closure>) -> bool {
        let with: Vec<_> = (0..closures.len())
            .filter(|&k| closures[k].contains(torn))
            .collect();
        let [first, second] = with[..] else {
            return false;
        };
        let (Closure::Sum(a), Closure::Sum(b)) = (&closures[first], &closures[second]) else {
            return false;
        };
        // Either may be that of x.
        let is_pair = |x: &Form, y: &Form| {
            let ([alpha, beta], turned) = (x.waves[torn], y.waves[torn]);
            turned == [-beta, alpha]
        };
        let (x, y) = match (is_pair(a, b), is_pair(b, a)) {
            (true, _) => (a, b),
            (_, true) => (b, a),
            _ => return false,
        };
        let wave = x.waves[torn];
        let length = wave[0].hypot(wave[1]);
        if length.low <= 0.0 {
            return false;
        }
        let rest = [x, y].map(|form| {
            let mut form = form.clone();
            form.waves[torn] = [Interval::point(0.0); 2];
            form
        });
        self.links.push(Link {
            torn,
            wave,
            rest: rest.clone(),
        });
        closures[first] = Closure::Distance(rest, length);
        closures.remove(second);
        true
    }

    /// The unknowns for given torn angles, on the turns nearest the estimates.
    fn unknowns(
        &self,
        columns: &[usize],
        kept: &[usize],
        angles: &[f64],
        estimate: &[f64],
    ) -> Option<Vec<f64>> {
        let mut torn = vec![Interval::point(0.0); self.torn];
        for (&k, &angle) in kept.iter().zip(angles) {
            torn[k] = Interval::point(angle);
        }
        // Those eliminated later may be needed for those before.
        for link in self.links.iter().rev() {
            let [x, y] = [0, 1].map(|k| link.rest[k].over(&torn).midpoint());
            let [alpha, beta] = link.wave.map(Interval::midpoint);
            // (α, −β), turned by φ, is −(x, y).
            let phi = (-y).atan2(-x) - (-beta).atan2(alpha);
            torn[link.torn] = Interval::point(phi);
        }
        for (&body, angle) in &self.angles {
            // One of those that turn together decides.
            if let Angle::Torn(k, offset) = angle
                && *offset == Interval::point(0.0)
            {
                let phi = torn[*k].midpoint();
                let turns = ((estimate[3 * body + 2] - phi) / TAU).round();
                torn[*k] = Interval::point(phi + TAU * turns);
            }
        }
        let value = |column: &usize| {
            let range = if column % 3 == 2 {
                self.angle(column / 3)?.over(&torn)
            } else {
                self.origin(*column)?.over(&torn)
            };
            Some(range.midpoint())
        };
        columns.iter().map(value).collect()
    }

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
        let Some(other) = self.place_on_same_axes(row) else {
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

    /// What the rows that are left ask for.
    fn closures(&mut self) -> Option<Vec<Closure>> {
        let mut closures = Vec::new();
        while let Some(row) = self.rows.pop() {
            let other = self.place_on_same_axes(row);
            match other {
                Some(other) => {
                    self.rows.retain(|&unused| unused != other);
                    closures.extend(self.pair(row, other)?);
                }
                None => closures.push(self.closure(row)?),
            }
        }
        Some(closures)
    }

    /// The unused row that gives the other place on the same axes.
    fn place_on_same_axes(&self, row: usize) -> Option<usize> {
        let Relation::Projection(on) = self.relation(row) else {
            return None;
        };
        let other = Relation::Projection(Projection {
            axis: match on.axis {
                Axis::X => Axis::Y,
                Axis::Y => Axis::X,
            },
            ..on
        });
        let mut rows = self.rows.iter().copied();
        rows.find(|&unused| self.relation(unused) == other)
    }

    /// Two rows that give both places on the same axes, as x and y on those of ground.
    fn pair(&self, row: usize, other: usize) -> Option<[Closure; 2]> {
        let Relation::Projection(on) = self.relation(row) else {
            return None;
        };
        let mut off = [row, other].map(|row| self.target(row));
        if on.axis == Axis::Y {
            off.swap(0, 1);
        }
        let axes = self.direction(on.axes)?;
        let sum = |component| {
            let off = self.turned(off, axes, component)?;
            let between = self.between(on.from, on.to, component)?;
            Some(Closure::Sum(between.minus(&off)))
        };
        Some([sum(0)?, sum(1)?])
    }

    /// x or y from one marker's point to that of another.
    fn between(&self, from: MarkerId, to: MarkerId, component: usize) -> Option<Form> {
        Some(
            self.point(to, component)?
                .minus(&self.point(from, component)?),
        )
    }

    /// What a row that is left asks for.
    fn closure(&self, row: usize) -> Option<Closure> {
        let both = |from, to| Some([self.between(from, to, 0)?, self.between(from, to, 1)?]);
        let target = self.target(row);
        Some(match self.relation(row) {
            Relation::Coincidence(joined) => {
                let component = usize::from(joined.axis == Axis::Y);
                let off = Form::constant(target, self.torn);
                let between = self.between(joined.from, joined.to, component)?;
                Closure::Sum(between.minus(&off))
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
