//! The elimination of x and y of the bodies from the rows of a block.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;

use super::Loops;
use super::form::{Angle, Closure, Form};
use crate::kinematics::constraint::configuration::on_nearest_turn;
use crate::kinematics::constraint::{Axis, Projection, Relation};
use crate::kinematics::plan::BlockState;
use crate::kinematics::tolerances::CERTAIN_GAP;
use crate::mechanism::{Interval, MarkerId, Number};

/// Bound of the error of unknowns found before, scaled.
const SLACK: f64 = 1e-12;

/// The elimination of a block's unknowns.
pub(super) struct Builder<'a> {
    state: &'a BlockState<'a>,
    columns: BTreeSet<usize>,
    /// Rows that are not used yet.
    rows: Vec<usize>,
    /// Angles that are found, of the bodies whose angle is an unknown of the block.
    angles: BTreeMap<usize, Angle>,
    /// Unknowns x and y of the block that are found.
    places: BTreeMap<usize, Form>,
    torn: usize,
    /// Bound of the rounding of a row \[m\].
    margin: f64,
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

impl<'a> Builder<'a> {
    /// Begins the elimination.
    pub(super) fn new(rows: &[usize], columns: &[usize], state: &'a BlockState<'a>) -> Self {
        // Rows that share unknowns belong to one part.
        let size = rows
            .first()
            .map_or(0.0, |&row| state.system.equations()[row].size(state.at));
        Self {
            state,
            margin: CERTAIN_GAP * size,
            columns: columns.iter().copied().collect(),
            rows: rows.to_vec(),
            angles: BTreeMap::new(),
            places: BTreeMap::new(),
            torn: 0,
            links: Vec::new(),
        }
    }

