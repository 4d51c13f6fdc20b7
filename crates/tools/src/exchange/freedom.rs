//! Coordinates that nothing drives, by the rank of the constraints' Jacobian at the drawn pose.

use super::draft::{
    BodyRef, Coordinate, Draft, Driver, DriverSource, GROUND, Joint, JointKind, PointRef,
};
use super::note::Note;

/// Most bodies whose freedoms are sought: elimination takes the third power of their number, less than
/// a second here.
const MOST_BODIES: usize = 150;

/// Size of a row, relative to what it was, below which it depends on others: drawn places have nine
/// digits or more, and elimination of some hundred rows loses three.
const DEPENDENT: f64 = 1e-6;

/// Independent rows, each with the column of its pivot.
#[derive(Default)]
struct Rows {
    rows: Vec<(usize, Vec<f64>)>,
}

impl Rows {
    /// Adds a row; returns whether it is independent of those before.
    fn add(&mut self, mut row: Vec<f64>) -> bool {
        let size = |row: &[f64]| row.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
        let before = size(&row);
        for (pivot, known) in &self.rows {
            let factor = row[*pivot] / known[*pivot];
            if factor != 0.0 {
                for (x, y) in row.iter_mut().zip(known) {
                    *x -= factor * y;
                }
                row[*pivot] = 0.0;
            }
        }
        let rest = size(&row);
        if rest.is_nan() || rest <= DEPENDENT * before {
            return false;
        }
        let columns = 0..row.len();
        let pivot = columns.max_by(|a, b| row[*a].abs().total_cmp(&row[*b].abs()));
        self.rows.push((pivot.unwrap_or(0), row));
        true
    }
}

/// The Jacobian of a draft; lengths are in parts of its size.
struct Jacobian<'a> {
    draft: &'a Draft,
    size: f64,
}

impl Jacobian<'_> {
    fn row(&self) -> Vec<f64> {
        vec![0.0; 3 * (self.draft.bodies.len() - 1)]
    }

    /// Adds a multiple of a body's angle.
    fn turn(row: &mut [f64], body: BodyRef, factor: f64) {
        if body != GROUND {
            row[3 * (body.0 - 1) + 2] += factor;
        }
    }

    /// Adds the component of a point along a direction.
    fn shift(&self, row: &mut [f64], point: PointRef, [x, y]: [f64; 2]) {
        if point.body == GROUND {
            return;
        }
        let at = self.draft.point(point).at.map(|at| at / self.size);
        let first = 3 * (point.body.0 - 1);
        row[first] += x;
        row[first + 1] += y;
        row[first + 2] += x * -at[1] + y * at[0];
    }

    /// Returns the component of the way between two points along a direction of the first body.
    fn along(&self, from: PointRef, to: PointRef, [x, y]: [f64; 2]) -> Vec<f64> {
        let mut row = self.row();
        self.shift(&mut row, to, [x, y]);
        self.shift(&mut row, from, [-x, -y]);
        let [a, b] = [from, to].map(|point| self.draft.point(point).at);
        let way = [b[0] - a[0], b[1] - a[1]].map(|way| way / self.size);
        Self::turn(&mut row, from.body, -y * way[0] + x * way[1]);
        row
    }

    fn angle(&self, from: BodyRef, to: BodyRef) -> Vec<f64> {
        let mut row = self.row();
        Self::turn(&mut row, to, 1.0);
        Self::turn(&mut row, from, -1.0);
        row
    }

    fn distance(&self, from: PointRef, to: PointRef) -> Vec<f64> {
        let [a, b] = [from, to].map(|point| self.draft.point(point).at);
        let way = [b[0] - a[0], b[1] - a[1]];
        let length = way[0].hypot(way[1]).max(f64::MIN_POSITIVE);
        let mut row = self.row();
        let [x, y] = way.map(|way| way / length);
        self.shift(&mut row, to, [x, y]);
        self.shift(&mut row, from, [-x, -y]);
        row
    }

    fn coordinate(&self, coordinate: Coordinate, from: PointRef, to: PointRef) -> Vec<f64> {
        match coordinate {
            Coordinate::Angle => self.angle(from.body, to.body),
            Coordinate::Distance => self.distance(from, to),
            Coordinate::X => {
                let (sin, cos) = self.draft.direction(from).sin_cos();
                self.along(from, to, [cos, sin])
            }
        }
    }

    /// Returns the rows of a joint.
    fn joint(&self, kind: &JointKind, from: PointRef, to: PointRef) -> Vec<Vec<f64>> {
        let pin = || {
            [[1.0, 0.0], [0.0, 1.0]].map(|axis| {
                let mut row = self.row();
                self.shift(&mut row, to, axis);
                self.shift(&mut row, from, axis.map(|x| -x));
                row
            })
        };
        let (sin, cos) = self.draft.direction(from).sin_cos();
        let across = || self.along(from, to, [-sin, cos]);
        match kind {
            JointKind::Revolute => pin().into(),
            JointKind::Slot | JointKind::Offset(_) => vec![across()],
            JointKind::Translational => vec![across(), self.angle(from.body, to.body)],
            JointKind::Weld => {
                let mut rows = Vec::from(pin());
                rows.push(self.angle(from.body, to.body));
                rows
            }
            JointKind::Link(_) => vec![self.distance(from, to)],
            JointKind::Gear(wheels) | JointKind::Belt(wheels) => {
                let side = match kind {
                    JointKind::Gear(_) => 1.0,
                    _ => -1.0,
                };
                let [a, b] = wheels
                    .sizes
                    .map(|size| size / wheels.sizes[0].max(wheels.sizes[1]));
                let mut row = self.row();
                Self::turn(&mut row, from.body, a);
                Self::turn(&mut row, to.body, side * b);
                Self::turn(&mut row, wheels.carrier, -a - side * b);
                vec![row]
            }
            JointKind::Rack(radius) => {
                let (sin, cos) = self.draft.direction(to).sin_cos();
                let mut row = self.along(to, from, [cos, sin]);
                Self::turn(&mut row, from.body, radius / self.size);
                Self::turn(&mut row, to.body, -radius / self.size);
                vec![row]
            }
        }
    }
}

