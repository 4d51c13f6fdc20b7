//! A mechanism at a pose as links through pins, some of which slide on ground: all that programs for
//! linkages have.

use std::collections::{BTreeMap, BTreeSet};

use super::error::Error;
use super::note::Note;
use biela::kinematics::Solver;
use biela::mechanism::{
    BodyId, CoordinateKind, Expression, Joint, JointKind, MarkerId, Mechanism, rounded,
};

/// Instants at which the speed of an input is compared with that of the start.
const SPEEDS: u32 = 16;
/// Difference of two speeds that are one \[rad/s\]: their last digit as they are written, and its rounding.
const UNIFORM: f64 = 2e-9;

/// Links through pins. Lengths are in metres.
#[derive(Debug, Default)]
pub struct Pins {
    pub(super) name: String,
    pub(super) pins: Vec<Pin>,
    pub(super) links: Vec<Link>,
    pub(super) inputs: Vec<Input>,
    /// Remarks on what is left out.
    pub notes: Vec<Note>,
}

#[derive(Debug)]
pub(super) struct Pin {
    pub(super) name: String,
    pub(super) at: [f64; 2],
    /// Whether ground has it.
    pub(super) is_ground: bool,
    /// Direction of its way on ground \[rad\].
    pub(super) way: Option<f64>,
    /// Whether a program shall show its path.
    pub(super) is_shown: bool,
}

#[derive(Debug)]
pub(super) struct Link {
    pub(super) name: String,
    pub(super) pins: Vec<usize>,
}

/// A link that is turned about a pin on ground.
#[derive(Debug)]
pub(super) struct Input {
    pub(super) pin: usize,
    pub(super) link: usize,
    /// Speed, if the mechanism prescribes one \[rad/s\].
    pub(super) speed: Option<f64>,
}

/// A mechanism on its way.
struct Reader<'a> {
    mechanism: &'a Mechanism,
    solver: &'a Solver,
    pins: Pins,
    /// Pin of a body, or of ground, at a place that was looked up before.
    of_marker: BTreeMap<usize, usize>,
    /// Pins of each body.
    of_body: Vec<Vec<usize>>,
    /// Distance within which two points of a body are one \[m\].
    near: f64,
}

impl Pins {
    /// Returns the links of a mechanism at the solver's pose.
    ///
    /// # Errors
    ///
    /// The first joint that is neither a pin, nor a rod, nor a slide or slot on ground.
    pub fn new(solver: &Solver) -> Result<Self, Error> {
        let mechanism = solver.mechanism();
        let mut reader = Reader {
            mechanism,
            solver,
            pins: Self {
                name: mechanism.name.clone(),
                ..Self::default()
            },
            of_marker: BTreeMap::new(),
            of_body: vec![Vec::new(); mechanism.bodies.len()],
            near: 1e-9 * solver.size(),
        };
        reader.pins();
        reader.slides()?;
        reader.points();
        reader.levers();
        reader.links();
        reader.inputs();
        reader.pins.drop_unused();
        Ok(reader.pins)
    }

    /// Drops pins that no link has.
    fn drop_unused(&mut self) {
        let used: BTreeSet<usize> = self
            .links
            .iter()
            .flat_map(|link| &link.pins)
            .copied()
            .collect();
        let new = |pin: usize| used.range(..pin).count();
        for pin in self.links.iter_mut().flat_map(|link| &mut link.pins) {
            *pin = new(*pin);
        }
        for input in &mut self.inputs {
            input.pin = new(input.pin);
        }
        let mut index = 0..;
        self.pins
            .retain(|_| index.next().is_some_and(|pin| used.contains(&pin)));
    }
}

