//! The order of work: which unknowns are found when, each group of them by a kernel of its own.
//!
//! A plan is compiled once from the equations and their block structure. It lists kernels so
//! that each reads only what those before it have found. Position, velocity and acceleration go
//! through the list once; the work is proportional to the number of bodies.
//!
//! | kernel | unknowns | how |
//! |---|---|---|
//! | [`Pinned`] | x, y, phi of a body | straight from a revolute and an angle |
//! | [`RrrDyad`] | x, y, phi of two bodies | Newton on two angles, 2×2 in closed form |
//! | [`RrpDyad`] | x, y, phi of one or two bodies, one point on a line | Newton on one angle |
//! | [`Coupled`] | any block | Newton on its rows, whatever they are |
//! | [`Interpolated`] | those of any kernel near a change point | the interpolated motion |

mod anchor;
mod compile;
mod coupled;
mod crossing;
mod elimination;
mod interpolated;
mod jacobian;
mod pinned;
mod reach;
mod rrp_dyad;
mod rrr_dyad;
mod work;

use std::f64::consts::FRAC_PI_2;

use super::certificate::Tubes;
use super::configuration::Configuration;
use super::newton::{Correction, Rejected};
use super::path::Rates;
use super::system::{System, Targets};
use crate::mechanism::Jet;

pub(super) use coupled::Coupled;
pub use crossing::Crossing;
pub(super) use crossing::SEAM;
pub(super) use interpolated::Interpolated;
pub(super) use jacobian::General;
use pinned::Pinned;
pub(super) use reach::Miss;
use rrp_dyad::RrpDyad;
use rrr_dyad::RrrDyad;
pub(super) use work::{Advance, Substep, Work};

/// The kernels in the order in which they run.
#[derive(Debug, Default)]
pub(super) struct Plan {
    pub(super) kernels: Vec<Kernel>,
}

/// What finds the unknowns of one part of the mechanism.
#[derive(Debug)]
#[allow(
    clippy::large_enum_variant,
    reason = "most kernels are dyads, which lie side by side as they are"
)]
pub(super) enum Kernel {
    Pinned(Box<Pinned>),
    RrrDyad(RrrDyad),
    RrpDyad(Box<RrpDyad>),
    Coupled(Box<Coupled>),
    Interpolated(Box<Interpolated>),
}

impl Plan {
    /// Takes over what depends on the parameters alone. Allocates nothing.
    pub(super) fn set_parameters(
        &mut self,
        at: &Configuration,
        targets: &Targets,
        tubes: &mut Tubes,
    ) {
        for kernel in &mut self.kernels {
            match kernel {
                Kernel::Pinned(kernel) => kernel.set_parameters(at, tubes),
                Kernel::RrrDyad(kernel) => kernel.set_parameters(at, tubes),
                Kernel::RrpDyad(kernel) => kernel.set_parameters(at, targets, tubes),
                Kernel::Coupled(kernel) => kernel.forget_box(),
                // Parameters do not move while a crossing is in force.
                Kernel::Interpolated(_) => {}
            }
        }
    }

    /// Chooses the pivots of sparse matrices, at a pose that has nothing to do with any motion:
    /// so they do not depend on where the mechanism has been.
    pub(super) fn choose_pivots(&mut self, system: &System, at: &Configuration, targets: &Targets) {
        let kernels = self.kernels.iter_mut();
        let sparse = kernels.filter_map(|kernel| match kernel {
            Kernel::Coupled(kernel) if kernel.is_sparse() => Some(kernel),
            _ => None,
        });
        let mut sparse = sparse.peekable();
        if sparse.peek().is_none() {
            return;
        }
        // Spread evenly by the golden ratio: nothing is in line or at right angles there.
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let q: Vec<_> = (1..=system.unknowns())
            .map(|k| at.size() * (GOLDEN * k as f64).fract() + (k % 3) as f64)
            .collect();
        let mut anywhere = at.clone();
        anywhere.set_pose(system.mechanism(), &q);
        let work = Work {
            system,
            targets,
            drivers: &vec![1.0; system.mechanism().drivers.len()],
            at: &mut anywhere,
            flow: &mut Rates::new(0),
        };
        for kernel in sparse {
            // Should the pose be singular, the pivots are chosen at the first one that is not.
            kernel.choose_pivots(&work);
        }
    }

    /// Lets go of what proofs for earlier steps are kept for others.
    pub(super) fn forget_boxes(&mut self) {
        for kernel in &mut self.kernels {
            if let Some(kernel) = kernel.coupled_mut() {
                kernel.forget_box();
            }
        }
    }

    /// Lets sparse matrices choose their pivots anew; the plan has then to be factorised again.
    pub(super) fn forget_pivots(&mut self) {
        for kernel in &mut self.kernels {
            if let Some(kernel) = kernel.coupled_mut() {
                kernel.forget_pivots();
            }
        }
    }

