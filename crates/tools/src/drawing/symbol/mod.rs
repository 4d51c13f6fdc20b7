//! Symbols of kinematic diagrams, one file each.
//!
//! The file of a symbol says everything about it: the joint or driver that it stands for
//! (`compose`), its shape at a pose and the frames that its parts move with (`draw`), its extent,
//! and the part of a body that it shows. The table below lists the symbols. A new symbol is a
//! file and a line there; a joint without a symbol does not compile.

mod composer;
mod cylinder;
mod guide;
mod pen;

// Every symbol's file starts with these names.
use super::anchor::{Anchor, Disc};
use super::attachment::{Attachment, End, Line, Measure};
use super::label::{Candidate, ON_WHEEL};
use super::outline::{
    Outline, Point, across, angle, contains, convex_hull, direction, extremes, unit,
};
use super::palette::Colour;
use super::sheet::{Bounds, Layer};
use biela::mechanism::{
    BodyId, CamFollower, Expression, Joint, JointKind, Profile, ProfileInForce, RackSide,
    WheelSizes,
};
use composer::Composer;
use pen::{
    BAR, BLOCK, DASH_DOTS, DASHES, HATCH, IN_ARROW, LINE, NAME, Named, PIN, THIN, colour_of,
    on_sheet_direction,
};

pub(super) use composer::{compose, compose_dimensions};
pub use force_arrow::ForceKind;
pub(super) use pen::{OtherPoses, Pen};
pub use slide_way::{GuideContact, WaySide};

/// A symbol as the scene and the sheet see it.
pub(super) trait Shape {
    /// Draws the symbol at the pen's pose.
    fn draw(&self, pen: &mut Pen);

    /// Returns the discs between which everything drawn to scale extends.
    fn extent(&self) -> Vec<Disc>;

    /// Returns the body that the symbol shows, if it stands for a body.
    fn shows(&self) -> Option<BodyId> {
        None
    }

    /// Returns whether a point of the body that the symbol shows lies in the symbol.
    fn covers(&self, point: Point) -> bool {
        self.extent().iter().any(|disc| disc.covers(point))
    }

    /// Returns the body that is [fitted](Self::fit) to the symbol.
    fn fitted(&self) -> Option<BodyId> {
        None
    }

    /// Fits the corners of a body to the symbol, and returns half the width of the body's bar where
    /// the symbol needs another one.
    fn fit(&self, _pen: &Pen, _corners: &mut Vec<Point>) -> Option<f64> {
        None
    }

    /// Returns the point whose velocity and acceleration a moving picture shows.
    fn tracked(&self) -> Option<Anchor> {
        None
    }
}

/// Returns the rectangle around everything that some symbols draw to scale at a pose \[m\].
pub(super) fn bounds<'a>(symbols: impl IntoIterator<Item = &'a Symbol>, q: &[f64]) -> Bounds {
    let mut bounds = Bounds::NONE;
    for symbol in symbols {
        for Disc { center, radius } in symbol.shape().extent() {
            let size = Point::repeat(2.0 * radius);
            bounds.join(&Bounds::about(center.placed(q).point, size));
        }
    }
    bounds
}

macro_rules! symbols {
    ($composer:ident, $ends:ident:
     $($module:ident: $name:ident $(, $joint:pat => $compose:expr)*;)+) => {
        $(pub(super) mod $module; pub use $module::$name;)+

        /// A symbol with its size and its place on bodies or on ground.
        ///
        /// Lengths are in metres, angles in radians. Symbols whose size has no meaning, such as
        /// the circle of a revolute joint, have none.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Symbol {
            $(#[doc = concat!("A [`", stringify!($name), "`].")] $name($name),)+
        }

        impl Symbol {
            pub(super) fn shape(&self) -> &dyn Shape {
                match self {
                    $(Self::$name(shape) => shape,)+
                }
            }
        }

        $(impl From<$name> for Symbol {
            fn from(shape: $name) -> Self {
                Self::$name(shape)
            }
        })+

        /// Composes the symbols of a joint between two markers.
        fn compose_joint($composer: &mut Composer, joint: &Joint, $ends: [Anchor; 2]) {
            match &joint.kind {
                $($($joint => $compose,)*)+
            }
        }
    };
}

// File and symbol, and the joint that the file composes.
symbols! { composer, ends:
    silhouette: Silhouette;
    link: Link;
    block: Block, JointKind::Translational => block::compose(composer, ends);
    slide_way: SlideWay;
    slot: Slot, JointKind::Slot => slot::compose(composer, ends, None),
        JointKind::RevoluteTranslational { offset } =>
            slot::compose(composer, ends, Some(offset));
    pin: Pin, JointKind::Revolute => pin::compose(composer, ends);
    weld: Weld, JointKind::Weld => weld::compose(composer, ends);
    rod: Rod, JointKind::Link { .. } => rod::compose(composer, ends);
    fixture: Fixture;
    wheel: Wheel, JointKind::Gear { sizes, internal, .. } =>
        wheel::compose(composer, ends, sizes, *internal);
    belt: Belt, JointKind::Belt { sizes, crossed, .. } =>
        belt::compose(composer, ends, sizes, *crossed);
    rack: Rack, JointKind::RackAndPinion { radius, side, .. } =>
        rack::compose(composer, ends, radius, *side);
    track: Track, JointKind::Rolling { radius, .. } => track::compose(composer, ends, radius);
    cam: Cam, JointKind::Cam { follower, profile, .. } =>
        cam::compose(composer, ends, follower, profile);
    tie: Tie, JointKind::Coupling(equation) => tie::compose(composer, equation);
    curve: CurveLine, JointKind::Curve(curve) => curve::compose(composer, ends, curve);
    rope: Rope, JointKind::Rope(rope) => rope::compose(composer, rope);
    knife: Knife;
    roller: Roller;
    face: Face;
    angle_driver: AngleDriver;
    length_driver: LengthDriver;
    end_stop: EndStop;
    spring: Spring;
    torsion: Torsion;
    load: LoadArrow;
    point: InterestPoint;
    force_arrow: ForceArrow;
    torque_arrow: TorqueArrow;
    joint_letter: JointLetter;
    dimension: Dimension;
    instant_centre: InstantCentreMark;
    contact_mark: ContactMark;
    trace: Trace;
}
