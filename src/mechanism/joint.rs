//! Joints: their kinds, and what they are asked whatever their kind.
//!
//! Code that does not write down the equations or the symbol of each kind asks a joint by its role.
//! A new kind has one of the roles, or a new one, here alone.

use super::{
    BodyId, Coordinate, CoordinateEquation, CoordinateKind, Curve, Expression, Force, Load,
    MarkerId, Mechanism, PassiveCause, Phase, Play, Profile, Rope,
};

/// Named set of constraints between two markers.
#[derive(Clone, Debug)]
pub struct Joint {
    /// Name, unique among all named things of the mechanism.
    pub name: String,
    /// Description in one line, empty if the file gives none.
    pub description: String,
    /// Type of the joint.
    pub kind: JointKind,
    /// Marker i.
    pub from: MarkerId,
    /// Marker j.
    pub to: MarkerId,
}

/// Types of joints.
#[derive(Clone, Debug)]
pub enum JointKind {
    /// Pin: the points coincide, x = y = 0.
    Revolute,
    /// Marker j slides along the x-axis of marker i without turning: y = angle = 0.
    Translational,
    /// The point of marker j stays on the x-axis of marker i: y = 0.
    Slot,
    /// A massless rod between two revolutes (composite revolute–revolute): distance = length.
    Link {
        /// Distance between the points \[m\], positive.
        length: Expression,
    },
    /// The point of marker j stays at a distance from the x-axis of marker i (composite
    /// revolute–translational): y = offset.
    RevoluteTranslational {
        /// Signed distance \[m\].
        offset: Expression,
    },
    /// The markers coincide: x = y = angle = 0.
    Weld,
    /// Two toothed wheels in mesh. Marker angles set the phase.
    Gear {
        /// Sizes of the wheels of markers i and j.
        sizes: WheelSizes,
        /// Whether the smaller wheel runs inside the larger one, so that both turn the same way.
        internal: bool,
        /// Body that carries both centres, `None` for ground.
        carrier: Option<BodyId>,
        /// Value at which the relation of their angles is held.
        phase: Phase,
        /// The gap between the flanks, in free motion.
        play: Option<Box<Play>>,
    },
    /// Two wheels joined by a belt or chain. Marker angles set the phase.
    Belt {
        /// Sizes of the wheels of markers i and j.
        sizes: WheelSizes,
        /// Whether the belt crosses between the wheels, so that they turn opposite ways.
        crossed: bool,
        /// Body that carries both centres, `None` for ground.
        carrier: Option<BodyId>,
        /// Value at which the relation of their angles is held.
        phase: Phase,
    },
    /// A pinion, which has marker i, that rolls along the x-axis of marker j, the rack.
    RackAndPinion {
        /// Radius of the pinion \[m\].
        radius: Expression,
        /// Side of the rack on which the pinion is.
        side: RackSide,
        /// Value at which the relation of way and angle is held.
        phase: Phase,
        /// The gap between the flanks, in free motion.
        play: Option<Box<Play>>,
    },
    /// A wheel, which has marker i, that rolls on the x-axis of marker j, the track, and stays on it.
    Rolling {
        /// Radius of the wheel \[m\].
        radius: Expression,
        /// Side of the track on which the wheel is.
        side: RackSide,
        /// Value at which the relation of way and angle is held.
        phase: Phase,
    },
    /// An equation between coordinates. Marker i is the first one of its first coordinate, marker j
    /// the second one of its last.
    Coupling(Box<CoordinateEquation>),
    /// A follower, which has marker j, on the contour of a cam, which has marker i.
    Cam {
        /// Part of the follower that touches the cam.
        follower: CamFollower,
        /// Contour of the cam.
        profile: Profile,
        /// Whether, and how, the follower lifts off in free motion.
        play: Option<Box<Play>>,
    },
    /// A rope from marker i to marker j over the points between them.
    Rope(Rope),
    /// The point of marker j stays on a curve in the frame of marker i.
    Curve(Curve),
}

