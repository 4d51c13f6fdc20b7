//! The lines that meet at a singular position.
//!
//! With the drivers held, the null vector of the Jacobian moves some bodies. Those that move alike
//! and are joined count as one, as do all that rest. A connection with a resting one through which a
//! force can pass along one line only, such as a link or a slide, has this line pass through the
//! instant centre of the moving one. Where the lines of three connections, or a pin and a line, do
//! so, the connections are dependent: the position is singular for that reason.

use nalgebra::{DMatrix, DVector, Vector2};

use super::near::{FREE, LARGEST_BLOCK};
use crate::kinematics::alignment::{Alignment, LineRelation, Member};
use crate::kinematics::constraint::Gradient;
use crate::kinematics::constraint::configuration::{Configuration, perp};
use crate::kinematics::origin::Origin;
use crate::kinematics::plan::compiled_mechanism::CompiledMechanism;
use crate::kinematics::system::System;
use crate::mechanism::{BodyId, Coordinate, CoordinateKind, DriverId, MarkerId};

/// Largest distance of a line from a point that it passes through, as part of the mechanism's size,
/// and largest angle between parallel lines \[rad\], at a position that is located: the unknowns there
/// have half of the digits.
pub(super) const LOCATED: f64 = 1e-6;
/// Largest such distance and angle near a singular position.
pub(super) const NEARBY: f64 = 0.02;

/// A line along which a connection transmits force.
#[derive(Clone, Copy, Debug)]
struct Line {
    point: Vector2<f64>,
    direction: Vector2<f64>,
    of: Member,
}

/// The way in which an origin connects two groups of bodies.
#[derive(Clone, Copy, Debug)]
enum Way {
    Pin(Vector2<f64>),
    Line(Line),
    Other,
}

/// A connection of two groups of bodies.
#[derive(Clone, Copy, Debug)]
struct Connection {
    origin: Origin,
    way: Way,
    bodies: [usize; 2],
    /// The groups, by one of their bodies; the last is that of all bodies at rest.
    groups: [usize; 2],
}

impl Connection {
    /// Returns the group on the other side.
    fn other(&self, group: usize) -> usize {
        let [a, b] = self.groups;
        if a == group { b } else { a }
    }

    /// Returns the body of a group in the connection.
    fn body_of(&self, group: usize) -> Member {
        let [a, b] = self.bodies;
        Member::Body(BodyId(if self.groups[0] == group { a } else { b }))
    }
}

/// Bodies and their motion by a null vector.
struct Moving<'a> {
    system: &'a System,
    at: &'a Configuration,
    /// Velocity at each body's origin, in sizes, and angular velocity.
    twists: Vec<[f64; 3]>,
    /// Whether each row is one of the block or of those that it reads; those that read it transmit no
    /// force.
    acts: Vec<bool>,
    /// The group of each body, and of ground.
    groups: Vec<usize>,
    tolerance: f64,
}

/// Finds the lines that meet at a singular position, where the bodies are; `free` has the entries of
/// the null vector for these unknowns, scaled, the largest of them one. What it returns holds to
/// `tolerance`; without any such lines the members are all that moves.
pub(super) fn find_lines(
    compiled: &CompiledMechanism,
    at: &Configuration,
    free: (&[usize], &[f64]),
    tolerance: f64,
) -> Alignment {
    let moving = Moving::new(compiled, at, free, tolerance);
    let connections = moving.connections();
    let groups = moving.groups.iter().enumerate();
    let groups: Vec<usize> = groups
        .filter(|(body, group)| *body == **group && *body != moving.rest())
        .map(|(group, _)| group)
        .collect();
    let on_pin = |group: &usize| moving.on_pin(*group, &connections);
    let without_pin = |group: &usize| moving.without_pin(*group, &connections);
    let found = groups.iter().find_map(on_pin);
    found
        .or_else(|| groups.iter().find_map(without_pin))
        .unwrap_or_else(|| moving.free(free, &connections))
}

/// Returns all that a null vector moves.
pub(super) fn all_that_moves(
    compiled: &CompiledMechanism,
    at: &Configuration,
    free: (&[usize], &[f64]),
) -> Alignment {
    let moving = Moving::new(compiled, at, free, 0.0);
    moving.free(free, &moving.connections())
}

impl<'a> Moving<'a> {
    fn new(
        compiled: &'a CompiledMechanism,
        at: &'a Configuration,
        (columns, free): (&[usize], &[f64]),
        tolerance: f64,
    ) -> Self {
        let system = &compiled.system;
        let bodies = system.mechanism().bodies.len();
        let size = at.size();
        let mut motion = vec![0.0; system.unknowns()];
        for (&column, value) in columns.iter().zip(free) {
            motion[column] = value * system.column_scale(column, size);
        }
        let acts = follow(compiled, at, columns, &mut motion);
        let mut twists = vec![[0.0; 3]; bodies + 1];
        for (twist, motion) in twists.iter_mut().zip(motion.chunks(3)).take(bodies) {
            *twist = [motion[0] / size, motion[1] / size, motion[2]];
        }
        let mut moving = Self {
            system,
            at,
            twists,
            acts,
            groups: (0..=bodies).collect(),
            tolerance,
        };
        moving.group();
        moving
    }

