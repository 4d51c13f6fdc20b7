//! The proof that one and only one continuous motion joins the two ends of a sub-step.
//!
//! Along a sub-step, s from 0 to 1, everything that moves a part of the mechanism from outside
//! runs as p(s): drivers, parameters, the bodies found before. Its equations are F(z, p) = 0 with
//! J = ∂F/∂z. Newton–Raphson gives the roots z0 and z1 at both ends; z̄(s) = z0 + s (z1 − z0) is
//! the *chord*. If there are radii r > 0, one an unknown, with
//!
//! > η + K r < r in every component,
//! >
//! > η ≥ |A(s) F(z̄(s), p(s))| and K ≥ |I − A(s) J(z, p(s))| for all s and |z − z̄(s)| ≤ r
//!
//! for some matrices A(s), then for each s the map z − A F(z, p(s)) takes the box around z̄(s)
//! into itself and contracts there. So the box has exactly one root, J is regular in it, the root
//! moves continuously with s, and it joins z0 to z1. Any A will do; one that depends on s may,
//! too, as nothing is asked of it from one s to another.
//!
//! A chord whose ends are roots leaves F open by no more than an eighth of a bound of its second
//! derivative along it. The radii are a [`Tube`] around the chord in which the true motion stays:
//! parts that come later take it as the uncertainty of their p(s). Each kernel of the plan tests
//! its own part so, right behind Newton–Raphson; how is told there. What the rounding of both
//! ends leaves open is part of η.
//!
//! A test is *proved* unless [`Tubes::checked`] says that some bound in it was an estimate: the
//! norm of an inverse that is too large to be written down, or how parameters on their way move
//! the equations of a part that no straight code solves.

mod parameters;
#[cfg(test)]
mod tests;

use nalgebra::Vector2;

pub(super) use parameters::ParameterBounds;

use super::newton::Rejected;
use super::system::System;

/// Where a body stays during a sub-step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tube {
    /// Cosine and sine of its angle at the start.
    pub(super) cos: f64,
    pub(super) sin: f64,
    /// How far it turns from one end to the other \[rad\].
    pub(super) turn: f64,
    /// How far its angle may be off the chord \[rad\].
    pub(super) radius: f64,
    /// How far its pivot may be off the straight line between its two ends \[m\].
    pub(super) stray: f64,
}

/// The tubes of everything that moves, kernel by kernel, and how the test went.
#[derive(Debug)]
pub(super) struct Tubes {
    bodies: Vec<Tube>,
    /// The point of each body, in its frame, that [`Tube::stray`] speaks of: where it is pinned
    /// to what is found before, if it is; else its origin.
    pivots: Vec<Vector2<f64>>,
    /// How far the origin may be off its chord in x and in y, of bodies that no straight code
    /// places \[m\].
    origins: Vec<Option<[f64; 2]>>,
    /// Radii of the joints' own unknowns \[rad\].
    joint_unknowns: Vec<f64>,
    /// How far each driver's value may be off its chord \[m or rad\].
    pub(super) drivers: Vec<f64>,
    pub(super) slips: ParameterBounds,
    /// The largest load of a kernel, see [`bear`](Self::bear).
    load: f64,
    /// Whether some bound was an estimate.
    pub(super) checked: bool,
    /// Whether proofs that hold for several steps may be used and made, and whether one was used.
    pub(super) boxes: bool,
    pub(super) relied_on_box: bool,
    /// Work space of [`Region`](super::constraint::Region)s: a radius and a chord an unknown,
    /// zero between uses.
    pub(super) region: Vec<f64>,
    pub(super) chord: Vec<f64>,
}

/// The load that a test bears, of at most one.
const MARGIN: f64 = 0.9;

impl Tubes {
    /// For a system of equations.
    pub(super) fn new(system: &System) -> Self {
        let bodies = system.mechanism().bodies.len();
        let unknowns = system.unknowns();
        let drivers = system.mechanism().drivers.len();
        Self {
            bodies: vec![Tube::default(); bodies],
            pivots: vec![Vector2::zeros(); bodies],
            origins: vec![None; bodies],
            joint_unknowns: vec![0.0; unknowns - 3 * bodies],
            drivers: vec![0.0; drivers],
            slips: ParameterBounds::new(system),
            load: 0.0,
            checked: false,
            boxes: false,
            relied_on_box: false,
            region: vec![0.0; unknowns],
            chord: vec![0.0; unknowns],
        }
    }

