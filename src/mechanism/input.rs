//! Inputs: numbers that come from outside while a mechanism moves.

use super::{Expression, Load, Mechanism, Unit};

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
    /// What a run gives it, an expression in t and the parameters: it is no input any more then.
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
    /// What it is.
    pub target: LoadTarget,
}

/// What a load is.
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

    /// Gives a load a size, an expression in t and the parameters: it is no input any more.
    pub fn give_load(&mut self, target: LoadTarget, size: Expression) {
        match target {
            LoadTarget::Input(index) => self.inputs[index].given = Some(size),
            LoadTarget::Force(force, component) => {
                self.forces[force].load.set_component(component, size);
            }
        }
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