    /// Returns the group of all that rests: that of ground.
    fn rest(&self) -> usize {
        self.groups[self.groups.len() - 1]
    }

    /// Returns the index of a marker's body, that of ground behind all others.
    fn body(&self, marker: MarkerId) -> usize {
        let body = self.system.mechanism().markers[marker.index()].body;
        body.map_or(self.twists.len() - 1, BodyId::index)
    }

    /// Returns the velocity of a body at a point, in sizes.
    fn velocity(&self, body: usize, point: Vector2<f64>) -> Vector2<f64> {
        let [x, y, omega] = self.twists[body];
        let origin = (self.at.frames().get(body)).map_or(point, |frame| frame.origin);
        Vector2::new(x, y) + perp(point - origin) * (omega / self.at.size())
    }

    /// Puts bodies into groups: those that rest, and those that are joined and move alike.
    fn group(&mut self) {
        let ground = self.twists.len() - 1;
        for body in 0..ground {
            if self.twists[body].iter().all(|part| part.abs() <= FREE) {
                self.groups[body] = ground;
            }
        }
        let mechanism = self.system.mechanism();
        for joint in &mechanism.joints {
            let [a, b] = [joint.from, joint.to].map(|marker| self.body(marker));
            let point = self.at.marker(joint.to).point;
            let apart = self.velocity(a, point) - self.velocity(b, point);
            let turn = self.twists[a][2] - self.twists[b][2];
            let [a, b] = [a, b].map(|body| self.groups[body]);
            if apart.norm().max(turn.abs()) <= FREE.max(self.tolerance) && a != b {
                // The group of what rests has the largest number.
                let [from, to] = [a.min(b), a.max(b)];
                let members = self.groups.iter_mut().filter(|group| **group == from);
                members.for_each(|group| *group = to);
            }
        }
    }

    /// Returns all connections of different groups.
    fn connections(&self) -> Vec<Connection> {
        let mechanism = self.system.mechanism();
        let joints = mechanism.joints.iter().enumerate().map(|(index, joint)| {
            let origin = Origin::Joint(index);
            let (from, to) = (joint.from, joint.to);
            let way = if joint.is_pin() {
                Way::Pin(self.at.marker(to).point)
            } else if joint.rod().is_some() {
                self.bar(origin, from, to)
            } else if joint.guide().is_some() {
                Way::Line(Line {
                    point: self.at.marker(to).point,
                    direction: perp(self.at.marker(from).axis),
                    of: Member::Origin(origin),
                })
            } else if joint.cam().is_some() {
                self.contact(origin, to)
            } else {
                Way::Other
            };
            (origin, way, from, to)
        });
        let of_coordinate = |origin: Origin, coordinate: &Coordinate| {
            let Coordinate {
                kind,
                from,
                to,
                axes,
            } = *coordinate;
            let axis = self.at.marker(axes).axis;
            let along = |direction| {
                let point = self.at.marker(to).point;
                let of = Member::Origin(origin);
                Way::Line(Line {
                    point,
                    direction,
                    of,
                })
            };
            let is_of_two = self.body(axes) == self.body(from);
            let way = match kind {
                CoordinateKind::Distance => self.bar(origin, from, to),
                CoordinateKind::X if is_of_two => along(axis),
                CoordinateKind::Y if is_of_two => along(perp(axis)),
                _ => Way::Other,
            };
            (origin, way, from, to)
        };
        let constraints = mechanism.constraints.iter().enumerate();
        let constraints =
            constraints.map(|(k, held)| of_coordinate(Origin::Constraint(k), &held.coordinate));
        let drivers = mechanism.drivers.iter().enumerate();
        let drivers = drivers
            .map(|(k, driver)| of_coordinate(Origin::Driver(DriverId(k)), &driver.coordinate));
        let all = joints.chain(constraints).chain(drivers);
        let all = all.filter(|(origin, ..)| self.transmits(*origin));
        let all = all.map(|(origin, way, from, to)| {
            let bodies = [from, to].map(|marker| self.body(marker));
            Connection {
                origin,
                way,
                bodies,
                groups: bodies.map(|body| self.groups[body]),
            }
        });
        let mut connections = Vec::new();
        for connection in all.filter(|own| own.groups[0] != own.groups[1]) {
            self.add(connection, &mut connections);
        }
        connections
    }