/// Name, kind and points of a coordinate that nothing decides.
pub(super) type FreeCoordinate = (String, Coordinate, PointRef, PointRef);

/// Returns the coordinate of a joint; an angle is measured from ground.
pub(super) fn free_coordinate(joint: &Joint, coordinate: Coordinate) -> FreeCoordinate {
    let (mut from, mut to) = (joint.from, joint.to);
    if coordinate == Coordinate::Angle && to.body == GROUND {
        (from, to) = (to, from);
    }
    let name = format!("{}_{}", joint.name, coordinate.name());
    (name, coordinate, from, to)
}

/// Returns the coordinates of joints that nothing decides yet, those on ground first; none of a
/// mechanism that is too large.
pub(super) fn undriven(draft: &Draft) -> Vec<FreeCoordinate> {
    if draft.bodies.len() > MOST_BODIES {
        return Vec::new();
    }
    let jacobian = Jacobian {
        draft,
        size: draft.size().max(f64::MIN_POSITIVE),
    };
    let mut rows = Rows::default();
    for joint in &draft.joints {
        for row in jacobian.joint(&joint.kind, joint.from, joint.to) {
            rows.add(row);
        }
    }
    for held in &draft.held {
        rows.add(jacobian.angle(held.from.body, held.to.body));
    }
    for driver in &draft.drivers {
        rows.add(jacobian.coordinate(driver.coordinate, driver.from, driver.to));
    }
    let mut joints: Vec<_> = draft.joints.iter().collect();
    joints.sort_by_key(|joint| joint.from.body != GROUND && joint.to.body != GROUND);
    let mut free = Vec::new();
    for joint in joints {
        let coordinates: &[Coordinate] = match joint.kind {
            JointKind::Revolute => &[Coordinate::Angle],
            JointKind::Translational => &[Coordinate::X],
            JointKind::Slot | JointKind::Offset(_) => &[Coordinate::X, Coordinate::Angle],
            _ => &[],
        };
        for &coordinate in coordinates {
            let found = free_coordinate(joint, coordinate);
            if rows.add(jacobian.coordinate(coordinate, found.2, found.3)) {
                free.push(found);
            }
        }
    }
    free
}

/// Makes coordinates of joints drivers of a mechanism that has none, as many as it needs; of one that
/// is too large to tell, the first pin or slide on ground.
pub(super) fn choose_drivers(draft: &mut Draft) {
    if !draft.drivers.is_empty() || !draft.freedoms.is_empty() {
        return;
    }
    let mut free = undriven(draft);
    if free.is_empty() {
        free.extend(first_on_ground(draft));
    }
    for (name, coordinate, from, to) in free {
        draft.note(Note::DriverChosen {
            driver: name.clone(),
        });
        draft.drivers.push(Driver {
            name,
            coordinate,
            from,
            to,
            source: DriverSource::Input,
            limits: None,
        });
    }
}

/// Returns the coordinate of the first pin on ground, or of the first slide.
fn first_on_ground(draft: &Draft) -> Option<FreeCoordinate> {
    let on_ground = |joint: &&Joint| joint.from.body == GROUND || joint.to.body == GROUND;
    let of_kind = |coordinate: Coordinate| {
        let mut joints = draft.joints.iter().filter(on_ground);
        let joint = joints.find(|joint| match joint.kind {
            JointKind::Revolute => coordinate == Coordinate::Angle,
            JointKind::Translational => coordinate == Coordinate::X,
            _ => false,
        })?;
        Some(free_coordinate(joint, coordinate))
    };
    of_kind(Coordinate::Angle).or_else(|| of_kind(Coordinate::X))
}
