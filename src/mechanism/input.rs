//! Inputs: numbers that come from outside while a mechanism moves.

use super::{Driver, DriverSource, Expression, Load, Mechanism, PrescribedMotion, Unit};

/// A number that comes from outside, such as a voltage: an FMI input.
#[derive(Clone, Debug)]
pub struct Input {
    /// Name, unique among all named things of the mechanism.
    pub name: String,
    /// Description in one line, empty if the file gives none.
    pub description: String,
    /// Unit of its values, `None` if the file gives none.
    pub unit: Option<Unit>,
    /// Value at the start.
    pub start: f64,
    /// Lower limit, which advises.
    pub min: Option<f64>,
    /// Upper limit, likewise.
    pub max: Option<f64>,
    /// Motion that a run gives it, an expression in t and the parameters: it is no input any more then.
    pub given: Option<Expression>,
}

/// A number that a host gives while the mechanism moves, besides the values of drivers: an input, or a
/// component of a force that has no size of its own.
#[derive(Clone, Debug)]
pub struct LoadInput {
    /// Name of its variable, such as `voltage`, `cylinder.effort` or `load.fx`.
    pub name: String,
    /// Description in one line.
    pub description: String,
    /// Unit of its values, `None` for an input without.
    pub unit: Option<Unit>,
    /// Value at the start, zero for a force.
    pub start: f64,
    /// Lower and upper limit.
    pub limits: [Option<f64>; 2],
    /// The thing itself.
    pub target: LoadTarget,
}

/// The kind of a load.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoadTarget {
    /// An input, by its index.
    Input(usize),
    /// A component of a force: their indices.
    Force(usize, usize),
}

impl Mechanism {
    /// Returns what a host gives besides the values of drivers: inputs, then components of forces, in file
    /// order. Loads are in this order; those of passive forces come behind.
    #[must_use]
    pub fn load_inputs(&self) -> Vec<LoadInput> {
        let inputs = self.inputs.iter().enumerate();
        let inputs = inputs.filter(|(_, input)| input.given.is_none());
        let inputs = inputs.map(|(index, input)| LoadInput {
            name: input.name.clone(),
            description: input.description.clone(),
            unit: input.unit,
            start: input.start,
            limits: [input.min, input.max],
            target: LoadTarget::Input(index),
        });
        let forces = self.force_inputs().into_iter();
        let forces = forces.map(|component| LoadInput {
            name: component.name,
            description: component.description,
            unit: Some(component.unit),
            start: 0.0,
            limits: [None; 2],
            target: LoadTarget::Force(component.force, component.component),
        });
        inputs.chain(forces).collect()
    }

    /// Gives a load a size, an expression in t and the parameters: it is no input any more. Returns whether
    /// that is possible: the motions of drivers that follow an input may become nested too deeply.
    #[must_use]
    pub fn give_load(&mut self, target: LoadTarget, size: Expression) -> bool {
        match target {
            LoadTarget::Input(index) => {
                self.inputs[index].given = Some(size);
                self.resolve_motions()
            }
            LoadTarget::Force(force, component) => {
                self.forces[force].load.set_component(component, size);
                true
            }
        }
    }

    /// Makes the motions of drivers that follow inputs those for what these are given, or for their values
    /// at the start.
    fn resolve_motions(&mut self) -> bool {
        let inputs = &self.inputs;
        let in_place = |index: usize| {
            let Input { given, start, .. } = &inputs[index];
            given
                .clone()
                .unwrap_or_else(|| Expression::constant(*start))
        };
        self.drivers.iter_mut().all(|driver| {
            let Some(follows) = &driver.follows else {
                return true;
            };
            let motion = follows.with_inputs(in_place);
            let is_possible = motion.is_some();
            if let Some(motion) = motion {
                driver.source = DriverSource::Motion(PrescribedMotion::Expression(motion));
            }
            is_possible
        })
    }

    /// Returns the driver whose motion follows an input, if there is one.
    #[must_use]
    pub fn follower(&self, target: LoadTarget) -> Option<&Driver> {
        let LoadTarget::Input(input) = target else {
            return None;
        };
        let mut drivers = self.drivers.iter();
        drivers.find(|driver| {
            let mut inputs = driver.follows.iter().flat_map(Expression::inputs);
            inputs.any(|index| index == input)
        })
    }

    /// Returns the places among the loads of the inputs, and of the first component of each force: `None`
    /// for what has a size. Returns the number of loads, too.
    #[must_use]
    pub fn load_places(&self) -> ([Vec<Option<usize>>; 2], usize) {
        let mut next = 0;
        let mut take = |count: usize| {
            next += count;
            next - count
        };
        let inputs = self.inputs.iter();
        let inputs = inputs.map(|input| input.given.is_none().then(|| take(1)));
        let inputs = inputs.collect();
        let mut forces = vec![None; self.forces.len()];
        for is_passive in [false, true] {
            for (place, force) in forces.iter_mut().zip(&self.forces) {
                let count = match &force.load {
                    Load::Passive { .. } if is_passive => 1,
                    load if !is_passive && load.is_input() => load.components(),
                    _ => continue,
                };
                *place = Some(take(count));
            }
        }
        ([inputs, forces], next)
    }

    /// Writes the values that loads have at the start.
    pub fn write_load_starts(&self, loads: &mut [f64]) {
        for (load, input) in loads.iter_mut().zip(self.load_inputs()) {
            *load = input.start;
        }
    }
}
