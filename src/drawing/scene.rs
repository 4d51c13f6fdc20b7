//! What there is to draw of a mechanism, in the frames of its bodies.

use nalgebra::{Rotation2, Vector2};

use super::compose;
use super::motion;
use crate::kinematics::{Pose, Solver};
use crate::mechanism::{BodyId, Mechanism};

/// A mechanism as symbols that are fixed on its bodies or on ground, or that reach from one to
/// another. Where the bodies are is for the q it is drawn at to say.
///
/// Lengths are in metres, angles in radians. Symbols whose size has no meaning, such as a joint's
/// circle, have none here.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The mechanism's name.
    pub name: String,
    /// What the mechanism is, in one line; may be empty.
    pub description: String,
    /// The names of the bodies.
    pub bodies: Vec<String>,
    /// What there is to draw, in no particular order.
    pub symbols: Vec<Symbol>,
}

/// A frame on a body or on ground: a point and a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anchor {
    /// The body, `None` for ground.
    pub body: Option<BodyId>,
    /// The point in the body's frame \[m\].
    pub position: [f64; 2],
    /// Direction of the x-axis in the body's frame \[rad\].
    pub angle: f64,
}

/// An [`Anchor`] in global coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// The point \[m\].
    pub point: Vector2<f64>,
    /// Direction of the x-axis \[rad\].
    pub angle: f64,
}

/// Something to draw.
#[derive(Clone, Debug, PartialEq)]
pub enum Symbol {
    /// A body: what spans these points of its frame. One point is a small disc, two are a bar,
    /// more a plate.
    Link {
        /// The body.
        body: BodyId,
        /// The points \[m\].
        points: Vec<[f64; 2]>,
    },
    /// A block that slides along its anchor's x-axis.
    Block {
        /// Its middle and direction.
        at: Anchor,
        /// The body that it slides on, `None` for ground.
        on: Option<BodyId>,
    },
    /// A block in a slot; it turns with the slot.
    SlotBlock {
        /// Its middle.
        at: Anchor,
        /// The slot, which gives the direction.
        along: Anchor,
    },
    /// A way on ground along the x-axis of an anchor.
    SlideWay {
        /// Origin and axis.
        along: Anchor,
        /// What is used of the axis \[m\].
        range: [f64; 2],
        /// Where the way is.
        side: WaySide,
        /// What slides along it.
        holds: Held,
    },
    /// A slot in a body along the x-axis of an anchor.
    Slot {
        /// Origin and axis.
        along: Anchor,
        /// What is used of the axis \[m\].
        range: [f64; 2],
    },
    /// What holds a pivot on ground; it lies in the direction of the anchor's x-axis.
    Fixture {
        /// The pivot, on ground.
        at: Anchor,
    },
    /// A revolute joint.
    Pin {
        /// Where.
        at: Anchor,
    },
    /// A weld.
    Weld {
        /// Where.
        at: Anchor,
    },
    /// A massless rod between two revolute joints.
    Rod {
        /// Its ends.
        ends: [Anchor; 2],
    },
    /// A wheel, by its pitch circle.
    Wheel {
        /// Its centre; the x-axis is the mark that shows its rotation.
        at: Anchor,
        /// Radius of the pitch circle \[m\].
        radius: f64,
        /// Whether its teeth are inside.
        ring: bool,
    },
    /// A belt around two wheels.
    Belt {
        /// Their centres.
        centers: [Anchor; 2],
        /// Their radii \[m\].
        radii: [f64; 2],
        /// Whether the belt crosses between them.
        crossed: bool,
    },
    /// A rack, its pitch line along the x-axis of an anchor.
    Rack {
        /// Origin and axis.
        along: Anchor,
        /// What is used of the axis \[m\].
        range: [f64; 2],
        /// Whether the teeth are on the side of the anchor's y-axis.
        above: bool,
    },
    /// A cam, by its contour.
    Cam {
        /// Its axle.
        at: Anchor,
        /// The contour, closed, in the frame of the anchor's body \[m\].
        contour: Vec<[f64; 2]>,
    },
    /// The edge of a knife-edge follower; the x-axis points into the follower.
    Knife {
        /// The edge.
        at: Anchor,
    },
    /// The roller of a follower.
    Roller {
        /// Its centre.
        at: Anchor,
        /// Its radius \[m\].
        radius: f64,
    },
    /// The face of a flat-faced follower along the x-axis of an anchor.
    Face {
        /// Origin and axis.
        along: Anchor,
        /// What is used of the axis \[m\].
        range: [f64; 2],
        /// Whether the cam is on the side of the anchor's y-axis.
        above: bool,
    },
    /// A driver of an angle.
    AngleDriver {
        /// The driver's name.
        name: String,
        /// Marker i.
        from: Anchor,
        /// Marker j, at which it is drawn.
        to: Anchor,
    },
    /// A driver of a length.
    LengthDriver {
        /// The driver's name.
        name: String,
        /// Marker i.
        from: Anchor,
        /// Marker j.
        to: Anchor,
        /// The axis along which the length is measured, `None` for the distance.
        axis: Option<Anchor>,
        /// Whether something else lies between the two points, so that it is drawn beside them.
        beside: bool,
    },
    /// A point of interest.
    Point {
        /// Its name.
        name: String,
        /// Where.
        at: Anchor,
    },
    /// The path of a point of interest over ground, or a piece of it.
    Trace {
        /// The body that the point is on, `None` for ground.
        body: Option<BodyId>,
        /// The path \[m\].
        points: Vec<[f64; 2]>,
    },
}

