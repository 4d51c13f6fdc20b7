//! Degrees of freedom, by rank: what the constraints leave free, what drivers drive of it, and
//! which constraints say nothing new.

use super::closing::Closing;
use crate::kinematics::linear::{Echelon, Reduced, Row};
use crate::kinematics::system::Target;
use crate::kinematics::{Element, Error, Solver};
use crate::mechanism::CoordinateKind;

/// A row of which no more than this is left, scaled, depends on the others. A singular position
/// is known to the square root of the rounding, 1e-8; a motion of [`AWAY`] away from it
/// leaves some 1e-2.
pub(super) const DEPENDENT: f64 = 1e-6;
/// How far the mechanism is moved to tell what depends here only, in radians and characteristic
/// lengths: enough for rank to show, not so far that it is another mechanism.
pub(super) const AWAY: f64 = 0.03;
/// A factor in a combination of rows below this part of the largest is rounding.
const TAKES_PART: f64 = 1e-6;

/// Ranks at one pose.
struct Ranks {
    /// Of the constraints.
    constraints: usize,
    /// The constraints kept, then the drivers that these leave free to choose.
    echelon: Echelon,
    /// Constraints that depend on earlier ones.
    redundant: Vec<usize>,
    /// Drivers that depend on constraints and earlier drivers.
    excess: Vec<Reduced>,
}

impl Solver {
    /// Compares what the constraints leave free with what the drivers drive, where the mechanism
    /// is closed and a little away from there. Returns the redundant rows.
    ///
    /// # Errors
    ///
    /// [`Error::Structure`] if something is free or more is driven than is free,
    /// [`Error::Singular`] if the constraints lose rank here but let nothing move.
    pub(super) fn find_freedom(&mut self) -> Result<Vec<usize>, Error> {
        let unknowns = self.system.unknowns();
        let mut home = vec![0.0; unknowns];
        self.at.copy_pose(&mut home);
        let here = self.ranks();
        let leaves_motion = here.constraints < unknowns;
        let mut away = Vec::new();
        if leaves_motion {
            away = self.ranks_with_drivers_moved(&home);
            let is_full = |ranks: &Ranks| ranks.echelon.kept().len() == unknowns;
            if !away.iter().any(is_full) {
                away.extend(self.ranks_along_constraints(&home));
            }
            self.at.set_pose(self.system.mechanism(), &home);
            if away.is_empty() {
                return Err(self.singular_position());
            }
        }
        let rank = |ranks: &Ranks| (ranks.echelon.kept().len(), ranks.constraints);
        let generic = away.into_iter().max_by_key(rank).unwrap_or(here);
        self.judge(&generic)?;
        Ok(generic.redundant)
    }

    /// Ranks where the drivers have moved a little, both ways, as far as the mechanism closes
    /// there. Drivers that are too many hold each other.
    fn ranks_with_drivers_moved(&mut self, home: &[f64]) -> Vec<Ranks> {
        let drivers = self.pose.drivers.clone();
        let all: Vec<_> = (0..self.system.equations().len()).collect();
        let mut closing = Closing::new(&self.system, &all);
        let mut found = Vec::new();
        for sense in [AWAY, -AWAY] {
            if drivers.is_empty() {
                break;
            }
            self.at.set_pose(self.system.mechanism(), home);
            let moved = drivers.iter().zip(&self.system.mechanism().drivers);
            let moved = moved.enumerate().map(|(k, (value, driver))| {
                let scale = match driver.coordinate.kind {
                    CoordinateKind::Angle => 1.0,
                    _ => self.at.size(),
                };
                value + sense * scale * mixture(k)
            });
            self.pose.drivers = moved.collect();
            if closing.close(&mut self.work().1).is_none() {
                found.push(self.ranks());
            }
        }
        self.pose.drivers = drivers;
        found
    }

    /// Ranks a little way along what the constraints leave free, both ways.
    fn ranks_along_constraints(&mut self, home: &[f64]) -> Vec<Ranks> {
        self.at.set_pose(self.system.mechanism(), home);
        let way = self.way_out();
        let constraints = self.constraint_rows();
        let mut closing = Closing::new(&self.system, &constraints);
        let mut found = Vec::new();
        for sense in [AWAY, -AWAY] {
            if self.move_away(home, &way, sense, &mut closing) {
                found.push(self.ranks());
            }
        }
        found
    }