/// Part of a follower that touches the cam, on the outer side of its contour.
#[derive(Clone, Debug)]
pub enum CamFollower {
    /// The marker's point.
    Knife,
    /// A roller round the marker's point.
    Roller {
        /// Its radius \[m\], positive.
        radius: Expression,
    },
    /// The marker's x-axis.
    Flat,
}

/// Sizes of two wheels, whose ratio is the ratio of transmission.
#[derive(Clone, Debug)]
pub enum WheelSizes {
    /// Radii of the pitch circles \[m\].
    Radii([Expression; 2]),
    /// Numbers of teeth.
    Teeth([Expression; 2]),
}

impl WheelSizes {
    /// Returns both sizes, in metres or in teeth.
    #[must_use]
    pub fn expressions(&self) -> &[Expression; 2] {
        match self {
            Self::Radii(sizes) | Self::Teeth(sizes) => sizes,
        }
    }
}

/// Side of a rack, or of a track, on which a wheel rolls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RackSide {
    /// The side of the y-axis of the rack's marker.
    Above,
    /// The other side.
    Below,
}

/// Part that a joint plays between its bodies.
enum Role<'a> {
    /// The points coincide; the bodies turn about them unless they are welded.
    Point { turns: bool },
    /// A point slides along a straight line.
    Guide(Guide<'a>),
    /// A rod of this length.
    Rod(&'a Expression),
    /// A rope.
    Rope(&'a Rope),
    /// Wheels turn together.
    Wheels(Wheels<'a>),
    /// A follower touches a cam.
    Cam(&'a CamFollower, &'a Profile),
    /// A point moves on a curve.
    Curve(&'a Curve),
    /// Coordinates follow each other.
    Equation(&'a CoordinateEquation),
}

/// Straight line along the x-axis of marker i on which the point of marker j slides.
#[derive(Clone, Copy, Debug)]
pub struct Guide<'a> {
    /// Signed distance of the line from the axis \[m\], `None` for the axis itself.
    pub aside: Option<&'a Expression>,
    /// Whether marker j turns against marker i.
    pub turns: bool,
}

/// Wheels that turn together, or a wheel on a straight line.
#[derive(Clone, Copy, Debug)]
pub enum Wheels<'a> {
    /// Two toothed wheels in mesh.
    Mesh {
        /// Their sizes.
        sizes: &'a WheelSizes,
        /// Whether the smaller wheel runs inside the larger one.
        internal: bool,
        /// Body that carries both centres, `None` for ground.
        carrier: Option<BodyId>,
    },
    /// Two wheels in a belt.
    Belt {
        /// Their sizes.
        sizes: &'a WheelSizes,
        /// Whether the belt crosses between them.
        crossed: bool,
        /// Body that carries both centres, `None` for ground.
        carrier: Option<BodyId>,
    },
    /// A pinion on a rack, whose distance other joints hold.
    Rack {
        /// Radius of the pinion \[m\].
        radius: &'a Expression,
        /// Side of the rack on which the pinion is.
        side: RackSide,
    },
    /// A wheel that the joint holds on a track.
    Track,
}

impl Wheels<'_> {
    /// Returns the body that carries the centres of two wheels, `None` for ground.
    #[must_use]
    pub fn carrier(&self) -> Option<BodyId> {
        match *self {
            Self::Mesh { carrier, .. } | Self::Belt { carrier, .. } => carrier,
            Self::Rack { .. } | Self::Track => None,
        }
    }

    /// Returns whether one wheel rolls on a straight line, the x-axis of marker j.
    #[must_use]
    pub fn is_on_line(&self) -> bool {
        match self {
            Self::Rack { .. } | Self::Track => true,
            Self::Mesh { .. } | Self::Belt { .. } => false,
        }
    }
}

impl Joint {
    fn role(&self) -> Role<'_> {
        match &self.kind {
            JointKind::Revolute => Role::Point { turns: true },
            JointKind::Weld => Role::Point { turns: false },
            JointKind::Translational => Role::Guide(Guide {
                aside: None,
                turns: false,
            }),
            JointKind::Slot => Role::Guide(Guide {
                aside: None,
                turns: true,
            }),
            JointKind::RevoluteTranslational { offset } => Role::Guide(Guide {
                aside: Some(offset),
                turns: true,
            }),
            JointKind::Link { length } => Role::Rod(length),
            JointKind::Rope(rope) => Role::Rope(rope),
            &JointKind::Gear {
                ref sizes,
                internal,
                carrier,
                ..
            } => Role::Wheels(Wheels::Mesh {
                sizes,
                internal,
                carrier,
            }),
            &JointKind::Belt {
                ref sizes,
                crossed,
                carrier,
                ..
            } => Role::Wheels(Wheels::Belt {
                sizes,
                crossed,
                carrier,
            }),
            &JointKind::RackAndPinion {
                ref radius, side, ..
            } => Role::Wheels(Wheels::Rack { radius, side }),
            JointKind::Rolling { .. } => Role::Wheels(Wheels::Track),
            JointKind::Cam {
                follower, profile, ..
            } => Role::Cam(follower, profile),
            JointKind::Curve(curve) => Role::Curve(curve),
            JointKind::Coupling(equation) => Role::Equation(equation),
        }
    }

    /// Returns whether it is a pin: the points coincide, and the bodies turn about them.
    #[must_use]
    pub fn is_pin(&self) -> bool {
        matches!(self.role(), Role::Point { turns: true })
    }

    /// Returns whether the points coincide: it is a pin or a weld.
    #[must_use]
    pub fn is_point(&self) -> bool {
        matches!(self.role(), Role::Point { .. })
    }

    /// Returns the line on which its second point slides.
    #[must_use]
    pub fn guide(&self) -> Option<Guide<'_>> {
        match self.role() {
            Role::Guide(guide) => Some(guide),
            _ => None,
        }
    }

    /// Returns the length of a rod between its points \[m\].
    #[must_use]
    pub fn rod(&self) -> Option<&Expression> {
        match self.role() {
            Role::Rod(length) => Some(length),
            _ => None,
        }
    }

    /// Returns the rope.
    #[must_use]
    pub fn rope(&self) -> Option<&Rope> {
        match self.role() {
            Role::Rope(rope) => Some(rope),
            _ => None,
        }
    }

    /// Returns the wheels that it couples.
    #[must_use]
    pub fn wheels(&self) -> Option<Wheels<'_>> {
        match self.role() {
            Role::Wheels(wheels) => Some(wheels),
            _ => None,
        }
    }

    /// Returns the follower on a cam, and the contour of the cam.
    #[must_use]
    pub fn cam(&self) -> Option<(&CamFollower, &Profile)> {
        match self.role() {
            Role::Cam(follower, profile) => Some((follower, profile)),
            _ => None,
        }
    }

    /// Returns the curve on which its second point moves.
    #[must_use]
    pub fn curve(&self) -> Option<&Curve> {
        match self.role() {
            Role::Curve(curve) => Some(curve),
            _ => None,
        }
    }

    /// Returns the equation between coordinates.
    #[must_use]
    pub fn equation(&self) -> Option<&CoordinateEquation> {
        match self.role() {
            Role::Equation(equation) => Some(equation),
            _ => None,
        }
    }

    /// Returns whether its two parts can only push each other; those of a rope can only pull, and one side
    /// of an equation is the larger one.
    #[must_use]
    pub fn is_one_sided(&self) -> bool {
        match self.role() {
            Role::Cam(..) | Role::Rope(_) | Role::Wheels(Wheels::Track) => true,
            Role::Equation(equation) => {
                let play = equation.play.as_deref();
                play.is_some_and(|play| play.backlash.is_none())
            }
            Role::Point { .. }
            | Role::Guide(_)
            | Role::Rod(_)
            | Role::Wheels(Wheels::Mesh { .. } | Wheels::Belt { .. } | Wheels::Rack { .. })
            | Role::Curve(_) => false,
        }
    }

    /// Returns the coordinate that tells where the joint is on its way, if there is one.
    #[must_use]
    pub fn free_coordinate(&self) -> Option<Coordinate> {
        let kind = match self.role() {
            Role::Point { turns: true } => CoordinateKind::Angle,
            Role::Guide(Guide { aside: None, .. }) => CoordinateKind::X,
            Role::Point { turns: false }
            | Role::Guide(Guide { aside: Some(_), .. })
            | Role::Rod(_)
            | Role::Rope(_)
            | Role::Wheels(_)
            | Role::Cam(..)
            | Role::Curve(_)
            | Role::Equation(_) => return None,
        };
        Some(self.coordinate(kind))
    }

    /// Returns a coordinate of marker j, measured from marker i and on its axes.
    #[must_use]
    pub fn coordinate(&self, kind: CoordinateKind) -> Coordinate {
        let (from, to) = (self.from, self.to);
        Coordinate {
            kind,
            from,
            to,
            axes: from,
        }
    }

    /// Returns its markers, each as often as it occurs.
    pub fn markers(&self) -> impl Iterator<Item = MarkerId> {
        let coupled = self.equation().map_or(&[][..], |own| &own.coordinates);
        let over = self.rope().map_or(&[][..], |rope| &rope.points);
        let coupled = coupled
            .iter()
            .flat_map(|(_, coordinate)| coordinate.markers());
        let over = over.iter().map(|point| point.marker);
        [self.from, self.to].into_iter().chain(coupled).chain(over)
    }

    /// Returns the force along the relation of the joint, which has this index, if it has play.
    pub(super) fn force_of_play(&self, index: usize) -> Option<Force> {
        self.kind.play()?;
        let is_of_wheels = self.wheels().is_some_and(|wheels| !wheels.is_on_line());
        let is_of_angles = self.equation().is_some_and(|equation| equation.is_angle);
        let kind = if is_of_wheels || is_of_angles {
            CoordinateKind::Angle
        } else {
            CoordinateKind::Distance
        };
        Some(Force {
            name: self.name.clone(),
            description: String::new(),
            load: Load::Passive {
                coordinate: self.coordinate(kind),
                cause: PassiveCause::Play(index),
            },
        })
    }
}