    /// Begins a sub-step, with or without proofs that hold for several steps.
    pub(super) fn begin(&mut self, boxes: bool) {
        self.load = 0.0;
        self.checked = false;
        self.boxes = boxes;
        self.relied_on_box = false;
    }

    /// What moving parameters add; `None` while they rest.
    pub(super) fn slips(&self) -> Option<&ParameterBounds> {
        self.slips.of_moving()
    }

    #[inline(always)]
    pub(super) fn body(&self, place: usize) -> &Tube {
        &self.bodies[place]
    }

    #[inline(always)]
    pub(super) fn body_mut(&mut self, place: usize) -> &mut Tube {
        &mut self.bodies[place]
    }

    /// The pivot of a body, in its frame.
    pub(super) fn pivot(&self, place: usize) -> Vector2<f64> {
        self.pivots[place]
    }

    /// Takes over where a body is pinned.
    pub(super) fn set_pivot(&mut self, place: usize, pivot: Vector2<f64>) {
        self.pivots[place] = pivot;
    }

    /// How far the unknown q\[column\] may be off its chord.
    pub(super) fn radius(&self, column: usize) -> f64 {
        let place = column / 3;
        let Some(tube) = self.bodies.get(place) else {
            return self.joint_unknowns[column - 3 * self.bodies.len()];
        };
        match (column % 3, self.origins[place]) {
            (2, _) => tube.radius,
            (component, Some(origin)) => origin[component],
            (_, None) => tube.stray + tube.arc(self.pivots[place].norm()),
        }
    }

    /// Sets how far the origin of a body that no straight code places may be off in x or y.
    pub(super) fn set_component(&mut self, place: usize, component: usize, radius: f64) {
        let origin = self.origins[place].get_or_insert([0.0; 2]);
        origin[component] = radius;
        self.bodies[place].stray = origin[0].hypot(origin[1]);
    }

    /// Sets the radius of a joint's own unknown.
    pub(super) fn set_joint_unknown(&mut self, column: usize, radius: f64) {
        self.joint_unknowns[column - 3 * self.bodies.len()] = radius;
    }

    /// Notes a kernel's load: by how much, squared, its sub-step is longer than the longest that
    /// it bears. Bounds of second derivatives grow with the square of the sub-step.
    ///
    /// # Errors
    ///
    /// It is larger than one.
    #[inline(always)]
    pub(super) fn bear(&mut self, load: f64) -> Result<(), Rejected> {
        if load > self.load {
            self.load = load;
        }
        // Not so for what is not a number.
        if load <= 1.0 {
            Ok(())
        } else {
            self.load = load;
            Err(Rejected)
        }
    }

    /// The load of the sub-step so far; infinite or not a number where nothing is known.
    pub(super) fn load(&self) -> f64 {
        self.load
    }

    /// Notes that a kernel found no root, or bounds nothing: nothing is known of the load.
    pub(super) fn break_off(&mut self) -> Rejected {
        self.load = f64::INFINITY;
        Rejected
    }
}

impl Tube {
    /// How far a point is off its chord that is `length` away from the pivot: the arc over the
    /// turn lies off by an eighth of its square, and turned by the radius.
    #[inline(always)]
    pub(super) fn arc(&self, length: f64) -> f64 {
        length * (sagitta(self.turn) + self.radius)
    }
}

/// How far a unit vector that turns evenly is off its chord, at the most.
#[inline(always)]
pub(super) fn sagitta(turn: f64) -> f64 {
    0.125 * turn * turn
}

/// A gap g > 0 with `open` + `linear` g + `square` g² < g, or none.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gap {
    /// As [`Tubes::bear`] has it: above one there may be no such gap.
    pub(super) load: f64,
    /// The gap, if the load is at most one: somewhat larger than the least there is.
    pub(super) value: f64,
}

impl Gap {
    /// `open` is positive. With q = 4 `open` `square` / (1 − `linear`)² the least g is
    /// (`open` / (1 − `linear`)) · 2 (1 − √(1 − q)) / q, whose last factor lies below 1 + 0.6 q
    /// up to q = 0.9; the load is never less than q / 0.9.
    #[inline(always)]
    pub(super) fn new(open: f64, linear: f64, square: f64) -> Self {
        let load = (4.0 * open * square + 2.0 * linear) * (1.0 / MARGIN);
        Self {
            load,
            value: open * (1.0 + 0.6 * load) / (1.0 - linear),
        }
    }
}
