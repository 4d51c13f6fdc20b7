//! Places for the names of bodies.

use std::f64::consts::{PI, TAU};

use super::{BAR, Pen, on_sheet_direction};
use crate::drawing::labels::Candidate;
use crate::drawing::outline::{Point, across, unit};
use crate::mechanism::BodyId;

impl Pen<'_> {
    /// Places for a body's name along the edges of its hull, and inside a large one.
    pub(super) fn places_along(&mut self, body: BodyId, hull: &[Point]) {
        let places = &mut self.body_places[body.index()];
        let center = hull.iter().sum::<Point>() / hull.len() as f64;
        if hull.len() == 1 {
            places.extend(around(center, BAR));
            return;
        }
        if hull.len() > 2 {
            places.push(Candidate {
                anchor: center,
                side: None,
                gap: 0.0,
                cost: 0.0,
            });
        }
        for corner in hull {
            places.extend(around(*corner, BAR + 1.0).map(|mut candidate| {
                // Several bodies meet there: the name could be any one's.
                candidate.cost += 10.0;
                candidate
            }));
        }
        for (index, start) in hull.iter().enumerate() {
            let end = hull[(index + 1) % hull.len()];
            let normal = across(unit(end - start));
            for (part, less) in [
                (0.5, 0.0),
                (0.38, 1.0),
                (0.62, 1.0),
                (0.26, 2.0),
                (0.74, 2.0),
                (0.14, 4.0),
                (0.86, 4.0),
            ] {
                for (gap, far) in [(BAR + 5.0, 0.0), (BAR + 13.0, 5.0), (BAR + 24.0, 12.0)] {
                    let anchor = start + part * (end - start);
                    // Outside: away from the middle of the hull; a bar has both sides, one of
                    // them as its edge back.
                    let out = if hull.len() > 2 && normal.dot(&(anchor - center)) < 0.0 {
                        -normal
                    } else {
                        normal
                    };
                    places.push(Candidate {
                        anchor,
                        side: Some(out),
                        gap,
                        cost: less + far + 1.0,
                    });
                }
            }
        }
    }

    /// Places for a body's name on one side of a line.
    pub(super) fn places_beside(
        &mut self,
        body: Option<BodyId>,
        [start, end]: [Point; 2],
        side: Point,
    ) {
        let Some(body) = body else { return };
        let places = &mut self.body_places[body.index()];
        for part in [0.5, 0.3, 0.7, 0.1, 0.9] {
            for (gap, far) in [(5.0, 0.0), (13.0, 5.0), (24.0, 12.0)] {
                places.push(Candidate {
                    anchor: start + part * (end - start),
                    side: Some(side),
                    gap,
                    cost: far + 4.0 * f64::abs(part - 0.5),
                });
            }
        }
    }
}

/// Places around something round: right and above first, as one reads.
pub(super) fn around(center: Point, radius: f64) -> impl Iterator<Item = Candidate> {
    const SIDES: u32 = 16;
    [(3.0, 0.0), (10.0, 4.0), (20.0, 10.0)]
        .into_iter()
        .flat_map(move |(gap, far)| {
            (0..SIDES).map(move |k| {
                let turn = f64::from(k) / f64::from(SIDES) * TAU;
                let from_best = (turn - 0.25 * PI).cos();
                Candidate {
                    anchor: center,
                    side: Some(on_sheet_direction(turn)),
                    gap: gap + radius,
                    cost: far + 1.0 - from_best,
                }
            })
        })
}