    /// Adds a connection. Two lines through one point are a pin.
    fn add(&self, connection: Connection, connections: &mut Vec<Connection>) {
        let same = connections.iter_mut().find(|other| {
            let (Way::Line(a), Way::Line(b)) = (connection.way, other.way) else {
                return false;
            };
            let apart = (a.point - b.point).norm();
            connection.other(other.groups[0]) == other.groups[1]
                && connection.groups.contains(&other.groups[0])
                && apart <= self.tolerance * self.at.size()
                && a.direction.perp(&b.direction).abs() > NEARBY
        });
        match (same, connection.way) {
            (Some(other), Way::Line(line)) => other.way = Way::Pin(line.point),
            _ => connections.push(connection),
        }
    }

    /// Returns whether rows of an origin belong to the block or to those that it reads.
    fn transmits(&self, origin: Origin) -> bool {
        let mut rows = self.system.equations().iter().zip(&self.acts);
        rows.any(|(row, acts)| *acts && row.origin == origin)
    }

    /// Returns the line of a massless link or a cylinder.
    fn bar(&self, origin: Origin, from: MarkerId, to: MarkerId) -> Way {
        let [from, to] = [from, to].map(|marker| self.at.marker(marker).point);
        line_between(from, to, Member::Origin(origin)).map_or(Way::Other, Way::Line)
    }

    /// Returns the normal of a contact on a cam: the line of the force of its last row.
    fn contact(&self, origin: Origin, follower: MarkerId) -> Way {
        let rows = self.system.equations().iter();
        let Some(row) = rows.rev().find(|row| row.origin == origin) else {
            return Way::Other;
        };
        let mut gradient = Gradient::new();
        row.constraint.gradient(self.at, &mut gradient);
        let marker = self.at.marker(follower).point;
        let forces = gradient.bodies().iter();
        let mut lines = forces.filter_map(|&(body, [x, y, moment])| {
            let force = Vector2::new(x, y);
            let arm = marker - self.at.frames()[body].origin;
            let torque = moment - arm.perp(&force);
            let square = force.norm_squared();
            (square > 0.0).then(|| Line {
                point: marker - perp(force) * (torque / square),
                direction: force / square.sqrt(),
                of: Member::Origin(origin),
            })
        });
        lines.next().map_or(Way::Other, Way::Line)
    }

    /// Returns the lines of connections from a group to what rests, and the pins there: direct ones,
    /// and those by way of a group that has two connections.
    fn supports(&self, group: usize, connections: &[Connection]) -> Vec<(Connection, Way)> {
        let of_group = |group: usize| {
            let own = connections.iter();
            own.filter(move |connection| connection.groups.contains(&group))
        };
        let support = |connection: &Connection| {
            let next = connection.other(group);
            if next == self.rest() {
                return Some((*connection, connection.way));
            }
            let mut others = of_group(next).filter(|own| own.origin != connection.origin);
            let (behind, more) = (others.next()?, others.next());
            if more.is_some() || behind.other(next) != self.rest() {
                return None;
            }
            let line = match (connection.way, behind.way) {
                (Way::Pin(point), Way::Pin(end)) => {
                    line_between(point, end, connection.body_of(next))?
                }
                (Way::Pin(point), Way::Line(line)) => Line { point, ..line },
                _ => return None,
            };
            Some((*connection, Way::Line(line)))
        };
        of_group(group).filter_map(support).collect()
    }

    /// Returns whether a line passes through a point.
    fn passes(&self, line: &Line, point: Vector2<f64>) -> bool {
        let off = line.direction.perp(&(point - line.point)).abs();
        off <= self.tolerance * self.at.size()
    }

    /// Finds lines that pass through the pin on which a group turns.
    fn on_pin(&self, group: usize, connections: &[Connection]) -> Option<Alignment> {
        let supports = self.supports(group, connections);
        let (pin, center) = supports.iter().find_map(|(connection, way)| match way {
            Way::Pin(point) => Some((*connection, *point)),
            _ => None,
        })?;
        let lines = lines_of(&supports);
        let through: Vec<_> = lines.filter(|line| self.passes(line, center)).collect();
        if let [line] = through[..]
            && !self.is_contact(line.of)
        {
            return Some(Alignment {
                relation: LineRelation::InLine,
                members: self.ordered(vec![pin.body_of(group), line.of]),
            });
        }
        let mut members: Vec<_> = through.iter().map(|line| line.of).collect();
        if members.is_empty() {
            return None;
        }
        members.push(Member::Origin(pin.origin));
        Some(Alignment {
            relation: LineRelation::ThroughPin,
            members,
        })
    }

