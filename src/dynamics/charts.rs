//! The choice of coordinates in which the freedoms are integrated.
//!
//! A coordinate is of no use near its dead point, such as the angle of a rocker at the end of its
//! swing. The motion goes on in another one then: all freedoms and the relative coordinates of all
//! joints are candidates. A mechanism with one set of them as its freedoms is a chart, with a
//! solver of its own, which is compiled when it is first needed.

use std::sync::Arc;

use nalgebra::DMatrix;

use super::equations::Equations;
use super::error::Error;
use crate::kinematics::constraint::{Constraint, of_coordinate};
use crate::kinematics::{
    End, EquationsOfMotion, Forces, Path, RangeSettings, Rates, Solution, Solver,
};
use crate::mechanism::{Coordinate, DriverId, DriverSource, Jet, Joint, Mechanism};

/// The motion goes on in other coordinates if these move by so much, per unit of those in use:
/// their sines are below a third then, and the equations lose less than a digit.
const EXCHANGE: f64 = 3.0;
/// It returns to the file's own freedoms if these move by such a part of the best ones: more than
/// at the exchange, so that the two do not alternate.
const RETURN: f64 = 0.5;

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
    turns(&range.lower) && turns(&range.upper) && range.crossings.is_empty()
}

/// The charts of a mechanism.
#[derive(Debug)]
pub(super) struct Charts {
    freedoms: Vec<DriverId>,
    /// The file's freedoms, then the coordinates of joints.
    candidates: Vec<Candidate>,
    /// The candidates in use, one per freedom.
    current: Vec<usize>,
    /// Charts that are not in use.
    others: Vec<Chart>,
    /// Sets of candidates that are no coordinates of the mechanism.
    unfit: Vec<Vec<usize>>,
    /// ∂candidates/∂coordinates in use, scaled.
    changes: DMatrix<f64>,
    all: Volume,
    own: Volume,
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
        let candidates: Vec<_> = own
            .chain(joints)
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
            all: Volume::new(candidates.len(), count),
            own: Volume::new(count, count),
            candidates,
        }
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
        let size = solver.size();
        for (column, freedom) in self.freedoms.iter().enumerate() {
            let unit = equations.unit(*freedom);
            let own = self.candidates[self.current[column]].scale(size);
            for (row, candidate) in self.candidates.iter().enumerate() {
                let change = solver.coordinate(&*candidate.relation, unit).first();
                self.changes[(row, column)] = change * own / candidate.scale(size);
            }
        }
        self.all.rows.copy_from(&self.changes);
        let volume = self.all.choose();
        self.own
            .rows
            .copy_from(&self.changes.rows(0, self.freedoms.len()));
        let uses_own = self.current.iter().enumerate().all(|(k, own)| k == *own);
        let chosen = if !uses_own && self.own.choose() >= RETURN * volume {
            self.own.chosen.clone()
        } else if volume > EXCHANGE {
            self.all.chosen.clone()
        } else {
            return None;
        };
        (!self.unfit.contains(&chosen)).then_some(chosen)
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

impl Volume {
    fn new(rows: usize, columns: usize) -> Self {
        Self {
            rows: DMatrix::zeros(rows, columns),
            chosen: vec![0; columns],
        }
    }

    /// Chooses a row for each column so that these rows span a large volume, by elimination with
    /// complete pivoting, and returns the volume. Uses up the rows.
    fn choose(&mut self) -> f64 {
        const NONE: usize = usize::MAX;
        let Self { rows, chosen } = self;
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
