//! Single mechanisms in C; `yardstick/closed_form.h` and `yardstick/cam.h` say what each does.

#![allow(unsafe_code, reason = "calls into C")]

use std::ffi::c_uint;

use biela::mechanism::Jet;

use crate::motion::{Stepper, by_order};

/// Outputs of three bodies: x y phi vx vy omega ax ay alpha of each.
pub const OUTPUTS: usize = 27;
/// Forces of the four-bar: effort, power, inertia and bias of its driver, x and y of the forces of
/// its joints in the file's order, kinetic and potential energy.
pub const FORCES: usize = 14;
/// Outputs of two bodies, then of the contact: angle, velocity, acceleration.
const CONTACT_OUTPUTS: usize = 21;

// SAFETY: the declarations are those of the headers, a structure of doubles being laid out as an
// array. The functions read and write the arrays that they are given, and keep none.
unsafe extern "C" {
    safe static FOUR_BAR: [f64; 4];
    safe static FOUR_BAR_MASSES: [[f64; 4]; 3];
    safe static SLIDER_CRANK: [f64; 3];
    safe static CAM_ROLLER: [f64; 8];
    safe static CAM_FLAT: [f64; 8];
    safe static CAM_KNIFE: [f64; 2];
    safe fn four_bar_solve(
        lengths: &[f64; 4],
        angle: f64,
        velocity: f64,
        acceleration: f64,
        out: &mut [f64; OUTPUTS],
    );
    safe fn four_bar_forces(
        lengths: &[f64; 4],
        masses: &[[f64; 4]; 3],
        angle: f64,
        velocity: f64,
        acceleration: f64,
        out: &mut [f64; OUTPUTS],
        forces: &mut [f64; FORCES],
    );
    #[link_name = "four_bar_acceleration"]
    safe fn c_four_bar_acceleration(
        lengths: &[f64; 4],
        masses: &[[f64; 4]; 3],
        angle: f64,
        velocity: f64,
    ) -> f64;
    #[link_name = "pendulum_acceleration"]
    safe fn c_pendulum_acceleration(angle: f64) -> f64;
    safe fn slider_crank_solve(
        lengths: &[f64; 3],
        angle: f64,
        velocity: f64,
        acceleration: f64,
        out: &mut [f64; OUTPUTS],
    );
    safe fn cam_roller_step(
        cam: &mut [f64; 8],
        angle: f64,
        velocity: f64,
        acceleration: f64,
        out: &mut [f64; CONTACT_OUTPUTS],
    ) -> c_uint;
    safe fn cam_flat_step(
        cam: &mut [f64; 8],
        angle: f64,
        velocity: f64,
        acceleration: f64,
        out: &mut [f64; CONTACT_OUTPUTS],
    ) -> c_uint;
    safe fn cam_knife_solve(
        cam: &[f64; 2],
        angle: f64,
        velocity: f64,
        acceleration: f64,
        out: &mut [f64; 18],
    );
}

/// A mechanism in C with the numbers that it reads and writes.
#[derive(Clone, Debug)]
pub struct ByHand<const LENGTHS: usize, const OUT: usize> {
    solve: fn(&mut [f64; LENGTHS], Jet, &mut [f64; OUT]),
    /// Lengths \[m\], then the last contact of a cam.
    lengths: [f64; LENGTHS],
    out: [f64; OUT],
}

impl<const LENGTHS: usize, const OUT: usize> ByHand<LENGTHS, OUT> {
    fn new(lengths: [f64; LENGTHS], solve: fn(&mut [f64; LENGTHS], Jet, &mut [f64; OUT])) -> Self {
        Self {
            solve,
            lengths,
            out: [0.0; OUT],
        }
    }

    /// The outputs of one pose: for each body x y phi vx vy omega ax ay alpha.
    pub fn at(&mut self, driver: Jet) -> &[f64; OUT] {
        (self.solve)(&mut self.lengths, driver, &mut self.out);
        &self.out
    }
}