    /// Finds three lines or more that meet in the instant centre of a group, or are parallel.
    fn without_pin(&self, group: usize, connections: &[Connection]) -> Option<Alignment> {
        let supports = self.supports(group, connections);
        let lines: Vec<_> = lines_of(&supports).collect();
        let (first, rest) = lines.split_first()?;
        if rest.len() < 2 {
            return None;
        }
        let members = || lines.iter().map(|line| line.of).collect();
        let across = |line: &Line| line.direction.perp(&first.direction);
        if rest.iter().all(|line| across(line).abs() <= self.tolerance) {
            return Some(Alignment {
                relation: LineRelation::Parallel,
                members: members(),
            });
        }
        let [x, y, omega] = self.twists[group];
        let origin = self.at.frames()[group].origin;
        // v + ω × (P − r) = 0.
        let center = origin + Vector2::new(-y, x) * (self.at.size() / omega);
        let meet = center.iter().all(|part| part.is_finite())
            && lines.iter().all(|line| self.passes(line, center));
        meet.then(|| Alignment {
            relation: LineRelation::Concurrent,
            members: members(),
        })
    }

    fn is_contact(&self, member: Member) -> bool {
        member.is_contact(self.system.mechanism())
    }

    /// Returns bodies in their order, then all else.
    fn ordered(&self, mut members: Vec<Member>) -> Vec<Member> {
        members.sort_by_key(|member| match member {
            Member::Body(body) => body.index(),
            Member::Origin(_) => self.twists.len(),
        });
        members
    }

    /// Returns all bodies, joints and massless links that move.
    fn free(&self, (columns, free): (&[usize], &[f64]), connections: &[Connection]) -> Alignment {
        let bodies = self.twists.len() - 1;
        let moved = columns.iter().zip(free);
        let moved = moved.filter(|(_, value)| value.abs() > FREE);
        let mut unknowns: Vec<usize> = moved.map(|(column, _)| *column).collect();
        unknowns.sort_unstable();
        let of_unknown = |column: usize| match column / 3 {
            body if body < bodies => Member::Body(BodyId(body)),
            _ => Member::Origin(self.system.origin_of(column)),
        };
        let mut members: Vec<_> = unknowns.into_iter().map(of_unknown).collect();
        // The unknowns of a body are next to each other.
        members.dedup();
        let links = connections
            .iter()
            .filter_map(|connection| match connection.way {
                Way::Line(line) if !self.is_contact(line.of) => Some(line.of),
                _ => None,
            });
        members.extend(links);
        Alignment {
            relation: LineRelation::Free,
            members,
        }
    }
}

/// Returns the lines among supports.
fn lines_of(supports: &[(Connection, Way)]) -> impl Iterator<Item = Line> {
    supports.iter().filter_map(|(_, way)| match way {
        Way::Line(line) => Some(*line),
        _ => None,
    })
}

/// Returns the line through two points, if they are apart.
fn line_between(from: Vector2<f64>, to: Vector2<f64>, of: Member) -> Option<Line> {
    let direction = (to - from).try_normalize(0.0)?;
    Some(Line {
        point: from,
        direction,
        of,
    })
}

/// Extends the motion of a block's unknowns to those of blocks that read it. Returns for each row
/// whether it belongs to the block or to those that it reads, or is set aside.
fn follow(
    compiled: &CompiledMechanism,
    at: &Configuration,
    columns: &[usize],
    motion: &mut [f64],
) -> Vec<bool> {
    let system = &compiled.system;
    let mut acts = vec![false; system.equations().len()];
    let mut is_known = vec![false; motion.len()];
    for &row in &compiled.redundant.now {
        acts[row] = true;
    }
    for block in compiled.blocks_behind(columns) {
        block.rows.iter().for_each(|&row| acts[row] = true);
        block
            .columns
            .iter()
            .for_each(|&column| is_known[column] = true);
    }
    let size = at.size();
    for block in compiled.structure.blocks() {
        let order = block.columns.len();
        if is_known[block.columns[0]] || order > LARGEST_BLOCK {
            continue;
        }
        let mut jacobian = DMatrix::<f64>::zeros(order, order);
        let mut side = DVector::<f64>::zeros(order);
        for (local, &row) in block.rows.iter().enumerate() {
            let equation = &system.equations()[row];
            let mut gradient = Gradient::new();
            equation.constraint.gradient(at, &mut gradient);
            let scale = equation.row_scale(at);
            for (column, partial) in gradient.entries() {
                match block.columns.iter().position(|&own| own == column) {
                    Some(own) => {
                        jacobian[(local, own)] +=
                            partial * scale * system.column_scale(column, size);
                    }
                    None => side[local] -= partial * scale * motion[column],
                }
            }
        }
        if side.amax() > 0.0
            && let Some(found) = jacobian.lu().solve(&side)
        {
            for (&column, value) in block.columns.iter().zip(found.iter()) {
                motion[column] = value * system.column_scale(column, size);
            }
        }
    }
    acts
}