/// On which sides of its axis a way on ground lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WaySide {
    /// On the side of the y-axis.
    Above,
    /// On the other side.
    Below,
    /// On both: what slides does so between them.
    Both,
}

/// What slides along a way on ground: how far from its axis the way lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Held {
    /// A block.
    Block,
    /// A point.
    Point,
    /// A bar along the axis.
    Bar,
    /// The back of a rack whose pitch line is the axis.
    Rack,
}

impl Scene {
    /// The scene of a mechanism that stands at a pose, to which the solver returns.
    ///
    /// Ways and slots are as long as the motion needs, along which points of interest leave
    /// their traces: that of the prescribed motions until the file's stop time or, if none moves,
    /// turns of the first driver that is an angle: as many, up to eight, as bring the mechanism
    /// back, or one, as far as it gets both ways. Other drivers keep their values. With `traces` false the traces are left out.
    #[must_use]
    pub fn new(solver: &mut Solver, traces: bool) -> Self {
        let motion = motion::sweep(solver);
        let Pose { q, parameters, .. } = solver.pose();
        Self::along(solver.mechanism(), parameters, q, &motion, traces)
    }

    /// The scene of a mechanism at the pose q, \[m, m, rad\] for each body, for a motion along
    /// poses: ways and slots are as long as it needs, points of interest leave their traces.
    #[must_use]
    pub fn along(
        mechanism: &Mechanism,
        parameters: &[f64],
        q: &[f64],
        motion: &[Vec<f64>],
        traces: bool,
    ) -> Self {
        Self {
            name: mechanism.name.clone(),
            description: mechanism.description.clone(),
            bodies: mechanism.bodies.iter().map(|b| b.name.clone()).collect(),
            symbols: compose::symbols(mechanism, parameters, q, motion, traces),
        }
    }
}

impl Anchor {
    /// A point of the body's frame along the anchor's axes \[m\].
    pub(super) fn coordinates(&self, point: Vector2<f64>) -> [f64; 2] {
        (Rotation2::new(-self.angle) * (point - Vector2::from(self.position))).into()
    }

    /// Where it is for the generalized coordinates q, \[m, m, rad\] for each body.
    #[must_use]
    pub fn placed(&self, q: &[f64]) -> Frame {
        let position = Vector2::from(self.position);
        match self.body {
            None => Frame {
                point: position,
                angle: self.angle,
            },
            Some(body) => {
                let [x, y, phi] = [0, 1, 2].map(|k| q[3 * body.index() + k]);
                Frame {
                    point: Vector2::new(x, y) + Rotation2::new(phi) * position,
                    angle: phi + self.angle,
                }
            }
        }
    }
}
