//! A mechanism as it is drawn: where its file starts it, closed as far as it closes.

use std::sync::Arc;

use crate::drawing::animation::MovingPicture;
use crate::page::assembled;
use biela::kinematics::{Error, Path};
use biela::mechanism::{BodyId, Coordinate, Diagnostic, MarkerId, Mechanism, Severity, Source};

/// Part of the drawing's size within which two points are one.
const SAME: f64 = 1e-6;
/// Part of the drawing's size to which a pose is found at a dead point, where rounding leaves its square
/// root: 1.5e-8, and a few times as much after several bodies. Halved, numbers end in noise there.
const POSE: f64 = 1e-7;

/// A mechanism at the pose at which its file starts it.
#[derive(Debug)]
pub(super) struct Drawn {
    /// The mechanism; `None` for a sheet without bodies.
    pub(super) mechanism: Option<Arc<Mechanism>>,
    pub(super) parameters: Vec<f64>,
    /// x, y \[m\] and phi \[rad\] of each body.
    pub(super) q: Vec<f64>,
    /// Number of coordinates that nothing drives.
    pub(super) undriven: usize,
    /// The reason why the mechanism is drawn at its estimates.
    pub(super) open: Option<Error>,
}

impl Drawn {
    /// Reads a file and closes its mechanism. Returns the problems of the file, and nothing drawn if
    /// one of them is an error; a file without bodies is an empty sheet.
    pub(super) fn read(source: &Source) -> (Option<Self>, Vec<Diagnostic>) {
        match Mechanism::parse(source) {
            Ok((mechanism, problems)) => (Some(Self::of(Arc::new(mechanism))), problems),
            Err(problems) => {
                let mut errors = problems.iter().filter(|p| p.severity == Severity::Error);
                let is_empty = errors.all(|error| error.code == "no-bodies");
                if is_empty {
                    return (Some(Self::empty()), Vec::new());
                }
                (None, problems)
            }
        }
    }

    fn empty() -> Self {
        Self {
            mechanism: None,
            parameters: Vec::new(),
            q: Vec::new(),
            undriven: 0,
            open: None,
        }
    }

    fn of(mechanism: Arc<Mechanism>) -> Self {
        match assembled(&mechanism) {
            Ok(solver) => Self {
                parameters: solver.pose().parameters.clone(),
                q: solver.pose().q.clone(),
                undriven: solver.mechanism().drivers.len() - mechanism.drivers.len(),
                open: None,
                mechanism: Some(mechanism),
            },
            Err(error) => {
                let parameters = Path::new(&mechanism).to;
                let bodies = mechanism.bodies.iter();
                let estimates = bodies.flat_map(|body| {
                    let estimate = body.estimate.each_ref();
                    estimate.map(|part| Some(part.value(&parameters)).filter(|x| x.is_finite()))
                });
                Self {
                    q: estimates.map(Option::unwrap_or_default).collect(),
                    parameters,
                    undriven: 0,
                    open: Some(error),
                    mechanism: Some(mechanism),
                }
            }
        }
    }

    /// Returns the picture at a scale \[units of the picture per metre\], with labels or in a glimpse.
    pub(super) fn picture(&self, scale: f64, labelled: bool) -> Option<MovingPicture> {
        let mechanism = self.mechanism.as_ref()?;
        Some(MovingPicture::still(
            mechanism,
            &self.parameters,
            &self.q,
            scale,
            labelled,
        ))
    }

    /// Returns the frame of a body, that of ground for `None`.
    pub(super) fn frame(&self, body: Option<BodyId>) -> [f64; 3] {
        body.map_or([0.0; 3], |body| {
            [0, 1, 2].map(|k| self.q[3 * body.index() + k])
        })
    }

    /// Returns point \[m\] and angle \[rad\] of a marker in the frame of its body.
    pub(super) fn inside(&self, marker: MarkerId) -> [f64; 3] {
        let Some(mechanism) = &self.mechanism else {
            return [0.0; 3];
        };
        let marker = &mechanism.markers[marker.index()];
        let [x, y] = marker
            .position
            .each_ref()
            .map(|e| e.value(&self.parameters));
        [x, y, marker.angle.value(&self.parameters)]
    }

    /// Returns global point \[m\] and angle \[rad\] of a marker, with the bodies at `q`.
    pub(super) fn place(&self, marker: MarkerId) -> [f64; 3] {
        let body = self
            .mechanism
            .as_ref()
            .and_then(|m| m.markers[marker.index()].body);
        outside(self.frame(body), self.inside(marker))
    }

    /// Returns a coordinate of a point \[m\] without the noise of the pose.
    pub(super) fn settled(&self, value: f64) -> f64 {
        neat(value, POSE * self.size())
    }