    /// The verdict on drivers that are too few, too many or on the wrong things.
    fn judge(&self, ranks: &Ranks) -> Result<(), Error> {
        let mechanism = self.system.mechanism();
        let freedom = self.system.unknowns() - ranks.constraints;
        let free = self.system.unknowns() - ranks.echelon.kept().len();
        if free == 0 && ranks.excess.is_empty() {
            return Ok(());
        }
        let mut excess: Vec<Element> = Vec::new();
        for left_out in &ranks.excess {
            let equations = self.system.equations();
            let element = |row: usize| equations[row].element;
            let others = ranks.echelon.combination(left_out, TAKES_PART);
            let mut set: Vec<_> = others.into_iter().map(|(row, _)| element(row)).collect();
            let is_driver = |element: &Element| matches!(element, Element::Driver(_));
            if set.iter().any(is_driver) {
                // Drivers that exclude each other: the joints only pass it on.
                set.retain(is_driver);
            }
            set.push(element(left_out.row));
            excess.extend(set);
        }
        excess.sort_unstable();
        excess.dedup();
        Err(Error::Structure {
            freedom,
            drivers: mechanism.drivers.len(),
            free,
            loose: self.moved_by(&ranks.echelon),
            excess: excess
                .into_iter()
                .map(|element| element.describe(mechanism))
                .collect(),
        })
    }

    /// Ranks where the mechanism is.
    fn ranks(&mut self) -> Ranks {
        let rows = self.rows_here();
        let mut echelon = Echelon::new(self.system.unknowns(), &rows);
        let mut redundant = Vec::new();
        let mut excess = Vec::new();
        let mut constraints = 0;
        // The drivers' rows come last.
        for (row, entries) in rows.iter().enumerate() {
            let is_driver = matches!(self.system.equations()[row].target, Target::Driver(_));
            if !is_driver {
                constraints += 1;
            }
            match echelon.offer(row, entries, DEPENDENT) {
                None => {}
                Some(left_out) if is_driver => excess.push(left_out),
                Some(_) => redundant.push(row),
            }
        }
        Ranks {
            constraints: constraints - redundant.len(),
            echelon,
            redundant,
            excess,
        }
    }

    /// A direction in which the constraints let the mechanism move where it is, scaled; of
    /// several a mixture of all.
    fn way_out(&mut self) -> Vec<f64> {
        let rows: Vec<Row> = self.rows_here();
        let mut echelon = Echelon::new(self.system.unknowns(), &rows);
        for row in self.constraint_rows() {
            echelon.offer(row, &rows[row], DEPENDENT);
        }
        let free = echelon.free().into_iter().enumerate();
        let all: Vec<_> = free.map(|(k, column)| (column, mixture(k))).collect();
        echelon.null_vector(&all)
    }

    /// Moves from `home` along a direction and closes on the constraints. False if that leads
    /// nowhere.
    fn move_away(&mut self, home: &[f64], way: &[f64], by: f64, closing: &mut Closing) -> bool {
        let size = self.at.size();
        let scale: Vec<_> = (0..home.len())
            .map(|column| self.system.column_scale(column, size))
            .collect();
        let steps = way.iter().zip(&scale).map(|(way, scale)| by * way * scale);
        let q: Vec<_> = home.iter().zip(steps).map(|(q, step)| q + step).collect();
        self.at.set_pose(self.system.mechanism(), &q);
        let (_, mut work) = self.work();
        if closing.close(&mut work).is_some() {
            return false;
        }
        let moved = (0..home.len())
            .map(|k| (self.at.coordinate(k) - home[k]).abs() / scale[k])
            .fold(0.0, f64::max);
        moved > 0.1 * AWAY
    }

    /// The rows that no driver moves.
    pub(super) fn constraint_rows(&self) -> Vec<usize> {
        let equations = self.system.equations().iter().enumerate();
        let held = equations.filter(|(_, e)| matches!(e.target, Target::Constant(_)));
        held.map(|(row, _)| row).collect()
    }
}

/// A factor for the k-th of several motions, so that they do not cancel: from a half to one and a
/// half, spread evenly by the golden ratio.
pub(super) fn mixture(k: usize) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    0.5 + (GOLDEN * (k + 1) as f64).fract()
}