    /// Goes from the pose at which all kernels are factorised to the one that belongs to new
    /// values of the drivers: predicts along the flow, corrects, and proves that the motion leads
    /// there, kernel by kernel. With `unit`, the flow becomes the one for these rates of the
    /// drivers at the new pose on the way.
    ///
    /// # Errors
    ///
    /// A kernel cannot show that it stayed on its motion; [`Tubes::load`] tells by how much. What
    /// was found up to there is then in `work`, to be put back.
    pub(super) fn advance(
        &mut self,
        work: &mut Work<'_>,
        substep: &mut Substep<'_>,
        unit: Option<&[Jet]>,
    ) -> Result<Correction, Rejected> {
        let mut most = Correction::default();
        for kernel in &mut self.kernels {
            let correction = match kernel {
                Kernel::Pinned(kernel) => {
                    let correction = kernel.advance(work, substep);
                    if let Some(unit) = unit {
                        kernel.solve_rates(work, unit);
                    }
                    correction
                }
                Kernel::RrrDyad(kernel) => {
                    let correction = kernel.advance(work, substep)?;
                    if unit.is_some() {
                        kernel.solve_rates(work);
                    }
                    correction
                }
                Kernel::RrpDyad(kernel) => {
                    let correction = kernel.advance(work, substep)?;
                    if let Some(unit) = unit {
                        kernel.solve_rates(work, unit);
                    }
                    correction
                }
                Kernel::Coupled(kernel) => {
                    let correction = kernel.advance(work, substep)?;
                    if let Some(unit) = unit {
                        kernel.solve_rates(work, unit);
                    }
                    correction
                }
                Kernel::Interpolated(kernel) => {
                    let correction = kernel.advance(work, substep)?;
                    if let Some(unit) = unit {
                        kernel.solve_rates(work, unit);
                    }
                    correction
                }
            };
            most.iterations = most.iterations.max(correction.iterations);
            most.regularity = most.regularity.min(correction.regularity);
        }
        Ok(most)
    }

    /// Factorises every kernel at the pose in `work`.
    ///
    /// # Errors
    ///
    /// [`Rejected`] where a Jacobian is singular to the last bit.
    pub(super) fn factorise(&mut self, work: &mut Work<'_>) -> Result<(), Rejected> {
        let mut kernels = self.kernels.iter_mut();
        kernels.try_for_each(|kernel| kernel.factorise(work))
    }

    /// Makes the flow the one for these rates of the drivers (`first` and `second` of each) at
    /// the pose at which all kernels are factorised.
    pub(super) fn solve_rates(&mut self, work: &mut Work<'_>, drivers: &[Jet]) {
        for kernel in &mut self.kernels {
            kernel.solve_rates(work, drivers);
        }
    }

    /// The least [regularity](Correction::regularity) of all kernels, which are factorised.
    pub(super) fn regularity(&self) -> f64 {
        let kernels = self.kernels.iter();
        kernels.fold(1.0, |least: f64, kernel| least.min(kernel.regularity()))
    }

    /// The smallest transmission angle of all dyads and slides, which are factorised \[rad\].
    pub(super) fn transmission(&self) -> Option<f64> {
        let sines = self.kernels.iter().filter_map(Kernel::transmission);
        let least = sines.fold(f64::INFINITY, f64::min);
        // Next to 1 the last digits of a sine are half of the digits of its angle.
        let right = least > 1.0 - 8.0 * f64::EPSILON;
        least
            .is_finite()
            .then(|| if right { FRAC_PI_2 } else { least.asin() })
    }

    /// Scaled reciprocal condition: the smallest of all kernels, which are factorised.
    pub(super) fn rcond(&mut self) -> f64 {
        let kernels = self.kernels.iter_mut();
        kernels.fold(1.0, |smallest: f64, kernel| smallest.min(kernel.rcond()))
    }
}

impl Kernel {
    /// The block of any equations that it is, or that a crossing stands for.
    fn coupled_mut(&mut self) -> Option<&mut Coupled> {
        match self {
            Self::Coupled(kernel) => Some(kernel),
            Self::Interpolated(bridged) => bridged.kernel.coupled_mut(),
            Self::Pinned(_) | Self::RrrDyad(_) | Self::RrpDyad(_) => None,
        }
    }

    /// The rows of Phi that it satisfies.
    pub(super) fn rows(&self) -> &[usize] {
        match self {
            Self::Pinned(kernel) => kernel.rows(),
            Self::RrrDyad(kernel) => kernel.rows(),
            Self::RrpDyad(kernel) => kernel.rows(),
            Self::Coupled(kernel) => kernel.rows(),
            Self::Interpolated(bridged) => bridged.kernel.rows(),
        }
    }

    /// The unknowns that it finds, as many as rows.
    pub(super) fn columns(&self) -> &[usize] {
        match self {
            Self::Pinned(kernel) => kernel.columns(),
            Self::RrrDyad(kernel) => kernel.columns(),
            Self::RrpDyad(kernel) => kernel.columns(),
            Self::Coupled(kernel) => kernel.columns(),
            Self::Interpolated(bridged) => bridged.kernel.columns(),
        }
    }

