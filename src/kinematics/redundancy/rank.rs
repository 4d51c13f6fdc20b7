//! Degrees of freedom, by rank: the motions that the constraints leave free, those that drivers
//! drive, and the constraints that are redundant.

use crate::kinematics::Origin;
use crate::kinematics::assembly::closure::is_small;
use crate::kinematics::assembly::least_squares::LeastSquares;
use crate::kinematics::error::{Error, Remedy};
use crate::kinematics::linear::{Echelon, ReducedRow, Row, spread};
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::state::State;
use crate::kinematics::system::{EquationTarget, System};
use crate::kinematics::tolerances::{DEPENDENT, LEAST_COEFFICIENT};
use crate::mechanism::{BodyId, Coordinate, DriverId, Joint, MarkerId, Mechanism};

/// Distance of the other poses that tell redundancy from a singular position, in radians and
/// characteristic lengths: far enough for the rank to change, near enough for the mechanism to
/// close.
const AWAY: f64 = 0.03;

/// Ranks at one pose.
struct Ranks {
    /// Rank of the constraints.
    constraints: usize,
    /// The independent constraints, then the drivers that are independent of these.
    echelon: Echelon,
    /// Constraints that depend on earlier ones.
    redundant: Vec<usize>,
    /// Drivers that depend on constraints and earlier drivers.
    excess: Vec<ReducedRow>,
}

/// Compares the motions that the constraints leave free with those that the drivers drive, where
/// the mechanism is closed and a little away from there. Returns the redundant rows.
///
/// # Errors
///
/// [`Error::Structure`] if the drivers leave a motion free or there are too many,
/// [`Error::Singular`] if the constraints lose rank here without a free motion.
pub(super) fn find_freedom(
    compiled: &mut CompiledMechanism,
    state: &mut State,
) -> Result<Vec<usize>, Error> {
    let unknowns = compiled.system.unknowns();
    let mut home = vec![0.0; unknowns];
    state.at.copy_pose(&mut home);
    let here = ranks(compiled, state);
    let leaves_motion = here.constraints < unknowns;
    let mut away = Vec::new();
    if leaves_motion {
        away = ranks_with_drivers_moved(compiled, state, &home);
        let is_full = |ranks: &Ranks| ranks.echelon.kept().len() == unknowns;
        if !away.iter().any(is_full) {
            away.extend(ranks_along_constraints(compiled, state, &home));
        }
        state.at.set_pose(compiled.system.mechanism(), &home);
        if away.is_empty() {
            return Err(singular_position(compiled, state));
        }
    }
    let rank = |ranks: &Ranks| (ranks.echelon.kept().len(), ranks.constraints);
    let generic = away.into_iter().max_by_key(rank).unwrap_or(here);
    judge(&compiled.system, &generic)?;
    Ok(generic.redundant)
}

/// Returns the ranks after the drivers have moved a little forwards, and backwards, without the
/// poses at which the mechanism does not close, as with excess drivers.
fn ranks_with_drivers_moved(
    compiled: &CompiledMechanism,
    state: &mut State,
    home: &[f64],
) -> Vec<Ranks> {
    let drivers = state.pose.drivers.clone();
    let all: Vec<_> = (0..compiled.system.equations().len()).collect();
    let mut problem = LeastSquares::of_all(&compiled.system, &all);
    let mut found = Vec::new();
    for sense in [AWAY, -AWAY] {
        if drivers.is_empty() {
            break;
        }
        state.at.set_pose(compiled.system.mechanism(), home);
        let moved = drivers.iter().enumerate().map(|(k, value)| {
            let row = compiled.system.driver_row(DriverId(k));
            value + sense * mixture(k) / row.row_scale(&state.at)
        });
        state.pose.drivers = moved.collect();
        if problem
            .close(&mut state.block_state(&compiled.system))
            .is_none()
        {
            found.push(ranks(compiled, state));
        }
    }
    state.pose.drivers = drivers;
    found
}

/// Returns the ranks a little forwards, and backwards, along a motion that the constraints leave
/// free.
fn ranks_along_constraints(
    compiled: &CompiledMechanism,
    state: &mut State,
    home: &[f64],
) -> Vec<Ranks> {
    let system = &compiled.system;
    state.at.set_pose(system.mechanism(), home);
    let motion = free_motion(compiled, state);
    let mut problem = LeastSquares::of_all(system, &constraint_rows(system));
    let mut found = Vec::new();
    let size = state.at.size();
    let scale = |column: usize| system.column_scale(column, size);
    for sense in [AWAY, -AWAY] {
        let moved = home.iter().zip(&motion).enumerate();
        let q: Vec<_> = moved
            .map(|(column, (q, rate))| q + sense * rate * scale(column))
            .collect();
        state.at.set_pose(system.mechanism(), &q);
        if problem.close(&mut state.block_state(system)).is_some() {
            continue;
        }
        let moves = home.iter().enumerate();
        let moved = moves.map(|(k, home)| (state.at.coordinate(k) - home).abs() / scale(k));
        if moved.fold(0.0, f64::max) > 0.1 * AWAY {
            found.push(ranks(compiled, state));
        }
    }
    found
}

