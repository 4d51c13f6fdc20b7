//! What a symbol moves with.

use super::outline::{Point, angle, direction, unit};
use super::scene::{Anchor, Frame, Symbol};
use crate::mechanism::BodyId;

/// A frame that moves; what rides on it keeps its place in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Rider {
    /// Does not move.
    Ground,
    /// The frame of a body.
    Body(BodyId),
    /// A point, with fixed axes.
    Point(Anchor),
    /// A point, with the axes of another anchor.
    Turned { at: Anchor, along: Anchor },
    /// From one point towards another.
    Span([Anchor; 2]),
    /// The line along which a length driver measures, from the foot of its first point.
    Length {
        markers: [Anchor; 2],
        axis: Option<Anchor>,
    },
}

impl Rider {
    /// The body of an anchor.
    pub(super) fn of(anchor: Anchor) -> Self {
        anchor.body.map_or(Self::Ground, Self::Body)
    }

    /// What a symbol rides on.
    pub(super) fn of_symbol(symbol: &Symbol) -> Self {
        match symbol {
            Symbol::Link { body, .. } => Self::Body(*body),
            Symbol::SlotBlock { at, along } => Self::Turned {
                at: *at,
                along: *along,
            },
            Symbol::Rod { ends } => Self::Span(*ends),
            Symbol::Belt { centers, .. } => Self::Span(*centers),
            Symbol::Block { at, .. }
            | Symbol::Pin { at }
            | Symbol::Weld { at }
            | Symbol::Wheel { at, .. }
            | Symbol::Cam { at, .. }
            | Symbol::Knife { at }
            | Symbol::Roller { at, .. }
            | Symbol::AngleDriver { to: at, .. }
            | Symbol::Point { at, .. }
            | Symbol::Slot { along: at, .. }
            | Symbol::SlideWay { along: at, .. }
            | Symbol::Rack { along: at, .. }
            | Symbol::Face { along: at, .. } => Self::of(*at),
            Symbol::LengthDriver { from, to, axis, .. } => Self::Length {
                markers: [*from, *to],
                axis: *axis,
            },
            Symbol::Fixture { .. } | Symbol::Trace { .. } => Self::Ground,
        }
    }

    /// Where it is at q.
    pub(super) fn frame(&self, q: &[f64]) -> Frame {
        let at = |body| Anchor {
            body,
            position: [0.0; 2],
            angle: 0.0,
        };
        match self {
            Self::Ground => at(None).placed(q),
            Self::Body(body) => at(Some(*body)).placed(q),
            Self::Point(anchor) => Frame {
                angle: 0.0,
                ..anchor.placed(q)
            },
            Self::Turned { at, along } => Frame {
                angle: along.placed(q).angle,
                ..at.placed(q)
            },
            Self::Span([start, end]) => {
                let point = start.placed(q).point;
                Frame {
                    point,
                    angle: angle(end.placed(q).point - point),
                }
            }
            Self::Length { markers, axis } => {
                let [from, to] = markers.map(|marker| marker.placed(q).point);
                let along = along(*axis, to - from, q);
                Frame {
                    point: to - (to - from).dot(&along) * along,
                    angle: angle(along),
                }
            }
        }
    }
}

/// The direction in which a length is measured.
pub(super) fn along(axis: Option<Anchor>, from_to: Point, q: &[f64]) -> Point {
    axis.map_or_else(|| unit(from_to), |axis| direction(axis.placed(q).angle))
}