impl JointKind {
    /// Returns the constant of its first relation, if the file may set it.
    #[must_use]
    pub fn phase(&self) -> Option<&Phase> {
        match self {
            Self::Gear { phase, .. }
            | Self::Belt { phase, .. }
            | Self::RackAndPinion { phase, .. }
            | Self::Rolling { phase, .. } => Some(phase),
            Self::Coupling(equation) => Some(&equation.phase),
            Self::Revolute
            | Self::Translational
            | Self::Slot
            | Self::Link { .. }
            | Self::RevoluteTranslational { .. }
            | Self::Weld
            | Self::Cam { .. }
            | Self::Rope(_)
            | Self::Curve(_) => None,
        }
    }

    /// Returns the play that the file gives.
    #[must_use]
    pub fn play(&self) -> Option<&Play> {
        match self {
            Self::Gear { play, .. } | Self::RackAndPinion { play, .. } | Self::Cam { play, .. } => {
                play.as_deref()
            }
            Self::Coupling(equation) => equation.play.as_deref(),
            Self::Rope(rope) => rope.play.as_deref(),
            Self::Revolute
            | Self::Translational
            | Self::Slot
            | Self::Link { .. }
            | Self::RevoluteTranslational { .. }
            | Self::Weld
            | Self::Belt { .. }
            | Self::Rolling { .. }
            | Self::Curve(_) => None,
        }
    }
}

impl Mechanism {
    /// Returns the number of pulleys of all ropes.
    #[must_use]
    pub fn pulleys(&self) -> usize {
        let ropes = self.joints.iter().filter_map(Joint::rope);
        let points = ropes.flat_map(|rope| &rope.points);
        points.filter(|point| point.pulley.is_some()).count()
    }
}
