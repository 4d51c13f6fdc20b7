//! One sub-step along a path: to its end on the tangent and curvature of the motion, and back where
//! that is not proved.

use super::outcome::{Progress, Reason};
use crate::kinematics::Error;
use crate::kinematics::block::{Advance, Substep, Work};
use crate::kinematics::newton::Correction;
use crate::kinematics::path::Path;
use crate::kinematics::solver::{Solver, UNIT};
use crate::mechanism::Jet;

impl Solver {
    /// Makes the pose, which is where `path_drivers` are from, the origin of the next sub-steps.
    pub(in crate::kinematics) fn set_origin(&mut self) {
        self.predict();
        self.origin_time = self.pose.time;
        if self.parameters_move {
            self.origin_parameters
                .copy_from_slice(&self.pose.parameters);
        }
    }

    /// Computes tangent and curvature of the motion along the path where the mechanism stands,
    /// which is where `path_drivers` are from.
    fn predict(&mut self) {
        std::mem::swap(&mut self.origin_drivers, &mut self.path_drivers);
        if !self.has_unit() {
            let drivers = std::mem::take(&mut self.origin_drivers);
            let (plan, mut work) = self.work();
            plan.solve_rates(&mut work, &drivers);
            self.origin_drivers = drivers;
        }
    }

    /// How far along the flow the part `h` of the path leads: q + h q′ + ½ h² q″, where with a
    /// single driver q′ = q_u u′ and q″ = q_u u″ + q_uu u′².
    fn advance_of(&self, h: f64) -> Advance {
        match self.origin_drivers[..] {
            [u] => Advance {
                first: h * (u.first() + 0.5 * h * u.second()),
                second: 0.5 * (h * u.first()).powi(2),
            },
            _ => Advance {
                first: h,
                second: 0.5 * h * h,
            },
        }
    }

    /// Goes from the pose to the end of a sub-step; true if that kept to the motion. If not, the
    /// mechanism is neither here nor there, the pose apart.
    ///
    /// # Errors
    ///
    /// A value on the way is one for which the mechanism does not exist, or a redundant
    /// constraint is one no longer.
    pub(in crate::kinematics) fn try_substep(
        &mut self,
        path: &Path,
        [start, end]: [f64; 2],
        progress: &mut Progress,
    ) -> Result<bool, Reason> {
        // What holds for several steps is for steps that are taken as a whole: how a longer way is
        // divided depends on its own proofs alone.
        let boxes = start <= 0.0 && end >= 1.0 && !self.parameters_move;
        let reached = self.reach(path, [start, end], boxes);
        let mut reached = reached.map_err(Reason::Value)?;
        if reached.is_none() && self.tubes.relied_on_box {
            self.stand_at(path, start);
            let again = self.reach(path, [start, end], false);
            reached = again.map_err(Reason::Value)?;
        }
        let Some(correction) = reached else {
            return Ok(false);
        };
        if let Some(joint) = self.opened() {
            return Err(Reason::Contradiction(joint));
        }
        // The pose takes the new values with the new q, or keeps both as they are.
        std::mem::swap(&mut self.pose.drivers, &mut self.next_drivers);
        self.at.copy_pose(&mut self.pose.q);
        self.regularity = correction.regularity;
        progress.iterations = progress.iterations.saturating_add(correction.iterations);
        progress.checked = progress.checked.saturating_add(self.tubes.checked.into());
        Ok(true)
    }

    /// Moves the bodies to the end of a sub-step, the pose apart; `None` if that is not proved.
    fn reach(
        &mut self,
        path: &Path,
        [start, end]: [f64; 2],
        boxes: bool,
    ) -> Result<Option<Correction>, Error> {
        self.set_path(path, end)?;
        self.tubes.begin(boxes);
        if !self.bound_course(path, [start, end])? {
            return Ok(None);
        }
        let advance = self.advance_of(end - start);
        let unit = self.has_unit().then_some(&UNIT[..]);
        let mut work = Work {
            system: &self.system,
            targets: &self.targets,
            drivers: &self.next_drivers,
            at: &mut self.at,
            flow: &mut self.flow,
        };
        let mut substep = Substep {
            advance,
            from: &self.pose.q,
            tubes: &mut self.tubes,
        };
        Ok(self.plan.advance(&mut work, &mut substep, unit).ok())
    }

    /// Takes time, parameters and drivers from the path at s, leaving q and the pose's drivers,
    /// which go with it, as they are.
    pub(in crate::kinematics) fn set_path(&mut self, path: &Path, s: f64) -> Result<(), Error> {
        self.drive(path, s);
        self.pose.time = path.time(s);
        for (value, jet) in self.next_drivers.iter_mut().zip(&self.path_drivers) {
            *value = jet.value;
        }
        if self.parameters_move {
            let parameters = self.pose.parameters.iter_mut();
            for (value, jet) in parameters.zip(&self.path_parameters) {
                *value = jet.value;
            }
            self.take_over_parameters()?;
        }
        self.system.check_drivers(&self.next_drivers)
    }

    /// The drivers along the path at s, with their derivatives.
    pub(in crate::kinematics) fn drive(&mut self, path: &Path, s: f64) {
        let Self {
            system,
            motions,
            path_motions,
            path_parameters,
            parameters_move,
            path_drivers,
            ..
        } = self;
        let mechanism = system.mechanism();
        if *parameters_move {
            path.parameters(mechanism, s, path_parameters);
            path_motions.set_parameters(|p| path_parameters[p.index()]);
            path.drivers(s, path_motions, path_drivers);
        } else {
            path.drivers(s, motions, path_drivers);
        }
    }

    /// The drivers' values at the end of a path.
    pub fn drivers_at_end(&mut self, path: &Path) -> Vec<f64> {
        self.path_motions
            .set_parameters(|p| Jet::constant(path.to[p.index()]));
        path.drivers(1.0, &self.path_motions, &mut self.path_drivers);
        self.path_drivers
            .iter()
            .map(|driver| driver.value)
            .collect()
    }

    /// Returns from a sub-step that failed to the pose, which was reached at s.
    pub(in crate::kinematics) fn stand_at(&mut self, path: &Path, s: f64) {
        self.pose.time = self.origin_time;
        if self.parameters_move {
            self.pose
                .parameters
                .copy_from_slice(&self.origin_parameters);
            self.take_over_parameters()
                .expect("these parameters were in force before");
        }
        self.drive(path, s);
        self.stand_at_pose();
        self.refresh()
            .expect("the pose was regular when it was reached");
        self.predict();
    }
}