/// Judges drivers that are too few, too many or on the wrong coordinates.
fn judge(system: &System, ranks: &Ranks) -> Result<(), Error> {
    let mechanism = system.mechanism();
    let freedom = system.unknowns() - ranks.constraints;
    let free = system.unknowns() - ranks.echelon.kept().len();
    if free == 0 && ranks.excess.is_empty() {
        return Ok(());
    }
    let mut excess: Vec<Origin> = Vec::new();
    for left_out in &ranks.excess {
        let equations = system.equations();
        let origin = |row: usize| equations[row].origin;
        let others = ranks.echelon.combination(left_out, LEAST_COEFFICIENT);
        let mut set: Vec<_> = others.into_iter().map(|(row, _)| origin(row)).collect();
        let is_driver = |origin: &Origin| matches!(origin, Origin::Driver(_));
        if set.iter().any(is_driver) {
            // Drivers exclude each other; the joints between them are not the cause.
            set.retain(is_driver);
        }
        set.push(origin(left_out.row));
        excess.extend(set);
    }
    excess.sort_unstable();
    excess.dedup();
    let loose = moved_by(system, &ranks.echelon);
    let keys = coordinate_keys(mechanism, &loose);
    let describe = |origin: &Origin| origin.describe(mechanism);
    let remedy = if free > 0 && !excess.is_empty() {
        let is_driver = |origin: &&Origin| matches!(origin, Origin::Driver(_));
        let (drivers, holders): (Vec<_>, Vec<_>) = excess.iter().partition(is_driver);
        Remedy::Elsewhere {
            drivers: drivers.into_iter().map(describe).collect(),
            holders: holders.into_iter().map(describe).collect(),
            keys: keys.map(|(_, keys)| keys),
        }
    } else {
        let slots = suspect_slots(mechanism, &loose);
        match keys.filter(|_| slots.is_empty() && excess.is_empty()) {
            Some((name, keys)) => Remedy::Line(format!("{name} = {{ {keys} }}")),
            None => Remedy::Slots(slots),
        }
    };
    Err(Error::Structure {
        freedom,
        drivers: mechanism.drivers.len(),
        free,
        remedy: Box::new(remedy),
        loose,
        excess: excess.iter().map(describe).collect(),
    })
}

/// Returns the slots between a body that is free to move and one that is not, in a mechanism with
/// drivers: each may be meant to be `translational`.
fn suspect_slots(mechanism: &Mechanism, loose: &[String]) -> Vec<String> {
    let is_loose = |marker: MarkerId| {
        let body = mechanism.markers[marker.index()].body;
        let name = body.map(|body| format!("body `{}`", mechanism.bodies[body.index()].name));
        name.is_some_and(|name| loose.contains(&name))
    };
    let joints = mechanism.joints.iter().filter(|joint| {
        let is_slot = (joint.guide()).is_some_and(|guide| guide.turns && guide.aside.is_none());
        is_slot && !mechanism.drivers.is_empty() && is_loose(joint.from) != is_loose(joint.to)
    });
    joints
        .map(|joint| format!("joint `{}`", joint.name))
        .collect()
}

/// Returns a name for the coordinate of a joint of a body that is free to move, of a joint with
/// ground if there is one, and the keys that give it.
fn coordinate_keys(mechanism: &Mechanism, loose: &[String]) -> Option<(&'static str, String)> {
    let body = |marker: MarkerId| mechanism.markers[marker.index()].body;
    let name = |body: BodyId| &mechanism.bodies[body.index()].name;
    let is_loose = |marker: MarkerId| {
        body(marker).is_some_and(|body| loose.contains(&format!("body `{}`", name(body))))
    };
    let joints = mechanism.joints.iter();
    let moving = joints.filter(|joint| is_loose(joint.from) || is_loose(joint.to));
    let Coordinate { kind, from, to, .. } = moving
        .filter_map(Joint::free_coordinate)
        .min_by_key(|of_joint| body(of_joint.from).is_some() && body(of_joint.to).is_some())?;
    let [from, to] = [from, to].map(|marker| mechanism.marker_path(marker));
    let (name, kind) = if kind.is_angle() {
        ("turn", "angle")
    } else {
        ("travel", "x")
    };
    let keys = format!("coordinate = \"{kind}\", markers = [\"{from}\", \"{to}\"]");
    Some((name, keys))
}