impl Reader<'_> {
    fn value(&self, expression: &Expression) -> f64 {
        expression.value(&self.solver.pose().parameters)
    }

    /// Returns the place of a marker and the direction of its x-axis.
    fn place(&self, marker: MarkerId) -> ([f64; 2], f64) {
        let marker = &self.mechanism.markers[marker.index()];
        let [x, y] = marker.position.each_ref().map(|e| self.value(e));
        let angle = self.value(&marker.angle);
        let Some(body) = marker.body else {
            return ([x, y], angle);
        };
        let q = &self.solver.pose().q[3 * body.index()..];
        let (sin, cos) = q[2].sin_cos();
        (
            [q[0] + x * cos - y * sin, q[1] + x * sin + y * cos],
            q[2] + angle,
        )
    }

    fn body(&self, marker: MarkerId) -> Option<BodyId> {
        self.mechanism.markers[marker.index()].body
    }

    /// Returns the pin at a marker, added if its body has none there.
    fn pin(&mut self, marker: MarkerId, name: &str) -> usize {
        if let Some(&pin) = self.of_marker.get(&marker.index()) {
            return pin;
        }
        let (at, _) = self.place(marker);
        let body = self.body(marker);
        let is_here = |pin: &Pin| (pin.at[0] - at[0]).hypot(pin.at[1] - at[1]) <= self.near;
        let known = match body {
            Some(body) => self.of_body[body.index()].clone(),
            None => (0..self.pins.pins.len())
                .filter(|pin| self.pins.pins[*pin].is_ground)
                .collect(),
        };
        let mut known = known
            .into_iter()
            .filter(|pin| is_here(&self.pins.pins[*pin]));
        let pin = known.next().unwrap_or_else(|| {
            self.pins.pins.push(Pin {
                name: name.to_owned(),
                at,
                is_ground: false,
                way: None,
                is_shown: false,
            });
            self.pins.pins.len() - 1
        });
        self.attach(marker, pin);
        pin
    }

    /// Gives a marker's body a pin.
    fn attach(&mut self, marker: MarkerId, pin: usize) {
        self.of_marker.insert(marker.index(), pin);
        match self.body(marker) {
            None => self.pins.pins[pin].is_ground = true,
            Some(body) => {
                let pins = &mut self.of_body[body.index()];
                if !pins.contains(&pin) {
                    pins.push(pin);
                }
            }
        }
    }

    /// Adds the pins of revolute joints and of rods.
    fn pins(&mut self) {
        for joint in &self.mechanism.joints {
            match joint.kind {
                JointKind::Revolute => {
                    let pin = self.pin(joint.from, &joint.name);
                    match self.of_marker.get(&joint.to.index()) {
                        Some(&other) if other != pin => self.unite(pin, other),
                        _ => self.attach(joint.to, pin),
                    }
                }
                JointKind::Link { .. } => {
                    let ends = [joint.from, joint.to].map(|end| {
                        let name = self.mechanism.markers[end.index()].name.clone();
                        self.pin(end, &name)
                    });
                    self.pins.links.push(Link {
                        name: joint.name.clone(),
                        pins: ends.to_vec(),
                    });
                }
                _ => {}
            }
        }
    }

    /// Makes two pins one, which stays under the first one's name.
    fn unite(&mut self, kept: usize, other: usize) {
        let replace = |pin: &mut usize| {
            if *pin == other {
                *pin = kept;
            }
        };
        self.of_marker.values_mut().for_each(replace);
        let links = self.pins.links.iter_mut().map(|link| &mut link.pins);
        for pins in self.of_body.iter_mut().chain(links) {
            pins.iter_mut().for_each(replace);
        }
        self.pins.pins[kept].is_ground |= self.pins.pins[other].is_ground;
    }

    /// Adds the ways of pins on ground.
    fn slides(&mut self) -> Result<(), Error> {
        let on_ground = |marker| self.body(marker).is_none();
        let is_known = |joint: &&Joint| match joint.kind {
            JointKind::Revolute | JointKind::Link { .. } => true,
            JointKind::Slot => on_ground(joint.from),
            JointKind::Translational => on_ground(joint.from) || on_ground(joint.to),
            _ => false,
        };
        let refused = |joint: &Joint| Error::NoLinkage {
            joint: joint.name.clone(),
        };
        let mut joints = self.mechanism.joints.iter();
        if let Some(unknown) = joints.find(|joint| !is_known(joint)) {
            return Err(refused(unknown));
        }
        for joint in &self.mechanism.joints {
            let pin = match joint.kind {
                JointKind::Slot => self.pin(joint.to, &joint.name),
                JointKind::Translational => {
                    let mut bodies = [joint.to, joint.from].into_iter();
                    let body = bodies.find_map(|marker| self.body(marker));
                    let pins = body.map_or(&[][..], |body| &self.of_body[body.index()]);
                    // The block of a slider has one pin, and cannot turn.
                    match *pins {
                        [only] => only,
                        _ => return Err(refused(joint)),
                    }
                }
                _ => continue,
            };
            let (_, angle) = self.place(joint.from);
            self.pins.pins[pin].way = Some(angle);
        }
        match self.mechanism.constraints.first() {
            Some(constraint) => Err(Error::NoLinkage {
                joint: constraint.name.clone(),
            }),
            None => Ok(()),
        }
    }

    /// Gives bodies with one pin, which are no links there, a point apart from it. Blocks of sliders
    /// are links with one pin.
    fn levers(&mut self) {
        for (index, marker) in self.mechanism.markers.iter().enumerate() {
            let Some(body) = marker.body else { continue };
            let [pin] = self.of_body[body.index()][..] else {
                continue;
            };
            let (at, _) = self.place(MarkerId(index));
            let of = self.pins.pins[pin].at;
            let is_apart = (at[0] - of[0]).hypot(at[1] - of[1]) > self.near;
            if self.pins.pins[pin].way.is_none() && is_apart {
                self.pin(MarkerId(index), &marker.name);
            }
        }
        for (body, pins) in self.of_body.iter().enumerate() {
            let is_block = |pin: &usize| self.pins.pins[*pin].way.is_some();
            if pins.len() < 2 && !pins.iter().any(is_block) {
                self.pins.notes.push(Note::LeftOut {
                    kind: "body",
                    name: self.mechanism.bodies[body].name.clone(),
                    reason: "it has no two points, as a link has",
                });
            }
        }
    }

    /// Adds points of interest.
    fn points(&mut self) {
        for &marker in &self.mechanism.outputs.markers {
            if self.body(marker).is_some() {
                let name = self.mechanism.markers[marker.index()].name.clone();
                let pin = self.pin(marker, &name);
                self.pins.pins[pin].is_shown = true;
            }
        }
    }

    /// Adds bodies with two pins or more, and blocks of sliders.
    fn links(&mut self) {
        let bodies = self.mechanism.bodies.iter().zip(&self.of_body);
        let links = bodies.map(|(body, pins)| Link {
            name: body.name.clone(),
            pins: pins.clone(),
        });
        let rods = std::mem::take(&mut self.pins.links);
        self.pins.links = links.chain(rods).collect();
    }

    /// Takes over drivers that turn links about pins on ground, one for each pin; others are told.
    fn inputs(&mut self) {
        let start = self.solver.pose().time;
        for (index, driver) in self.mechanism.drivers.iter().enumerate() {
            if driver.is_free() {
                self.pins.notes.push(Note::LeftOut {
                    kind: "freedom",
                    name: driver.name.clone(),
                    reason: "forces move it",
                });
                continue;
            }
            let coordinate = driver.coordinate;
            let turned = match coordinate.kind {
                CoordinateKind::Angle if self.body(coordinate.from).is_none() => {
                    self.body(coordinate.to)
                }
                _ => None,
            };
            let turned = turned.and_then(|body| {
                let mut pins = self.of_body[body.index()].iter();
                let pin = pins.find(|pin| self.pins.pins[**pin].is_ground)?;
                Some((*pin, body.index()))
            });
            match turned {
                Some((pin, link)) if self.pins.inputs.iter().all(|input| input.pin != pin) => {
                    let id = biela::mechanism::DriverId(index);
                    let rate = |time: f64| self.solver.motion(id, time).first();
                    let speed = driver.motion().map(|_| rounded(rate(start), 9));
                    self.pins.inputs.push(Input { pin, link, speed });
                    let duration = self.mechanism.simulation.stop - start;
                    let others = (1..=SPEEDS).map(|k| f64::from(k) / f64::from(SPEEDS));
                    let mut others = others.map(|part| rounded(rate(start + part * duration), 9));
                    if speed
                        .is_some_and(|speed| others.any(|other| (other - speed).abs() > UNIFORM))
                    {
                        self.pins.notes.push(Note::LeftOut {
                            kind: "the course of driver",
                            name: driver.name.clone(),
                            reason: "inputs turn at one speed there: it has that of the start",
                        });
                    }
                }
                _ => self.pins.notes.push(Note::LeftOut {
                    kind: "driver",
                    name: driver.name.clone(),
                    reason: "only links about pins on ground are driven there, one for each pin",
                }),
            }
        }
        if self.mechanism.has_dynamics() {
            self.pins.notes.push(Note::Masses {
                reason: "the other program has units of its own",
            });
        }
    }
}
