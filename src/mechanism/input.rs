//! Inputs: numbers that come from outside while a mechanism moves.

use super::{
    Driver, DriverSource, Expression, Load, Mechanism, Number, ParameterId, PrescribedMotion, Unit,
    Variable,
};

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
                for driver in &mut self.drivers {
                    let Some(follows) = &driver.follows else {
                        continue;
                    };
                    let given = follows.with_inputs(|input| (input == index).then(|| size.clone()));
                    if given.is_none() {
                        return false;
                    }
                    driver.follows = given;
                }
                self.inputs[index].given = Some(size);
                self.resolve_motions()
            }
            LoadTarget::Force(force, component) => {
                self.forces[force].load.set_component(component, size);
                true
            }
        }
    }

    /// Returns whether a driver follows an input, by its index.
    #[must_use]
    pub fn has_followers(&self, input: usize) -> bool {
        let followed = self
            .drivers
            .iter()
            .filter_map(|driver| driver.follows.as_ref());
        followed
            .flat_map(Expression::inputs)
            .any(|index| index == input)
    }

    /// Sets the value of an input at the start; the motions of drivers that follow it start there.
    pub fn set_input_start(&mut self, input: usize, start: f64) {
        self.inputs[input].start = start;
        let is_possible = self.resolve_motions();
        debug_assert!(is_possible, "a number is nested as an input is");
    }

    /// Makes the motions of drivers that follow inputs those for the values of these at the start.
    fn resolve_motions(&mut self) -> bool {
        let inputs = &self.inputs;
        let start = |index: usize| Some(Expression::constant(inputs[index].start));
        self.drivers.iter_mut().all(|driver| {
            let Some(follows) = &driver.follows else {
                return true;
            };
            let motion = follows.with_inputs(start);
            let is_possible = motion.is_some();
            if let Some(motion) = motion {
                driver.source = DriverSource::Motion(PrescribedMotion::Expression(motion));
            }
            is_possible
        })
    }

    /// Gives the drivers that follow an input of these from outside, as those that are inputs: a host tells
    /// what they [follow](Driver::followed). Each starts at its motion's value at a time \[s\].
    pub fn give_followers(
        &mut self,
        is_given: impl Fn(usize) -> bool,
        parameters: &[f64],
        time: f64,
    ) {
        for driver in &mut self.drivers {
            let mut inputs = driver.follows.iter().flat_map(Expression::inputs);
            if inputs.any(&is_given)
                && let DriverSource::Motion(PrescribedMotion::Expression(motion)) = &driver.source
            {
                let start = motion.evaluate(&|p: ParameterId| parameters[p.index()], time);
                driver.source = DriverSource::Input { start };
            }
        }
    }

    /// Returns the value of an input at a time \[s\], for these parameters and loads \[SI\]. Allocates
    /// nothing.
    #[must_use]
    pub fn input_value(&self, input: usize, parameters: &[f64], loads: &[f64], time: f64) -> f64 {
        match &self.inputs[input].given {
            Some(size) => size.evaluate(&|p: ParameterId| parameters[p.index()], time),
            None => loads[self.input_place(input)],
        }
    }

    /// Returns the place of an input among the loads, if nothing else gives it.
    #[must_use]
    pub fn input_place(&self, input: usize) -> usize {
        let before = self.inputs[..input].iter();
        before.filter(|input| input.given.is_none()).count()
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

impl Driver {
    /// Returns whether it follows inputs whose values a host tells, and is given from outside itself.
    #[must_use]
    pub fn is_moved_by_inputs(&self) -> bool {
        self.is_given() && self.follows.is_some()
    }

    /// Returns the value of its motion for these values of inputs, by their indices; `None` unless it
    /// follows some. On jets with their rates. Allocates nothing.
    pub fn followed<N: Number>(
        &self,
        parameter: &impl Fn(ParameterId) -> N,
        input: &impl Fn(usize) -> N,
        time: N,
    ) -> Option<N> {
        let follows = self.follows.as_ref()?;
        let variable = |which| match which {
            Variable::Input(index) => input(index),
            _ => time,
        };
        Some(follows.evaluate_at(parameter, &variable))
    }
}
