//! Shapes of bodies and of ground: outlines that are drawn, weighed and kept apart.
//!
//! | file | subject |
//! |---|---|
//! | `chain` | corners and edges of a shape, and what a fillet or a rim makes of them |
//! | `core` | [`Core`]: the places and edges round which a shape has its radius |
//! | `element` | [`FeatureRun`]: the parts of two shapes that touch at one place |
//! | `fault` | [`ShapeFault`]: outlines that do not close round an area |
//! | `weight` | area, centre and second moment; mass, centre and inertia of a body |
//!
//! A shape is a core, grown by a radius. A disc is a place, a bar a polyline. An outline is a polygon of
//! lines and arcs; with a fillet f its core is the polygon moved in by f, and f belongs to the radius, so
//! that its flats stay where they are. A wall is likewise its surface moved in by its depth.

mod chain;
mod core;
mod element;
mod fault;
mod weight;

#[cfg(test)]
mod tests;

pub use self::core::{Core, Feature, FeatureKind};
pub use chain::Piece;
pub use element::FeatureRun;
pub(super) use element::{Elements, elements};
pub use fault::{ShapeFault, ShapeFaultKind};
pub use weight::{Section, Weight};

use super::{BodyId, Expression, MarkerId};

/// Most markers of a shape.
pub(crate) const MOST_CORNERS: usize = 256;

/// A shape of a body or of ground.
#[derive(Clone, Debug)]
pub struct Shape {
    /// Name, unique among the shapes and markers of its body.
    pub name: String,
    /// Description in one line, empty if the file gives none.
    pub description: String,
    /// Body that has it, `None` on ground.
    pub body: Option<BodyId>,
    /// The area.
    pub form: ShapeForm,
    /// Thickness \[m\] and density \[kg/m³\], `None` for a shape without mass. Holes have none.
    pub weight: Option<[Expression; 2]>,
}

/// Area of a shape, on markers of its body.
#[derive(Clone, Debug)]
pub enum ShapeForm {
    /// All points at most a radius from a marker.
    Disc {
        /// The centre.
        marker: MarkerId,
        /// The radius \[m\], positive.
        radius: Expression,
    },
    /// All points at most a radius from the polyline through markers.
    Bar {
        /// Two or more markers, in order.
        markers: Vec<MarkerId>,
        /// The radius \[m\], positive.
        radius: Expression,
    },
    /// A polygon of lines and arcs.
    Outline {
        /// Three or more corners in either order, or two with an arc.
        corners: Vec<OutlineCorner>,
        /// Width of a round rim by which it grows \[m\], not negative; `None` for zero.
        radius: Option<Expression>,
        /// Radius that rounds its convex corners from inside \[m\], not negative; `None` for zero.
        fillet: Option<Expression>,
    },
    /// A round hole in the shapes of the body in which its centre lies.
    Hole {
        /// The centre.
        marker: MarkerId,
        /// The radius \[m\], positive.
        radius: Expression,
    },
    /// An open surface.
    Wall {
        /// Two or more markers; free space is on the right of the way through them.
        markers: Vec<MarkerId>,
        /// Depth of the solid on the left, and fillet of convex corners and ends \[m\], positive.
        depth: Expression,
    },
}

/// Corner of an outline.
#[derive(Clone, Debug)]
pub struct OutlineCorner {
    /// The marker.
    pub marker: MarkerId,
    /// Tangent of a quarter of the angle of an arc to the next corner, positive counter-clockwise, as in
    /// DXF; `None` for a straight edge.
    pub bulge: Option<Expression>,
}

impl Shape {
    /// Returns its markers in order.
    pub fn markers(&self) -> impl Iterator<Item = MarkerId> {
        let (one, many, corners) = match &self.form {
            ShapeForm::Disc { marker, .. } | ShapeForm::Hole { marker, .. } => {
                (Some(*marker), &[][..], &[][..])
            }
            ShapeForm::Bar { markers, .. } | ShapeForm::Wall { markers, .. } => {
                (None, &markers[..], &[][..])
            }
            ShapeForm::Outline { corners, .. } => (None, &[][..], &corners[..]),
        };
        let corners = corners.iter().map(|corner| corner.marker);
        one.into_iter().chain(many.iter().copied()).chain(corners)
    }

    /// Returns its own numbers: its radius, fillet or depth, then bulges.
    pub fn numbers(&self) -> impl Iterator<Item = &Expression> {
        let (sizes, corners) = match &self.form {
            ShapeForm::Disc { radius, .. }
            | ShapeForm::Bar { radius, .. }
            | ShapeForm::Hole { radius, .. } => ([Some(radius), None], &[][..]),
            ShapeForm::Wall { depth, .. } => ([Some(depth), None], &[][..]),
            ShapeForm::Outline {
                corners,
                radius,
                fillet,
            } => ([radius.as_ref(), fillet.as_ref()], &corners[..]),
        };
        let bulges = corners.iter().filter_map(|corner| corner.bulge.as_ref());
        sizes.into_iter().flatten().chain(bulges)
    }

    /// Returns whether it has an area that a thickness gives a mass: it is a disc, a bar or an outline.
    #[must_use]
    pub fn is_plate(&self) -> bool {
        !matches!(self.form, ShapeForm::Hole { .. } | ShapeForm::Wall { .. })
    }

    /// Returns whether it is a hole.
    #[must_use]
    pub fn is_hole(&self) -> bool {
        matches!(self.form, ShapeForm::Hole { .. })
    }

    /// Returns whether it is round everywhere: it has a radius, a fillet or a depth.
    #[must_use]
    pub fn is_round(&self) -> bool {
        match &self.form {
            ShapeForm::Outline { radius, fillet, .. } => {
                let is_given = |e: &&Expression| e.literal() != Some(0.0);
                radius.iter().chain(fillet).any(|e| is_given(&e))
            }
            ShapeForm::Hole { .. } => false,
            _ => true,
        }
    }

    /// Returns its word in the file.
    #[must_use]
    pub fn word(&self) -> &'static str {
        match &self.form {
            ShapeForm::Disc { .. } => "disc",
            ShapeForm::Bar { .. } => "bar",
            ShapeForm::Outline { .. } => "outline",
            ShapeForm::Hole { .. } => "hole",
            ShapeForm::Wall { .. } => "wall",
        }
    }
}

/// Places of the markers in the frame of their body, and values of numbers, from which a shape has its
/// outline.
pub(crate) struct Given<'a, N> {
    /// Returns the point of a marker \[m\].
    pub(crate) point: &'a dyn Fn(MarkerId) -> [N; 2],
    /// Returns the value of a number.
    pub(crate) number: &'a dyn Fn(&Expression) -> N,
}
