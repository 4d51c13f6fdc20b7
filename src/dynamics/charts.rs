//! The choice of coordinates in which the freedoms are integrated.
//!
//! A coordinate is of no use near its dead point, such as the angle of a rocker at the end of its
//! swing. The motion goes on in another one then: all freedoms and the relative coordinates of all
//! joints are candidates, and, where those do not tell the motion, the coordinates of all bodies, some of
//! which move wherever the mechanism does. A mechanism with one set of candidates as its freedoms is a
//! chart, with a solver of its own, which is compiled when it is first needed.

use std::ops::Range;
use std::sync::Arc;

use nalgebra::DMatrix;

use super::equations::Equations;
use super::error::Error;
use crate::kinematics::constraint::{Constraint, of_coordinate};
use crate::kinematics::{
    End, EquationsOfMotion, Forces, Path, RangeSettings, Rates, Solution, Solver,
};
use crate::mechanism::{
    Coordinate, CoordinateKind, DriverId, DriverSource, Jet, Joint, MarkerId, Mechanism,
};

/// The motion goes on in other coordinates if these move by so much, per unit of those in use:
/// their sines are below a third then, and the equations lose less than a digit.
const EXCHANGE: f64 = 3.0;
/// It returns to the file's own freedoms if these move by such a part of the best ones: more than
/// at the exchange, so that the two do not alternate.
const RETURN: f64 = 0.5;
/// It takes coordinates of bodies if these move by so much, per unit of the best of freedoms and joints:
/// joints that tell the motion with a digit less are preferred, as they cost the least and count turns
/// of their own. Nearer to a dead point steps become short; farther from it bodies that are geared up
/// would be taken without need.
const FAR: f64 = 10.0;
/// Part of the mechanism's size below which a distance is the worse a coordinate the smaller it is: it
/// has a corner at zero, which the motion leaves behind in some steps from there.
const NEAR_ZERO: f64 = 0.1;
/// Freedoms of the file that move by no more than such a part of the best coordinates are at a dead
/// point: half of the digits of what is expressed in them would be lost.
const NO_COORDINATES: f64 = 1e-8;

/// Returns whether the freedoms of a mechanism are good coordinates wherever it moves: each body is
/// placed by straight formulas, or the only one turns fully and passes no change point. An end of the
/// range, or a mechanism that does not assemble, denies it.
#[must_use]
pub fn keeps_coordinates(mechanism: &Arc<Mechanism>) -> bool {
    let path = Path::new(mechanism);
    let Ok(mut solver) = Solver::assembled(Arc::clone(mechanism), &path) else {
        return false;
    };
    if solver.is_explicit() || mechanism.drivers.len() > 1 {
        return solver.is_explicit();
    }
    let range = solver.range(DriverId(0), &RangeSettings::default());
    let turns = |end: &End| matches!(end, End::Turns(_));
    // A turn one way passes all poses of the other way.
    (turns(&range.lower) || turns(&range.upper)) && range.crossings.is_empty()
}

/// The charts of a mechanism.
#[derive(Debug)]
pub(super) struct Charts {
    freedoms: Vec<DriverId>,
    /// The file's freedoms, then the coordinates of joints, then those of bodies.
    candidates: Vec<Candidate>,
    /// Number of the candidates that are no coordinates of bodies.
    joints: usize,
    /// The candidates in use, one per freedom.
    current: Vec<usize>,
    /// Charts that are not in use.
    others: Vec<Chart>,
    /// Sets of candidates that are no coordinates of the mechanism.
    unfit: Vec<Vec<usize>>,
    /// ∂candidates/∂coordinates in use, scaled.
    changes: DMatrix<f64>,
    own: Volume,
    of_joints: Volume,
    all: Volume,
}

/// Work space for the choice of rows that span a large volume.
#[derive(Debug)]
struct Volume {
    rows: DMatrix<f64>,
    /// The row chosen for each column.
    chosen: Vec<usize>,
}

#[derive(Debug)]
struct Candidate {
    coordinate: Coordinate,
    relation: Box<dyn Constraint>,
}

impl Candidate {
    /// Returns a radian or the mechanism's size.
    fn scale(&self, size: f64) -> f64 {
        if self.coordinate.kind.is_angle() {
            1.0
        } else {
            size
        }
    }

    /// Returns its natural size where it has this value, larger the less it is fit there.
    fn scale_at(&self, value: f64, size: f64) -> f64 {
        match self.coordinate.kind {
            CoordinateKind::Distance => size * (NEAR_ZERO * size / value).max(1.0),
            _ => self.scale(size),
        }
    }
}