/// Returns the ranks at the present places of the bodies.
fn ranks(compiled: &CompiledMechanism, state: &State) -> Ranks {
    let rows = jacobian_rows(compiled, state);
    let mut echelon = Echelon::new(compiled.system.unknowns(), &rows);
    let mut redundant = Vec::new();
    let mut excess = Vec::new();
    let mut constraints = 0;
    // The drivers' rows come last.
    for (row, entries) in rows.iter().enumerate() {
        let is_driver = matches!(
            compiled.system.equations()[row].target,
            EquationTarget::Driver(_)
        );
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

/// Returns a motion that the constraints leave free at the present places of the bodies, scaled;
/// of several a mixture of all.
fn free_motion(compiled: &CompiledMechanism, state: &State) -> Vec<f64> {
    let rows = jacobian_rows(compiled, state);
    let mut echelon = Echelon::new(compiled.system.unknowns(), &rows);
    for row in constraint_rows(&compiled.system) {
        echelon.offer(row, &rows[row], DEPENDENT);
    }
    let free = echelon.free().into_iter().enumerate();
    let all: Vec<_> = free.map(|(k, column)| (column, mixture(k))).collect();
    echelon.null_vector(&all)
}

/// Returns the rows that no driver moves.
pub(super) fn constraint_rows(system: &System) -> Vec<usize> {
    let equations = system.equations().iter().enumerate();
    let held = equations.filter(|(_, e)| matches!(e.target, EquationTarget::Constant(_)));
    held.map(|(row, _)| row).collect()
}

/// Returns all rows, the drivers' first.
pub(in crate::kinematics) fn drivers_first(system: &System) -> Vec<usize> {
    let equations = system.equations();
    let mut rows: Vec<_> = (0..equations.len()).collect();
    rows.sort_by_key(|&row| matches!(equations[row].target, EquationTarget::Constant(_)));
    rows
}

/// Returns the Jacobian by rows at the present places of the bodies, scaled.
pub(in crate::kinematics) fn jacobian_rows(
    compiled: &CompiledMechanism,
    state: &State,
) -> Vec<Row> {
    let rows = 0..compiled.system.equations().len();
    let gradient = |row| {
        let mut entries = Row::new();
        compiled
            .system
            .sparse_row(row, state.values(), &mut entries);
        entries
    };
    rows.map(gradient).collect()
}

/// Returns the error for a pose at which all rows together lose rank. Names the bodies that can
/// move there while the drivers rest.
pub(super) fn singular_position(compiled: &CompiledMechanism, state: &State) -> Error {
    let system = &compiled.system;
    let rows = jacobian_rows(compiled, state);
    let order = drivers_first(system);
    let eliminate = |least: f64| {
        let mut echelon = Echelon::new(system.unknowns(), &rows);
        for &row in &order {
            echelon.offer(row, &rows[row], least);
        }
        echelon
    };
    let mut echelon = eliminate(DEPENDENT);
    let mut rcond = 0.0;
    if echelon.free().is_empty() {
        // The pose is nearly singular: the motion is the one that the weakest row prevents.
        rcond = weakest(&echelon);
        echelon = eliminate(rcond);
    }
    if is_small(system) {
        let unknowns: Vec<_> = (0..system.unknowns()).collect();
        rcond = state.dense_rcond(system, &order, &unknowns);
    }
    Error::Singular {
        rcond,
        bodies: moved_by(system, &echelon),
        aside: None,
    }
}

/// Returns the names of the bodies that move in the motions left by the rows of `echelon`.
fn moved_by(system: &System, echelon: &Echelon) -> Vec<String> {
    /// Least part of the largest motion that is not rounding.
    const MOVES: f64 = 1e-5;
    /// Most motions that are looked at one by one. More of them are looked at in several mixtures
    /// of all: motions that cancel in one mixture do not cancel in another.
    const FEW: usize = 64;
    const MIXTURES: usize = 8;
    let free = echelon.free();
    let mixtures = if free.len() <= FEW { 0 } else { MIXTURES };
    let single = free.iter().take_while(|_| mixtures == 0);
    let single = single.map(|&column| vec![(column, 1.0)]);
    let mixed = (0..mixtures).map(|which| {
        let parts = free.iter().enumerate();
        let parts = parts.map(|(k, &column)| (column, mixture(MIXTURES * k + which)));
        parts.collect()
    });
    let mut largest = vec![0.0; system.unknowns()];
    for motion in single.chain(mixed) {
        let vector = echelon.null_vector(&motion);
        for (largest, value) in largest.iter_mut().zip(vector) {
            *largest = f64::max(*largest, value.abs());
        }
    }
    system.describe_moved(largest.into_iter().enumerate(), MOVES)
}

/// Returns the least remainder of a row of `echelon`.
pub(super) fn weakest(echelon: &Echelon) -> f64 {
    let left = echelon.kept().iter().map(|kept| kept.remainder);
    left.fold(1.0, f64::min)
}

/// Returns a factor for the k-th of several motions, so that they do not cancel: from a half to
/// one and a half.
fn mixture(k: usize) -> f64 {
    0.5 + spread(k + 1)
}
