//! A picture of a mechanism that moves as its reader likes: at any pose, without moments.

use serde_json::{Value, json};

use super::film::{labels, rates, tracked};
use super::picture::picture;
use super::stage::Stage;
use crate::drawing::anchor::Anchor;
use crate::drawing::attachment::{Attachment, on_sheet};
use crate::drawing::scene::Scene;
use crate::drawing::sheet::CAPITALS;
use crate::drawing::sweep::sweep;
use biela::kinematics::{Pose, Solver};
use biela::mechanism::{BodyId, Mechanism};

/// A picture whose parts are drawn once, in frames that move with the mechanism.
pub struct MovingPicture {
    scene: Scene,
    stage: Stage,
    /// The pose that the marks were drawn at.
    home: Vec<f64>,
}

impl MovingPicture {
    /// Returns the picture of a mechanism, drawn at the solver's pose, to which the solver returns;
    /// the solver may have more drivers. It has room for the motion of [`Scene::new`] and for
    /// `further` poses. Its scale is the one given \[units of the picture per metre\], or fits the
    /// motion.
    #[must_use]
    pub fn new(
        solver: &mut Solver,
        mechanism: &Mechanism,
        further: &[Vec<f64>],
        scale: Option<f64>,
    ) -> Self {
        let motion = sweep(solver);
        let Pose { q, parameters, .. } = solver.pose();
        let scene = Scene::along(mechanism, parameters, q, &motion, true);
        let poses: Vec<&[f64]> = std::iter::once(q)
            .chain(&motion)
            .chain(further)
            .map(Vec::as_slice)
            .collect();
        Self {
            stage: Stage::new(&scene, &poses, scale),
            home: q.clone(),
            scene,
        }
    }

    /// Returns the picture of a mechanism at rest at the pose q, \[m, m, rad\] per body, at a scale
    /// \[units of the picture per metre\]; without labels, whose places take the most time, if it is
    /// not `labelled`.
    #[must_use]
    pub fn still(
        mechanism: &Mechanism,
        parameters: &[f64],
        q: &[f64],
        scale: f64,
        labelled: bool,
    ) -> Self {
        let scene = Scene::along(mechanism, parameters, q, &[q.to_vec()], true);
        Self {
            stage: Stage::with_labels(&scene, &[q], Some(scale), labelled),
            home: q.to_vec(),
            scene,
        }
    }

    /// Returns the scale \[units of the picture per metre\].
    #[must_use]
    pub fn scale(&self) -> f64 {
        self.stage.scale
    }

    /// Returns a global point \[m\] in the picture, where y points down.
    #[must_use]
    pub fn place(&self, point: [f64; 2]) -> [f64; 2] {
        on_sheet(point.into(), self.stage.scale).into()
    }

    /// Returns the picture as SVG, and what a script needs to move its parts: the body of each
    /// attachment (`null` for none), labels, points with arrows, the scale.
    #[must_use]
    pub fn description(&self) -> Value {
        let home = self.stage.placements(&self.home);
        let bodies = self
            .stage
            .attachments
            .iter()
            .map(|a| body_of(a).map(BodyId::index));
        json!({
            "svg": picture(&self.scene, &self.home, &self.stage),
            "scale": self.stage.scale,
            "capitals": CAPITALS,
            "bodies": bodies.collect::<Vec<_>>(),
            "labels": labels(&self.stage, &home),
            "lengths": self.stage.lengths.len(),
            "points": tracked(&self.stage, &self.stage.points),
        })
    }

    /// Appends the places of all attachments at q, each x, y and angle \[deg\] in the picture, then
    /// the lengths of elastic lines.
    pub fn add_places(&self, q: &[f64], out: &mut Vec<f64>) {
        for attachment in &self.stage.attachments {
            let place = attachment.placement(q, self.stage.scale);
            out.extend([place.origin.x, place.origin.y, place.angle.to_degrees()]);
        }
        let lengths = self.stage.lengths.iter();
        out.extend(lengths.map(|length| length.value(q, self.stage.scale)));
    }

    /// Appends velocity \[m/s\] and acceleration \[m/s²\] of each point with arrows, for these rates
    /// of q: x to the right, y down.
    pub fn add_rates(&self, q: &[f64], of_q: [&[f64]; 2], out: &mut Vec<f64>) {
        for (_, anchor) in &self.stage.points {
            let [velocity, acceleration] = rates(*anchor, q, of_q);
            out.extend([velocity.x, -velocity.y, acceleration.x, -acceleration.y]);
        }
    }

    /// Returns the number of points with arrows.
    #[must_use]
    pub fn points(&self) -> usize {
        self.stage.points.len()
    }

    /// Returns the number of attachments and of lengths.
    #[must_use]
    pub fn parts(&self) -> [usize; 2] {
        [self.stage.attachments.len(), self.stage.lengths.len()]
    }
}

/// Returns the body that an attachment moves with.
fn body_of(attachment: &Attachment) -> Option<BodyId> {
    let of = |anchor: &Anchor| anchor.body;
    match attachment {
        Attachment::Ground => None,
        Attachment::Body(body) => Some(*body),
        Attachment::Point(at) | Attachment::Turned { at, .. } => of(at),
        Attachment::Line { line, .. } => line.points.iter().find_map(of),
    }
}