/// A mechanism in other coordinates.
#[derive(Debug)]
struct Chart {
    coordinates: Vec<usize>,
    solver: Solver,
    /// The forces of its equations of motion.
    of_equations: Forces,
    /// The forces of a solution that has some.
    of_solution: Option<Forces>,
}

impl Charts {
    /// Lists the candidates of a solver's mechanism, whose own freedoms are in use.
    pub(super) fn new(mechanism: &Mechanism, freedoms: &[DriverId]) -> Self {
        let own = freedoms
            .iter()
            .map(|id| mechanism.drivers[id.index()].coordinate);
        let joints = mechanism.joints.iter().filter_map(Joint::free_coordinate);
        let mut coordinates: Vec<_> = own.chain(joints).collect();
        let joints = coordinates.len();
        coordinates.extend(of_bodies(mechanism));
        let candidates: Vec<_> = coordinates
            .into_iter()
            .map(|coordinate| Candidate {
                relation: of_coordinate(&coordinate),
                coordinate,
            })
            .collect();
        let count = freedoms.len();
        Self {
            freedoms: freedoms.to_vec(),
            current: (0..count).collect(),
            others: Vec::new(),
            unfit: Vec::new(),
            changes: DMatrix::zeros(candidates.len(), count),
            own: Volume::new(count, count),
            of_joints: Volume::new(joints, count),
            all: Volume::new(candidates.len(), count),
            joints,
            candidates,
        }
    }

    /// Gives up all candidates of a single freedom but its own coordinate.
    #[cfg(test)]
    pub(super) fn keep_own(&mut self) {
        self.unfit = (1..self.candidates.len()).map(|k| vec![k]).collect();
    }

    /// Returns the solver whose coordinates are the file's freedoms, given the one in use.
    pub(super) fn own<'a>(&'a self, solver: &'a Solver) -> &'a Solver {
        let mut others = self.others.iter();
        let own = others.find(|chart| chart.coordinates.iter().enumerate().all(|(k, c)| k == *c));
        own.map_or(solver, |chart| &chart.solver)
    }

    /// Returns the candidates in use, one per freedom.
    pub(super) fn current(&self) -> &[usize] {
        &self.current
    }

    /// Returns the values of the candidates in use at a solver's pose.
    pub(super) fn values(&self, solver: &Solver) -> Vec<f64> {
        let still = Rates::new(solver.pose().q.len());
        let relations = self.current.iter().map(|k| &*self.candidates[*k].relation);
        let values = relations.map(|relation| solver.coordinate(relation, &still).value);
        values.collect()
    }

    /// Returns the natural size of the first components of x, for a mechanism of this size \[m\]: a
    /// radian or the size for values, the same per second for velocities. The others, work and
    /// derivatives, are left out of error control.
    pub(super) fn scales(&self, size: f64, components: usize) -> Vec<f64> {
        let values = self.current.iter().map(|k| self.candidates[*k].scale(size));
        let scales = values.clone().chain(values);
        let scales = scales.chain(std::iter::repeat(f64::INFINITY));
        scales.take(components).collect()
    }

    /// Returns coordinates in which the motion goes on better than in those in use, at the pose of
    /// these equations. Allocates only if there are some.
    pub(super) fn better(
        &mut self,
        solver: &Solver,
        equations: &EquationsOfMotion,
    ) -> Option<Vec<usize>> {
        self.differentiate(solver, equations, 0..self.joints);
        let joints = self.of_joints.choose(&self.changes);
        let uses_bodies = self.current.iter().any(|k| *k >= self.joints);
        let bodies = if uses_bodies || self.is_left_behind(solver, equations) {
            self.differentiate(solver, equations, self.joints..self.candidates.len());
            self.all.choose(&self.changes)
        } else {
            0.0
        };
        let far = if uses_bodies { 1.0 / RETURN } else { FAR };
        let (volume, best) = if bodies > far * joints {
            (bodies, &self.all)
        } else {
            (joints, &self.of_joints)
        };
        let returns = uses_bodies && bodies <= far * joints;
        let chosen = if !self.uses_own() && self.own.choose(&self.changes) >= RETURN * volume {
            self.own.chosen.clone()
        } else if volume > EXCHANGE || returns {
            best.chosen.clone()
        } else {
            return None;
        };
        (!self.unfit.contains(&chosen)).then_some(chosen)
    }

