//! The search for the way between the anchors of a dyad.

use super::anchor_path::{AnchorPath, Leg};
use crate::mechanism::{MarkerId, Mechanism};

/// Most bodies on the way between two anchors. A longer way is no better than the pivots of the
/// bodies that carry the anchors.
const MOST_ARMS: usize = 6;
/// Most bodies that a search looks at from either end: the work per dyad is bounded.
const MOST_VISITS: usize = 48;
/// Most revolutes that a search follows from a body.
const MOST_REVOLUTES: usize = 16;

/// The revolutes between bodies that blocks have found, in the order of solution.
#[derive(Debug)]
pub(super) struct RevoluteGraph<'a> {
    mechanism: &'a Mechanism,
    /// The revolutes of each body.
    revolutes: Vec<Vec<Hinge>>,
    /// The dyad that found each body.
    dyad: Vec<Option<usize>>,
}

/// A revolute, seen from one of its bodies.
#[derive(Clone, Copy, Debug)]
struct Hinge {
    own: MarkerId,
    partner: MarkerId,
}

/// A body that a search has reached; `None` is ground.
#[derive(Clone, Copy, Debug)]
struct Visit {
    body: Option<usize>,
    /// Number of bodies before it on the way.
    depth: usize,
    /// The visit before it, and the revolute from there.
    before: Option<(usize, Hinge)>,
}

impl<'a> RevoluteGraph<'a> {
    /// Begins without any body found.
    pub(super) fn new(mechanism: &'a Mechanism) -> Self {
        let bodies = mechanism.bodies.len();
        Self {
            mechanism,
            revolutes: vec![Vec::new(); bodies],
            dyad: vec![None; bodies],
        }
    }

    fn body_of(&self, marker: MarkerId) -> Option<usize> {
        let body = self.mechanism.markers[marker.index()].body;
        body.map(|body| body.index())
    }

    /// Adds a revolute between bodies that are found.
    pub(super) fn add(&mut self, from: MarkerId, to: MarkerId) {
        for (own, partner) in [(from, to), (to, from)] {
            let Some(body) = self.body_of(own) else {
                continue;
            };
            let hinge = Hinge { own, partner };
            let on_ground = self.body_of(partner).is_none();
            let revolutes = &mut self.revolutes[body];
            // Ground ends a search, so that it comes first.
            let place = if on_ground { 0 } else { revolutes.len() };
            revolutes.insert(place, hinge);
        }
    }

    /// Notes the dyad with this index in the plan as the one that finds two bodies.
    pub(super) fn add_dyad(&mut self, index: usize, bodies: [usize; 2]) {
        for body in bodies {
            self.dyad[body] = Some(index);
        }
    }

    /// Returns the way from the anchor of side b to the anchor of side a, over the fewest bodies;
    /// notes in `read` the dyads both of whose bodies follow each other on it.
    pub(super) fn path(&self, [a, b]: [MarkerId; 2], read: &mut [bool]) -> AnchorPath {
        let Some(legs) = self.legs(a, b) else {
            return AnchorPath::by_pivots(self.mechanism, [a, b]);
        };
        AnchorPath::new(&legs, |first, second| match self.dyad[first] {
            Some(dyad) if self.dyad[second] == Some(dyad) => {
                read[dyad] = true;
                true
            }
            _ => false,
        })
    }

    fn legs(&self, a: MarkerId, b: MarkerId) -> Option<Vec<Leg>> {
        let [from_a, from_b] = [a, b].map(|marker| self.visit_from(self.body_of(marker)));
        let mut meeting: Option<(usize, [usize; 2])> = None;
        for (k, end) in from_b.iter().enumerate() {
            for (m, other) in from_a.iter().enumerate() {
                let arms = end.depth + other.depth + usize::from(end.body.is_some());
                let shortest = meeting.map_or(MOST_ARMS + 1, |(arms, _)| arms);
                if end.body == other.body && arms < shortest {
                    meeting = Some((arms, [k, m]));
                }
            }
        }
        let (_, [mut from, mut to]) = meeting?;
        // From the meeting back to b, then on to a.
        let mut hinges = Vec::new();
        while let Some((before, Hinge { own, partner })) = from_b[from].before {
            hinges.push([own, partner]);
            from = before;
        }
        hinges.reverse();
        while let Some((before, Hinge { own, partner })) = from_a[to].before {
            hinges.push([partner, own]);
            to = before;
        }
        let entries = std::iter::once(b).chain(hinges.iter().map(|hinge| hinge[1]));
        let exits = hinges.iter().map(|hinge| hinge[0]);
        let legs = entries.zip(exits.chain([a])).map(|(from, to)| Leg {
            body: self.body_of(from),
            from: Some(from),
            to: Some(to),
        });
        Some(legs.collect())
    }

    /// Returns the bodies around one, breadth first, not beyond ground.
    fn visit_from(&self, start: Option<usize>) -> Vec<Visit> {
        let mut visits = vec![Visit {
            body: start,
            depth: 0,
            before: None,
        }];
        let mut next = 0;
        while let Some(&visit) = visits.get(next) {
            if let Some(body) = visit.body
                && visit.depth + 1 < MOST_ARMS
            {
                for &hinge in self.revolutes[body].iter().take(MOST_REVOLUTES) {
                    let reached = self.body_of(hinge.partner);
                    let is_new = visits.iter().all(|visit| visit.body != reached);
                    if is_new && visits.len() < MOST_VISITS {
                        visits.push(Visit {
                            body: reached,
                            depth: visit.depth + 1,
                            before: Some((next, hinge)),
                        });
                    }
                }
            }
            next += 1;
        }
        visits
    }
}
