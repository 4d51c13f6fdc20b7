//! Sliders on lines and arcs, gears and chains.

use super::document::Document;
use super::xml::Element;
use crate::exchange::draft::{
    BodyRef, Coordinate, Draft, GROUND, JointKind, Point, PointRef, Stop, Wheels,
};
use crate::exchange::error::{self, Error};
use crate::exchange::note::Note;
use crate::exchange::sketch::Bodies;
use biela::mechanism::rounded;

/// Part of a way's size by which a drawn slider may be off it: six decimals of a 96th of an inch are
/// far less, and a slider that is not meant to be on its way is farther off.
const OFF_WAY: f64 = 1e-3;

impl Document<'_> {
    /// Adds the way of a slider.
    pub(super) fn slider(
        &self,
        draft: &mut Draft,
        bodies: &Bodies,
        point: usize,
    ) -> Result<(), Error> {
        let element = self.connectors[point];
        let ends: Vec<&str> = element.ids("slidelimit").collect();
        if !element.is("slider") || bodies.at_point[point].is_empty() {
            return Ok(());
        }
        let name = self.sketch.name(point).to_owned();
        let [a, b] = ends[..] else {
            return Err(Error::SliderWay { slider: name });
        };
        let place = format!("slider `{name}`");
        let [a, b] = [self.point(&place, a)?, self.point(&place, b)?];
        let slid = bodies.at_point[point][0];
        let carriers = bodies.at_point[a].iter().map(|placed| placed.body);
        let carrier = carriers
            .filter(|body| *body != slid.body)
            .find(|body| bodies.on(*body, b).is_some());
        let Some(carrier) = carrier else {
            let is_held = |end| bodies.on(slid.body, end).is_some();
            if is_held(a) && is_held(b) {
                draft.note(Note::LeftOut {
                    kind: "slider",
                    name,
                    reason: "its way is on its own body",
                });
                return Ok(());
            }
            return Err(Error::SliderWay { slider: name });
        };
        let [from_at, to_at] = [a, b].map(|end| self.sketch.at(end));
        let way = [to_at[0] - from_at[0], to_at[1] - from_at[1]];
        let length = way[0].hypot(way[1]);
        let radius = element.number("slideradius")? / self.per_unit;
        let at = self.sketch.at(point);
        if length == 0.0 {
            return Err(Error::SliderWay { slider: name });
        }
        if radius != 0.0 {
            let (centre, radius) = arc(from_at, to_at, radius);
            let distance = (at[0] - centre[0]).hypot(at[1] - centre[1]);
            if (distance - radius).abs() > OFF_WAY * radius {
                return Err(Error::SliderArc {
                    slider: name,
                    radius,
                });
            }
            let from = draft.add_point(
                carrier,
                Point {
                    name: format!("{name}_centre"),
                    at: centre,
                    angle: None,
                },
            );
            draft.join(&format!("{name}_arc"), JointKind::Link(radius), from, slid);
            draft.note(Note::Limit {
                name,
                reason: "the ends of an arc are no limits of a coordinate",
            });
            return Ok(());
        }
        let off = [at[0] - from_at[0], at[1] - from_at[1]];
        let along = (off[0] * way[0] + off[1] * way[1]) / length;
        let across = (off[1] * way[0] - off[0] * way[1]) / length;
        if across.abs() > OFF_WAY * length {
            draft.note(Note::Moved {
                name: name.clone(),
                reason: "it is drawn beside its way",
            });
        }
        let from = draft.add_point(
            carrier,
            Point {
                name: format!("{name}_way"),
                at: from_at,
                angle: Some(way[1].atan2(way[0])),
            },
        );
        draft.join(&format!("{name}_slot"), JointKind::Slot, from, slid);
        let is_inside = [along >= 0.0, along <= length];
        if is_inside != [true; 2] {
            draft.note(Note::Limit {
                name: name.clone(),
                reason: "the slider is drawn beyond it",
            });
        }
        if is_inside == [false; 2] {
            return Ok(());
        }
        let max = format!("{}*{}", rounded(length, 9), draft.unit.name());
        draft.stops.push(Stop {
            name: format!("{name}_ends"),
            coordinate: Coordinate::X,
            from,
            to: slid,
            min: is_inside[0].then(|| "0".to_owned()),
            max: is_inside[1].then_some(max),
        });
        Ok(())
    }

    /// Adds a pair of gears or a chain.
    pub(super) fn ratio(
        &self,
        draft: &mut Draft,
        bodies: &Bodies,
        element: &Element,
    ) -> Result<(), Error> {
        let wheels: Vec<&Element> = element
            .children
            .iter()
            .filter(|c| c.name == "link")
            .collect();
        let place = "a ratio".to_owned();
        let &[a, b] = &wheels[..] else {
            return Err(Error::Missing {
                line: element.line,
                place,
                key: "link",
            });
        };
        let link = |wheel: &Element| {
            let id = wheel.id()?;
            self.link_by_id
                .get(id)
                .copied()
                .ok_or_else(|| Error::Unknown {
                    place: place.clone(),
                    kind: "link",
                    name: error::start_of(id),
                })
        };
        let links = [link(a)?, link(b)?];
        let are_radii = element.is("sizeassize");
        let sizes = [a.number("size")?, b.number("size")?].map(|size| {
            if are_radii {
                size / self.per_unit
            } else {
                size
            }
        });
        let axle = |link: usize| -> Option<(PointRef, usize)> {
            let point = *self.points_of[link].first()?;
            Some((bodies.on(bodies.of_link[link], point)?, point))
        };
        let axles = axle(links[0]).zip(axle(links[1]));
        let kind = error::start_of(element.text("type").unwrap_or("gears"));
        let Some(((from, p), (to, q))) = axles.filter(|_| sizes[0] > 0.0 && sizes[1] > 0.0) else {
            draft.note(Note::LeftOut {
                kind: "ratio",
                name: kind,
                reason: "its wheels have no axles or no sizes",
            });
            return Ok(());
        };
        let shares = |body: BodyRef| bodies.on(body, q).is_some();
        let mut carriers = bodies.at_point[p].iter().map(|placed| placed.body);
        let carrier = carriers.find(|body| *body != from.body && *body != to.body && shares(*body));
        let wheels = Wheels {
            sizes,
            are_radii,
            carrier: carrier.unwrap_or(GROUND),
        };
        let names = [from, to].map(|wheel| draft.bodies[wheel.body.0].name.clone());
        let kind = match &*kind {
            "chain" => JointKind::Belt(wheels),
            "gears" => JointKind::Gear(wheels),
            _ => {
                draft.note(Note::LeftOut {
                    kind: "ratio",
                    name: kind,
                    reason: "its type is neither gears nor chain",
                });
                return Ok(());
            }
        };
        draft.join(&format!("{}_{}", names[0], names[1]), kind, from, to);
        Ok(())
    }
}

/// Returns centre and radius of the arc from one point to another: to the left of the way for a
/// positive radius, to the right for a negative one. A circle through both has at least half of their
/// distance as its radius.
fn arc(a: [f64; 2], b: [f64; 2], radius: f64) -> ([f64; 2], f64) {
    let way = [b[0] - a[0], b[1] - a[1]];
    let half = way[0].hypot(way[1]) / 2.0;
    let size = radius.abs().max(half);
    let height = (size * size - half * half).sqrt().copysign(radius) / (2.0 * half);
    let centre = [
        (a[0] + b[0]) / 2.0 - height * way[1],
        (a[1] + b[1]) / 2.0 + height * way[0],
    ];
    (centre, size)
}
