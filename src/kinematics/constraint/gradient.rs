//! A row of the Jacobian.

use nalgebra::Vector2;

use super::configuration::{MarkerPose, perp};
use crate::mechanism::{BodyId, MOST_BODIES};

/// A row of the Jacobian: its entries for some bodies and one joint unknown.
///
/// It does not allocate. Most relations have at most three markers, hence three bodies; a rope or a
/// coupling may have eight.
#[derive(Clone, Debug, Default)]
pub struct Gradient {
    len: usize,
    parts: [(usize, [f64; 3]); MOST_BODIES],
    /// Index in q of a joint unknown, and its entry.
    joint_unknown: Option<(usize, f64)>,
}

impl Gradient {
    /// Makes an empty row.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Removes all entries.
    pub fn clear(&mut self) {
        self.len = 0;
        self.joint_unknown = None;
    }

    /// Adds the gradient of `direction · P` with the marker's point P and a fixed `direction`.
    pub fn add_point(&mut self, marker: MarkerPose, direction: Vector2<f64>) {
        if let Some(part) = self.part(marker.body) {
            part[0] += direction.x;
            part[1] += direction.y;
            part[2] += direction.dot(&perp(marker.arm));
        }
    }

    /// Adds bounds of a point's entries: `direction` for x and y, `swing` for phi.
    pub(super) fn add_point_bound(&mut self, marker: MarkerPose, direction: f64, swing: f64) {
        if let Some(part) = self.part(marker.body) {
            part[0] += direction;
            part[1] += direction;
            part[2] += swing;
        }
    }

    /// Adds the gradient of `factor * theta` with the marker's angle theta.
    pub fn add_direction(&mut self, marker: MarkerPose, factor: f64) {
        self.add_turn(marker.body, factor);
    }

    /// Adds the gradient of `factor * phi` with the body's angle phi; nothing for ground.
    pub fn add_turn(&mut self, body: Option<BodyId>, factor: f64) {
        if let Some(part) = self.part(body) {
            part[2] += factor;
        }
    }

    /// Adds another row.
    pub(super) fn add(&mut self, row: &Self) {
        self.add_multiple(1.0, row);
        if let Some((column, value)) = row.joint_unknown {
            self.add_joint_unknown(column, value);
        }
    }

    /// Adds the multiple of a row that has no joint unknown.
    pub(super) fn add_multiple(&mut self, factor: f64, row: &Self) {
        for &(body, entries) in row.bodies() {
            if let Some(part) = self.part(Some(BodyId(body))) {
                for (entry, value) in part.iter_mut().zip(entries) {
                    *entry += factor * value;
                }
            }
        }
    }

    /// Adds the entry of a joint unknown; a relation contains at most one.
    pub fn add_joint_unknown(&mut self, column: usize, value: f64) {
        let entry = self.joint_unknown.get_or_insert((column, 0.0));
        debug_assert_eq!(entry.0, column, "a relation has at most one joint unknown");
        entry.1 += value;
    }

    /// Returns the entries as pairs of an index in q and a value, body by body.
    pub fn entries(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.parts[..self.len]
            .iter()
            .flat_map(|(body, part)| (0..3).map(move |k| (3 * body + k, part[k])))
            .chain(self.joint_unknown)
    }

    /// Returns the entries body by body: its index, and those at x, y and phi.
    pub(in crate::kinematics) fn bodies(&self) -> &[(usize, [f64; 3])] {
        &self.parts[..self.len]
    }

    /// Returns the index in q of the joint unknown, and its entry.
    pub(in crate::kinematics) fn joint_unknown(&self) -> Option<(usize, f64)> {
        self.joint_unknown
    }

    /// Returns the entries at x, y and phi of a body.
    #[must_use]
    pub fn of_body(&self, body: BodyId) -> [f64; 3] {
        let mut parts = self.parts[..self.len].iter();
        let part = parts.find(|(index, _)| *index == body.index());
        part.map_or([0.0; 3], |(_, part)| *part)
    }

    /// Returns the product of the row and a vector as long as q.
    #[must_use]
    pub fn dot(&self, vector: &[f64]) -> f64 {
        self.entries().map(|(k, value)| value * vector[k]).sum()
    }

    /// Replaces each entry by a function of its index in q and its value.
    pub(in crate::kinematics) fn replace(&mut self, mut of: impl FnMut(usize, f64) -> f64) {
        for (body, part) in &mut self.parts[..self.len] {
            for (k, value) in part.iter_mut().enumerate() {
                *value = of(3 * *body + k, *value);
            }
        }
        if let Some((column, value)) = &mut self.joint_unknown {
            *value = of(*column, *value);
        }
    }

    fn part(&mut self, body: Option<BodyId>) -> Option<&mut [f64; 3]> {
        let body = body?.index();
        let known = self.parts[..self.len].iter().position(|(b, _)| *b == body);
        let index = known.unwrap_or_else(|| {
            self.parts[self.len] = (body, [0.0; 3]);
            self.len += 1;
            self.len - 1
        });
        Some(&mut self.parts[index].1)
    }
}