    /// Returns the value of a coordinate \[m or rad\] without the noise of the pose.
    pub(super) fn settled_value(&self, value: f64, is_angle: bool) -> f64 {
        if is_angle {
            neat(value.to_degrees(), POSE.to_degrees()).to_radians()
        } else {
            self.settled(value)
        }
    }

    /// Returns the global point of a marker \[m\] without the noise of the pose.
    pub(super) fn point(&self, marker: MarkerId) -> [f64; 2] {
        let [x, y, _] = self.place(marker);
        [x, y].map(|x| self.settled(x))
    }

    /// Returns the frame of a body without the noise of the pose.
    pub(super) fn settled_frame(&self, [x, y, phi]: [f64; 3]) -> [f64; 3] {
        [
            self.settled(x),
            self.settled(y),
            self.settled_value(phi, true),
        ]
    }

    /// Returns a marker by its path, such as `crank.A`.
    pub(super) fn marker(&self, path: &str) -> Option<MarkerId> {
        let mechanism = self.mechanism.as_ref()?;
        let mut markers = (0..mechanism.markers.len()).map(MarkerId);
        markers.find(|id| mechanism.marker_path(*id) == path)
    }

    /// Returns the value of a coordinate \[m or rad\], an angle within half a turn.
    pub(super) fn value(&self, coordinate: Coordinate) -> f64 {
        Self::value_at(coordinate, |marker| self.place(marker))
    }

    /// Returns the value of a coordinate where the markers are at these places.
    pub(super) fn value_at(coordinate: Coordinate, place: impl Fn(MarkerId) -> [f64; 3]) -> f64 {
        let value = coordinate.between(place);
        if coordinate.kind.is_angle() {
            within_turn(value)
        } else {
            value
        }
    }

    /// Returns all markers that pins hold at a marker's point, itself among them.
    pub(super) fn pinned_to(&self, marker: MarkerId) -> Vec<MarkerId> {
        let joints = self.mechanism.as_ref().map_or(&[][..], |m| &m.joints);
        let mut found = vec![marker];
        let mut next = 0;
        while let Some(&at) = found.get(next) {
            next += 1;
            let pins = joints.iter().filter(|joint| joint.is_pin());
            for (from, to) in pins.map(|joint| (joint.from, joint.to)) {
                let other = match at {
                    _ if at == from => to,
                    _ if at == to => from,
                    _ => continue,
                };
                if !found.contains(&other) {
                    found.push(other);
                }
            }
        }
        found
    }

    /// Returns the distance within which two points are one \[m\].
    pub(super) fn same(&self) -> f64 {
        SAME * self.size() + f64::MIN_POSITIVE
    }

    /// Returns the size of what is drawn \[m\]: the longer side of the box around all markers.
    pub(super) fn size(&self) -> f64 {
        let Some(mechanism) = &self.mechanism else {
            return 0.0;
        };
        let places = (0..mechanism.markers.len()).map(|index| self.place(MarkerId(index)));
        let places: Vec<[f64; 3]> = places.collect();
        let side = |k: usize| {
            let low = places.iter().map(|p| p[k]).fold(f64::INFINITY, f64::min);
            let high = places
                .iter()
                .map(|p| p[k])
                .fold(f64::NEG_INFINITY, f64::max);
            (high - low).max(0.0)
        };
        side(0).max(side(1))
    }
}

/// Returns the global place of a frame that stands in another one.
pub(super) fn outside([x, y, phi]: [f64; 3], [u, v, angle]: [f64; 3]) -> [f64; 3] {
    let (sin, cos) = phi.sin_cos();
    [x + cos * u - sin * v, y + sin * u + cos * v, phi + angle]
}

/// Returns a global point in a frame.
pub(super) fn inside([x, y, phi]: [f64; 3], at: [f64; 2]) -> [f64; 2] {
    let (sin, cos) = phi.sin_cos();
    let [dx, dy] = [at[0] - x, at[1] - y];
    [cos * dx + sin * dy, cos * dy - sin * dx]
}

/// Returns the shortest decimal within a distance of a number, which is its own where a decimal within it
/// would be chance.
pub(super) fn neat(value: f64, slack: f64) -> f64 {
    /// Least distance of decimals over the one within which they are found.
    const RARE: f64 = 1e3;
    let scales = (0..15).map(|decimals| 10.0_f64.powi(decimals));
    let rare = scales.take_while(|scale| RARE * slack * scale <= 1.0);
    let mut decimals = rare.map(|scale| (value * scale).round() / scale);
    let found = decimals.find(|decimal| (decimal - value).abs() <= slack);
    found.unwrap_or(value) + 0.0
}

/// Returns the angle in (−π, π] that differs by whole turns.
pub(super) fn within_turn(angle: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    let rest = angle - turn * (angle / turn).round();
    if rest <= -std::f64::consts::PI {
        rest + turn
    } else {
        rest
    }
}
