//! Bounds of the numbers in the equations while parameters move.

use crate::kinematics::configuration::Configuration;
use crate::kinematics::path::Path;
use crate::kinematics::system::{System, Target, Targets};
use crate::mechanism::{Expression, Interval, Jet3, MarkerId};

/// Bounds of the difference of each number in the equations from its value at the end of a
/// sub-step, over the whole sub-step.
#[derive(Debug)]
pub(in crate::kinematics) struct ParameterBounds {
    /// Whether parameters move.
    pub(in crate::kinematics) moving: bool,
    /// All parameters over the sub-step, as functions of s.
    pub(in crate::kinematics) parameters: Vec<Jet3<Interval>>,
    /// Bounds of s of each marker \[m\], and of its angle \[rad\].
    positions: Vec<f64>,
    angles: Vec<f64>,
    /// Bounds of the target of each row, zero for drivers \[m or rad\].
    constants: Vec<f64>,
}

impl ParameterBounds {
    pub(super) fn new(system: &System) -> Self {
        let mechanism = system.mechanism();
        let markers = mechanism.markers.len();
        Self {
            moving: false,
            parameters: vec![Jet3::constant(0.0); mechanism.parameters.len()],
            positions: vec![0.0; markers],
            angles: vec![0.0; markers],
            constants: vec![0.0; system.equations().len()],
        }
    }

    /// Bounds the difference of a marker's point, in its body's frame \[m\].
    pub(in crate::kinematics) fn position(&self, marker: MarkerId) -> f64 {
        self.positions[marker.index()]
    }

    /// Bounds the difference of a marker's angle \[rad\].
    pub(in crate::kinematics) fn angle(&self, marker: MarkerId) -> f64 {
        self.angles[marker.index()]
    }

    /// Bounds the difference of a row's target; zero for a driver's.
    pub(in crate::kinematics) fn constant(&self, row: usize) -> f64 {
        self.constants[row]
    }

    /// Bounds all numbers over a part of `path`, at whose end the values in force are. Returns
    /// false if a number is not bounded.
    #[inline(never)]
    pub(in crate::kinematics) fn bound(
        &mut self,
        system: &System,
        at: &Configuration,
        targets: &Targets,
        path: &Path,
        [start, end]: [f64; 2],
    ) -> bool {
        let mechanism = system.mechanism();
        let value = |s: f64, from: f64, to: f64| if s < 1.0 { from + s * (to - from) } else { to };
        let branches = path.from.iter().zip(&path.to);
        for (parameter, (&from, &to)) in self.parameters.iter_mut().zip(branches) {
            let ends = [value(start, from, to), value(end, from, to)];
            let range = Interval::new(ends[0].min(ends[1]), ends[0].max(ends[1]));
            *parameter = Jet3::linear(range, Interval::point(to - from));
        }
        mechanism.derive_parameters(&mut self.parameters);
        let parameters = &self.parameters;
        let differs = |expression: &Expression, in_force: f64| {
            let range = expression.evaluate(&|p| Jet3::fixed(parameters[p.index()].value), {
                Jet3::constant(0.0)
            });
            (range.value - Interval::point(in_force)).magnitude()
        };
        let mut sum = 0.0;
        let markers = self.positions.iter_mut().zip(&mut self.angles);
        for (index, (position, angle)) in markers.enumerate() {
            let marker = &mechanism.markers[index];
            let (s, turned) = at.local(MarkerId(index));
            let [x, y] = [0, 1].map(|axis| differs(&marker.position[axis], s[axis]));
            *position = x.hypot(y);
            *angle = differs(&marker.angle, turned);
            sum += *position + *angle;
        }
        let rows = self.constants.iter_mut().zip(system.equations());
        for (row, (constant, equation)) in rows.enumerate() {
            if let Target::Constant(expression) = &equation.target {
                *constant = differs(expression, targets.constant(row));
                sum += *constant;
            }
        }
        sum.is_finite()
    }
}