    /// Returns whether the file's freedoms are in use.
    pub(super) fn uses_own(&self) -> bool {
        self.current.iter().enumerate().all(|(k, own)| k == *own)
    }

    /// Returns whether the file's freedoms are coordinates at the pose of these equations.
    pub(super) fn own_is_fit(&mut self, solver: &Solver, equations: &EquationsOfMotion) -> bool {
        self.differentiate(solver, equations, 0..self.freedoms.len());
        self.own.choose(&self.changes) > NO_COORDINATES
    }

    /// Writes the changes of some candidates.
    fn differentiate(
        &mut self,
        solver: &Solver,
        equations: &EquationsOfMotion,
        candidates: Range<usize>,
    ) {
        let size = solver.size();
        for (column, freedom) in self.freedoms.iter().enumerate() {
            let unit = equations.unit(*freedom);
            let value = solver.pose().drivers[freedom.index()];
            let own = self.candidates[self.current[column]].scale_at(value, size);
            for row in candidates.clone() {
                let candidate = &self.candidates[row];
                let at = solver.coordinate(&*candidate.relation, unit);
                let scale = candidate.scale_at(at.value, size);
                self.changes[(row, column)] = at.first() * own / scale;
            }
        }
    }

    /// Returns whether some body moves so much, per unit of the coordinates in use, that its coordinates
    /// may be better: at less cost than its coordinates take.
    fn is_left_behind(&self, solver: &Solver, equations: &EquationsOfMotion) -> bool {
        let size = solver.size();
        let columns = self.freedoms.iter().zip(&self.current);
        columns.into_iter().any(|(freedom, current)| {
            let value = solver.pose().drivers[freedom.index()];
            let most = EXCHANGE / self.candidates[*current].scale_at(value, size);
            let bodies = equations.unit(*freedom).velocity().chunks_exact(3);
            bodies.into_iter().any(|body| {
                let way = body[0].abs().max(body[1].abs());
                way > most * size || body[2].abs() > most
            })
        })
    }

    /// Puts the chart with these candidates into use: the solver is that of the chart, anywhere, and
    /// the equations of motion and the solution have its forces. Returns false if they are no
    /// coordinates of the mechanism.
    pub(super) fn select(
        &mut self,
        solver: &mut Solver,
        forces: &mut Forces,
        solution: &mut Solution,
        coordinates: &[usize],
    ) -> bool {
        if self.current == coordinates {
            return true;
        }
        let is_wanted = |chart: &Chart| chart.coordinates == coordinates;
        let place = self.others.iter().position(is_wanted).or_else(|| {
            let chart = self.compile(solver, coordinates)?;
            self.others.push(chart);
            Some(self.others.len() - 1)
        });
        let Some(place) = place else {
            return false;
        };
        let chart = &mut self.others[place];
        if chart.of_solution.is_none() && solution.forces().is_some() {
            chart.of_solution = Some(chart.solver.forces());
        }
        chart.solver.set_budget(solver.budget());
        std::mem::swap(solver, &mut chart.solver);
        std::mem::swap(forces, &mut chart.of_equations);
        solution.exchange_forces(&mut chart.of_solution);
        chart.coordinates = std::mem::replace(&mut self.current, coordinates.to_vec());
        true
    }

    /// Moves on from the pose of the equations in other coordinates. Writes their values and
    /// velocities. Returns false, and changes nothing, if they are no coordinates of the
    /// mechanism.
    pub(super) fn exchange(
        &mut self,
        solver: &mut Solver,
        equations: &mut Equations,
        solution: &mut Solution,
        coordinates: Vec<usize>,
        x: &mut [f64],
    ) -> Result<bool, Error> {
        let changes = self.changes(solver, equations, &coordinates, x)?;
        let rates = equations.motion().coasting();
        let count = coordinates.len();
        let mut pose = solver.pose().clone();
        pose.crossings.clear();
        for (k, candidate) in coordinates.iter().enumerate() {
            let relation = &*self.candidates[*candidate].relation;
            let Jet { value, derivatives } = solver.coordinate(relation, rates);
            pose.drivers[self.freedoms[k].index()] = value;
            [x[k], x[count + k]] = [value, derivatives[0]];
        }
        if !self.select(solver, &mut equations.forces, solution, &coordinates) {
            self.unfit.push(coordinates);
            return Ok(false);
        }
        x[2 * count + 1..].copy_from_slice(&changes);
        solver.restore(&pose);
        Ok(true)
    }

