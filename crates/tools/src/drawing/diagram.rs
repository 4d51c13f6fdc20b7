//! Diagrams with what is asked for besides the mechanism at its pose.

use super::force_place::{ForcePlace, force_arrows};
use super::scene::Scene;
use super::sheet::Sheet;
use super::sweep::{follow, spread, sweep, usual_driver};
use super::symbol::{Symbol, compose_dimensions, contact_mark, instant_centre};
use biela::kinematics::{Error, InstantCentre, Pose, Rates, Solver};
use biela::mechanism::{BodyId, DisplayUnit, DriverId, Jet};

/// The contents of a diagram.
///
/// ```
/// use biela_tools::drawing::{Diagram, svg};
/// use biela::kinematics::{Path, Solver};
/// use biela::mechanism::{Mechanism, Source};
///
/// let text = include_str!("../../../../mechanisms/four_bar.toml");
/// let (mechanism, _) = Mechanism::parse(&Source::new("four_bar.toml", text)).unwrap();
/// let mut solver = Solver::new(mechanism.into()).unwrap();
/// let path = Path::new(solver.mechanism());
/// solver.assemble(&path).unwrap();
///
/// let diagram = Diagram { poses: 8, dimensions: true, ..Diagram::default() };
/// let picture = svg::write(&diagram.sheet(&mut solver).unwrap(), 640, false);
/// assert!(picture.contains("class=\"poses\"") && picture.contains("lengths in mm"));
/// ```
#[derive(Clone, Debug)]
pub struct Diagram {
    /// Whether points of interest leave traces along the motion.
    pub traces: bool,
    /// The driver whose range is the motion; the motion of [`Scene::new`] if left out or, where
    /// that has none, the range of the first driver.
    pub followed: Option<Followed>,
    /// Number of faint poses along the motion.
    pub poses: usize,
    /// Whether joints have letters, and bodies lengths between their joints.
    pub dimensions: bool,
    /// Whether the instant centres of bodies and ground are drawn. They are those of the motion, or
    /// where it is at rest, those while the driver followed moves alone.
    pub instant_centres: bool,
    /// Whether the clearance of each contact is shown between its nearest places.
    pub contacts: bool,
    /// Forces that arrows show, each with its components in ground axes \[N\] and torque \[N m\].
    pub forces: Vec<(ForcePlace, [f64; 3])>,
}

/// A driver that a diagram follows, with the others held.
#[derive(Clone, Copy, Debug)]
pub struct Followed {
    /// The driver.
    pub driver: DriverId,
    /// Values between which it is followed, in place of its own `min` and `max` \[m or rad\].
    pub bounds: [Option<f64>; 2],
}

impl Default for Diagram {
    /// Returns a diagram with traces alone.
    fn default() -> Self {
        Self {
            traces: true,
            followed: None,
            poses: 0,
            dimensions: false,
            instant_centres: false,
            contacts: false,
            forces: Vec::new(),
        }
    }
}

impl Diagram {
    /// Draws the mechanism at the solver's pose, to which the solver returns.
    ///
    /// # Errors
    ///
    /// [`Error::Singular`] for instant centres at a singular pose, which has no rates.
    pub fn sheet(&self, solver: &mut Solver) -> Result<Sheet, Error> {
        let motion = self.motion(solver);
        let centres = if self.instant_centres {
            Some(self.centres(solver)?)
        } else {
            None
        };
        let mut scene = self.scene_along(solver, &motion);
        let mechanism = solver.mechanism();
        let Pose { q, parameters, .. } = solver.pose();
        if self.dimensions {
            scene.add(compose_dimensions(mechanism, parameters, q));
            scene.length_unit = Some(mechanism.length_display().unwrap_or(DisplayUnit::METRE));
        }
        if let Some((centres, note)) = centres {
            scene.notes.extend(note);
            let unit = mechanism.length_display();
            let marks = instant_centre::compose(&scene.symbols, &scene.bodies, &centres, q, unit);
            scene.add(marks);
        }
        if self.contacts {
            let marks = contact_mark::compose(&scene.symbols, solver);
            scene.symbols.extend(marks);
        }
        if !self.forces.is_empty() {
            // Arrows of the forces' sizes take the place of their symbols.
            let is_load = |symbol: &Symbol| matches!(symbol, Symbol::LoadArrow(_));
            scene.symbols.retain(|symbol| !is_load(symbol));
            scene.symbols.extend(force_arrows(&self.forces));
        }
        let poses = spread(&motion, mechanism.bodies.len(), self.poses);
        Ok(Sheet::with_poses(&scene, q, &poses))
    }

    /// Returns the mechanism at the solver's pose, to which the solver returns, with paths and ways
    /// along the motion, and nothing else.
    #[must_use]
    pub fn scene(&self, solver: &mut Solver) -> Scene {
        let motion = self.motion(solver);
        self.scene_along(solver, &motion)
    }

    fn scene_along(&self, solver: &Solver, motion: &[Vec<f64>]) -> Scene {
        let Pose { q, parameters, .. } = solver.pose();
        Scene::along(solver.mechanism(), parameters, q, motion, self.traces)
    }

    /// Returns the poses of the motion, at least one.
    fn motion(&self, solver: &mut Solver) -> Vec<Vec<f64>> {
        if let Some(Followed { driver, bounds }) = self.followed {
            return follow(solver, driver, bounds);
        }
        let motion = sweep(solver);
        match usual_driver(solver.mechanism()) {
            Some(driver) if motion.len() == 1 && self.poses > 0 => {
                follow(solver, driver, [None; 2])
            }
            _ => motion,
        }
    }

    /// Returns the instant centres of all bodies, and a note on the driver that moves alone.
    fn centres(&self, solver: &mut Solver) -> Result<(Vec<InstantCentre>, Option<String>), Error> {
        let time = solver.pose().time;
        let drivers = (0..solver.mechanism().drivers.len()).map(DriverId);
        let mut velocities: Vec<f64> = drivers
            .map(|driver| {
                let is_prescribed = solver.mechanism().drivers[driver.index()]
                    .motion()
                    .is_some();
                if is_prescribed {
                    solver.motion(driver, time).first()
                } else {
                    0.0
                }
            })
            .collect();
        let mut note = None;
        if velocities.iter().all(|velocity| *velocity == 0.0) {
            let followed = self.followed.map(|followed| followed.driver);
            if let Some(driver) = followed.or_else(|| usual_driver(solver.mechanism())) {
                velocities[driver.index()] = 1.0;
                if velocities.len() > 1 {
                    let name = &solver.mechanism().drivers[driver.index()].name;
                    note = Some(format!("instant centres while {name} moves alone"));
                }
            }
        }
        let mut rates = Rates::new(solver.pose().q.len());
        let jet = |driver: DriverId| Jet::linear(0.0, velocities[driver.index()]);
        solver.solve_rates(jet, &mut rates)?;
        let bodies = (0..solver.mechanism().bodies.len()).map(BodyId);
        let centres = bodies.map(|body| solver.instant_centre(body, &rates));
        Ok((centres.collect(), note))
    }
}