    /// Scaled reciprocal condition: 1 is best, 0 singular.
    pub(super) fn rcond(&mut self) -> f64 {
        match self {
            Self::Pinned(_) => 1.0,
            Self::RrrDyad(kernel) => kernel.rcond(),
            Self::RrpDyad(kernel) => kernel.rcond(),
            Self::Coupled(kernel) => kernel.rcond(),
            Self::Interpolated(kernel) => kernel.rcond(),
        }
    }

    /// A cheap measure of how far from singular the pose is at which it is factorised.
    pub(super) fn regularity(&self) -> f64 {
        match self {
            Self::Pinned(_) => 1.0,
            Self::RrrDyad(kernel) => kernel.regularity(),
            Self::RrpDyad(kernel) => kernel.regularity(),
            Self::Coupled(kernel) => kernel.regularity(),
            // It is past the worst.
            Self::Interpolated(_) => 1.0,
        }
    }

    /// The sine of its transmission angle, if it has one.
    fn transmission(&self) -> Option<f64> {
        match self {
            Self::RrrDyad(kernel) => Some(kernel.regularity()),
            Self::RrpDyad(kernel) => Some(kernel.regularity()),
            Self::Pinned(_) | Self::Coupled(_) => None,
            Self::Interpolated(bridged) => bridged.kernel.transmission(),
        }
    }

    /// Newton–Raphson from where the bodies are, behind the kernels before it.
    pub(super) fn close(
        &mut self,
        work: &mut Work<'_>,
        max_iterations: u32,
    ) -> Result<Correction, Rejected> {
        match self {
            Self::Pinned(kernel) => {
                kernel.locate(work);
                Ok(Correction::default())
            }
            Self::RrrDyad(kernel) => kernel.close(work, max_iterations),
            Self::RrpDyad(kernel) => kernel.close(work, max_iterations),
            Self::Coupled(kernel) => kernel.correct(work, max_iterations),
            Self::Interpolated(kernel) => kernel.close(work),
        }
    }

    /// Factorises it at the pose in `work`.
    pub(super) fn factorise(&mut self, work: &mut Work<'_>) -> Result<(), Rejected> {
        match self {
            Self::Pinned(_) => Ok(()),
            Self::RrrDyad(kernel) => kernel.factorise(work),
            Self::RrpDyad(kernel) => kernel.factorise(work),
            Self::Coupled(kernel) => kernel.factorise(work),
            Self::Interpolated(kernel) => {
                kernel.factorise(work);
                Ok(())
            }
        }
    }

    /// Writes the rates of its unknowns at the pose at which it is factorised.
    pub(super) fn solve_rates(&mut self, work: &mut Work<'_>, drivers: &[Jet]) {
        match self {
            Self::Pinned(kernel) => kernel.solve_rates(work, drivers),
            Self::RrrDyad(kernel) => kernel.solve_rates(work),
            Self::RrpDyad(kernel) => kernel.solve_rates(work, drivers),
            Self::Coupled(kernel) => kernel.solve_rates(work, drivers),
            Self::Interpolated(kernel) => kernel.solve_rates(work, drivers),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::Kernel;
    use crate::kinematics::Solver;
    use crate::mechanism::{Mechanism, Source};

    /// A letter a kernel, `C` with the number of its unknowns.
    fn kernels(name: &str) -> String {
        let path = format!("{}/mechanisms/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(path).expect("it is shipped");
        let (mechanism, _) =
            Mechanism::parse(&Source::new("test.toml", text)).expect("it has no errors");
        let solver = Solver::new(Arc::new(mechanism)).expect("the drivers match");
        let letters = solver.plan.kernels.iter().map(|kernel| match kernel {
            Kernel::Pinned(_) => "P".to_owned(),
            Kernel::RrrDyad(_) => "D".to_owned(),
            Kernel::RrpDyad(_) => "S".to_owned(),
            Kernel::Coupled(coupled) => format!("C{}", coupled.columns().len()),
            Kernel::Interpolated(_) => "B".to_owned(),
        });
        letters.collect::<Vec<_>>().join(" ")
    }

    /// Work is a result, too: a mechanism that falls to a slower kernel shows here.
    #[test]
    fn each_part_has_the_kernel_that_suits_it() {
        for (name, expected) in [
            ("four_bar", "P D"),
            ("slider_crank", "P S"),
            ("tlv_crank", "P S"),
            ("slotted_lever", "P S S"),
            ("jansen_leg", "P D D D"),
            ("toggle_press", "P D S"),
            ("watt_six_bar", "P D D"),
            ("five_bar_robot", "P P D"),
            ("hart_inversor", "P D D"),
            // Driven between coupler and rocker: all three angles at once.
            ("double_rocker", "C1 C1 C1 C1 C5"),
        ] {
            assert_eq!(kernels(name), expected, "{name}");
        }
    }
}