    /// Returns the equations that are left; `None` if the block has rows or unknowns of other
    /// kinds.
    pub(super) fn loops(&mut self) -> Option<Loops> {
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
            margin: self.margin,
        })
    }

    /// Eliminates a torn angle that two rows contain as the direction of a link: they become one.
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
        // Either row may be the one of x.
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

    /// Returns the unknowns for given torn angles, on the turns nearest the estimates.
    pub(super) fn unknowns(
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
        // An angle may depend on one that was eliminated later.
        for link in self.links.iter().rev() {
            let [x, y] = [0, 1].map(|k| link.rest[k].over(&torn).midpoint());
            let [alpha, beta] = link.wave.map(Interval::midpoint);
            // (α, −β), turned by φ, is −(x, y).
            let phi = (-y).atan2(-x) - (-beta).atan2(alpha);
            torn[link.torn] = Interval::point(phi);
        }
        for (&body, angle) in &self.angles {
            // One body of those that turn together decides.
            if let Angle::Torn(k, offset) = angle
                && *offset == Interval::point(0.0)
            {
                let phi = torn[*k].midpoint();
                torn[*k] = Interval::point(on_nearest_turn(phi, estimate[3 * body + 2]));
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
        Relation::of(&*self.state.system.equations()[row].constraint)
    }

    fn target(&self, row: usize) -> Interval {
        let state = &self.state;
        Interval::point(state.system.target(row, state.targets, state.drivers))
    }

    fn body_of(&self, marker: MarkerId) -> Option<usize> {
        self.state.at.marker(marker).body.map(|body| body.index())
    }

    /// Returns the range of an unknown found before.
    fn known(&self, column: usize) -> Interval {
        let scale = self.state.system.column_scale(column, self.state.at.size());
        let value = self.state.at.coordinate(column);
        let slack = SLACK * (scale + value.abs());
        Interval::new(value - slack, value + slack)
    }

    /// Returns the direction of a marker, if the angle of its body is found.
    fn direction(&self, marker: MarkerId) -> Option<Angle> {
        let own = Interval::point(self.state.at.local(marker).1);
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

    /// Uses the first row for which `use_row` returns true. Returns whether there is one.
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

    /// Ties angles together by the rows that hold their difference, and tears the rest. `None` if a
    /// row of angles is left.
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
        let own = |marker| Interval::point(self.state.at.local(marker).1);
        let found = match (self.direction(measured.from), self.direction(measured.to)) {
            (Some(from), None) => (measured.to, from.plus(target - own(measured.to))),
            (None, Some(to)) => (measured.from, to.plus(-target - own(measured.from))),
            _ => return false,
        };
        let body = self.body_of(found.0);
        body.map(|body| self.angles.insert(body, found.1)).is_some()
    }

    /// Finds x and y by the rows that contain them with a factor of one: first by those that hold
    /// points together, so that lines are left as equations.
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

    /// Returns x or y of a body's origin, if it is found.
    fn origin(&self, column: usize) -> Option<Form> {
        if self.columns.contains(&column) {
            self.places.get(&column).cloned()
        } else {
            Some(Form::constant(self.known(column), self.torn))
        }
    }

    /// Returns x (0) or y (1) of a marker's arm.
    fn arm(&self, marker: MarkerId, component: usize) -> Option<Form> {
        let s = self.state.at.local(marker).0;
        let body = self.body_of(marker)?;
        self.turned(
            [s.x, s.y].map(Interval::point),
            self.angle(body)?,
            component,
        )
    }

    /// Returns x or y of a vector turned by an angle.
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

    /// Returns x or y of a marker's point, if it is found.
    fn point(&self, marker: MarkerId, component: usize) -> Option<Form> {
        let Some(body) = self.body_of(marker) else {
            let s = self.state.at.local(marker).0;
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

    /// Returns the one of two ends whose point is not found, and where x or y of that is, `off`
    /// beyond the first end's.
    fn unplaced(
        &self,
        ends: [MarkerId; 2],
        component: usize,
        off: &Form,
    ) -> Option<(MarkerId, Form)> {
        match ends.map(|marker| self.point(marker, component)) {
            [Some(from), None] => Some((ends[1], from.plus(off, Interval::point(1.0)))),
            [None, Some(to)] => Some((ends[0], to.minus(off))),
            _ => None,
        }
    }

    /// Places the body of the end whose point is not found.
    fn place_end(&mut self, ends: [MarkerId; 2], component: usize, off: &Form) -> bool {
        let unplaced = self.unplaced(ends, component, off);
        unplaced.is_some_and(|(marker, point)| self.place(marker, component, point))
    }

    fn join_points(&mut self, row: usize) -> bool {
        let Relation::Coincidence(joined) = self.relation(row) else {
            return false;
        };
        let component = usize::from(joined.axis == Axis::Y);
        let off = Form::constant(self.target(row), self.torn);
        self.place_end([joined.from, joined.to], component, &off)
    }

    /// Places a body by a pair of rows on the same axes.
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
            let Some(end) = self.unplaced([along.from, along.to], component, &off) else {
                return false;
            };
            placed.push(end);
        }
        let mut done = true;
        for (component, (marker, point)) in placed.into_iter().enumerate() {
            done &= self.place(marker, component, point);
        }
        self.rows.retain(|&unused| unused != other);
        done
    }

    /// Places a body by a row along x or y of ground.
    fn place_on_line(&mut self, row: usize) -> bool {
        let Relation::Projection(on) = self.relation(row) else {
            return false;
        };
        if self.body_of(on.axes).is_some() {
            return false;
        }
        let u = self.state.at.marker(on.axes).axis;
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
        self.place_end([on.from, on.to], component, &off)
    }

    /// Returns the equations of the rows that are left.
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

    /// Returns the unused row along the other one of the same axes.
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

    /// Returns two rows on the same axes as rows of x and y on those of ground.
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

    /// Returns x or y from one marker's point to the point of another.
    fn between(&self, from: MarkerId, to: MarkerId, component: usize) -> Option<Form> {
        Some(
            self.point(to, component)?
                .minus(&self.point(from, component)?),
        )
    }

    /// Returns the equation of a row that is left.
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