    /// Returns the changes of values and velocities of some candidates along the directions of the
    /// motion.
    fn changes(
        &self,
        solver: &mut Solver,
        equations: &mut Equations,
        coordinates: &[usize],
        x: &[f64],
    ) -> Result<Vec<f64>, Error> {
        let mut changes = Vec::with_capacity(equations.variations());
        if equations.directions.is_empty() {
            return Ok(changes);
        }
        let mut rates = Rates::new(solver.pose().q.len());
        for direction in equations.varied(solver, x, &mut rates)? {
            let sensitivity = solver.sensitivity(&rates, &equations.point.drivers, &direction)?;
            let relations = coordinates.iter().map(|k| &*self.candidates[*k].relation);
            let along: Vec<_> = relations.map(|r| sensitivity.coordinate(r)).collect();
            changes.extend(along.iter().map(|change| change.value));
            changes.extend(along.iter().map(|change| change.first()));
        }
        Ok(changes)
    }

    /// Compiles the mechanism with other coordinates as its freedoms, which start at the solver's
    /// pose.
    fn compile(&self, solver: &Solver, coordinates: &[usize]) -> Option<Chart> {
        let mut mechanism = Mechanism::clone(solver.mechanism());
        let still = Rates::new(solver.pose().q.len());
        if coordinates.len() != self.freedoms.len() {
            return None;
        }
        for (place, (freedom, candidate)) in self.freedoms.iter().zip(coordinates).enumerate() {
            let driver = &mut mechanism.drivers[freedom.index()];
            let candidate = self.candidates.get(*candidate)?;
            driver.coordinate = candidate.coordinate;
            if let DriverSource::Free { start, named, .. } = &mut driver.source {
                *start = solver.coordinate(&*candidate.relation, &still).value;
                *named = Some(self.candidates[place].coordinate);
            }
        }
        let solver = Solver::new(Arc::new(mechanism)).ok()?;
        Some(Chart {
            coordinates: coordinates.to_vec(),
            of_equations: solver.forces(),
            of_solution: None,
            solver,
        })
    }
}

/// Returns the coordinates of all bodies, each by one of its markers, on the axes of a marker of ground.
/// Where a mechanism moves, some of them move. A body without a marker is no part of a mechanism, and
/// neither are bodies that nothing holds to ground.
fn of_bodies(mechanism: &Mechanism) -> impl Iterator<Item = Coordinate> {
    let is_ground = |id: &MarkerId| mechanism.markers[id.index()].body.is_none();
    let ground = (0..mechanism.markers.len()).map(MarkerId).find(is_ground);
    let ends = mechanism
        .bodies
        .iter()
        .filter_map(move |body| Some((ground?, *body.markers.first()?)));
    let kinds = [CoordinateKind::X, CoordinateKind::Y, CoordinateKind::Angle];
    ends.flat_map(move |(from, to)| {
        kinds.map(|kind| Coordinate {
            kind,
            from,
            to,
            axes: from,
        })
    })
}

impl Volume {
    fn new(rows: usize, columns: usize) -> Self {
        Self {
            rows: DMatrix::zeros(rows, columns),
            chosen: vec![0; columns],
        }
    }

    /// Chooses a row for each column so that these rows span a large volume, by elimination with
    /// complete pivoting, and returns the volume. They are the first of `all`.
    fn choose(&mut self, all: &DMatrix<f64>) -> f64 {
        const NONE: usize = usize::MAX;
        let Self { rows, chosen } = self;
        rows.copy_from(&all.rows(0, rows.nrows()));
        chosen.fill(NONE);
        let mut volume = 1.0;
        for _ in 0..rows.ncols() {
            let (mut best, mut at) = (0.0, (0, 0));
            for column in (0..rows.ncols()).filter(|column| chosen[*column] == NONE) {
                for row in 0..rows.nrows() {
                    let entry = rows[(row, column)].abs();
                    if entry > best {
                        (best, at) = (entry, (row, column));
                    }
                }
            }
            if best == 0.0 {
                return 0.0;
            }
            volume *= best;
            let (pivot, column) = at;
            chosen[column] = pivot;
            for other in (0..rows.ncols()).filter(|other| *other != column) {
                let factor = rows[(pivot, other)] / rows[at];
                for row in 0..rows.nrows() {
                    let entry = rows[(row, column)];
                    rows[(row, other)] -= factor * entry;
                }
            }
        }
        volume
    }
}