impl<const LENGTHS: usize, const OUT: usize> Stepper for ByHand<LENGTHS, OUT> {
    fn step(&mut self, drivers: &[Jet]) {
        self.at(drivers[0]);
    }

    fn state(&self) -> [Vec<f64>; 3] {
        by_order(&self.out)
    }
}

/// The four-bar of `mechanisms/four_bar.toml`.
#[must_use]
pub fn four_bar() -> ByHand<4, OUTPUTS> {
    ByHand::new(FOUR_BAR, |lengths, crank, out| {
        four_bar_solve(lengths, crank.value, crank.first(), crank.second(), out);
    })
}

/// The four-bar of [`with_masses`](crate::motion::with_masses), and its forces.
#[derive(Clone, Debug)]
pub struct FourBarForces {
    out: [f64; OUTPUTS],
    /// Forces of the last step.
    pub forces: [f64; FORCES],
}

impl FourBarForces {
    /// Makes room for the results.
    #[must_use]
    pub fn new() -> Self {
        Self {
            out: [0.0; OUTPUTS],
            forces: [0.0; FORCES],
        }
    }
}

impl Default for FourBarForces {
    fn default() -> Self {
        Self::new()
    }
}

impl Stepper for FourBarForces {
    fn step(&mut self, drivers: &[Jet]) {
        let crank = drivers[0];
        four_bar_forces(
            &FOUR_BAR,
            &FOUR_BAR_MASSES,
            crank.value,
            crank.first(),
            crank.second(),
            &mut self.out,
            &mut self.forces,
        );
    }

    fn state(&self) -> [Vec<f64>; 3] {
        by_order(&self.out)
    }
}

/// Mass, inertia and centre of crank, coupler and rocker of [`FourBarForces`].
#[must_use]
pub fn four_bar_masses() -> [[f64; 4]; 3] {
    FOUR_BAR_MASSES
}

/// The acceleration of that four-bar's crank where nothing drives it.
#[must_use]
pub fn four_bar_acceleration(angle: f64, velocity: f64) -> f64 {
    c_four_bar_acceleration(&FOUR_BAR, &FOUR_BAR_MASSES, angle, velocity)
}

/// The acceleration of a pendulum of 1 m with its mass at the end, at an angle from the level.
#[must_use]
pub fn pendulum_acceleration(angle: f64) -> f64 {
    c_pendulum_acceleration(angle)
}

/// The slider–crank of `mechanisms/slider_crank.toml`.
#[must_use]
pub fn slider_crank() -> ByHand<3, OUTPUTS> {
    slider_crank_of(SLIDER_CRANK)
}

/// A slider–crank of other lengths: crank, rod, height of the guide \[m\].
#[must_use]
pub fn slider_crank_of(lengths: [f64; 3]) -> ByHand<3, OUTPUTS> {
    ByHand::new(lengths, |lengths, crank, out| {
        slider_crank_solve(lengths, crank.value, crank.first(), crank.second(), out);
    })
}

/// The cam of `mechanisms/cam_roller.toml`.
#[must_use]
pub fn cam_roller() -> ByHand<8, CONTACT_OUTPUTS> {
    ByHand::new(CAM_ROLLER, |cam, angle, out| {
        let iterations = cam_roller_step(cam, angle.value, angle.first(), angle.second(), out);
        assert!(iterations > 0, "Newton converges");
    })
}

/// The cam of `mechanisms/cam_flat.toml`.
#[must_use]
pub fn cam_flat() -> ByHand<8, CONTACT_OUTPUTS> {
    ByHand::new(CAM_FLAT, |cam, angle, out| {
        let iterations = cam_flat_step(cam, angle.value, angle.first(), angle.second(), out);
        assert!(iterations > 0, "Newton converges");
    })
}

/// The cam of `mechanisms/cam_knife.toml`.
#[must_use]
pub fn cam_knife() -> ByHand<2, 18> {
    ByHand::new(CAM_KNIFE, |cam, angle, out| {
        cam_knife_solve(cam, angle.value, angle.first(), angle.second(), out);
    })
}
