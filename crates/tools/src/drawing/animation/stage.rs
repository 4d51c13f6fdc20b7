//! The marks and labels of a moving picture, and the frames that they move with.

use crate::drawing::anchor::Anchor;
use crate::drawing::attachment::{Attachment, Measure, Placement};
use crate::drawing::label::Placed;
use crate::drawing::layout::{extent, fitting, scale_bar, size};
use crate::drawing::outline::{Point, convex_hull};
use crate::drawing::scene::Scene;
use crate::drawing::sheet::{Bounds, MARGIN, Mark, Text, WIDTH};
use crate::drawing::symbol::{OtherPoses, Pen, Symbol};

/// Poses that decide how much room the motion needs.
const SAMPLES: usize = 120;
/// Poses that decide where the labels are.
const LABEL_SAMPLES: usize = 12;
/// Room around the mechanism for its symbols and names.
const AROUND: f64 = 46.0;
/// Most points with arrows for their rates: more arrows would hide each other.
const MOST_POINTS: usize = 24;

/// All that a moving picture draws.
pub(super) struct Stage {
    /// Units of the sheet per metre.
    pub(super) scale: f64,
    /// Upper left corner and size of the visible part of the sheet.
    pub(super) view: [Point; 2],
    /// The frames that move; the first one is ground.
    pub(super) attachments: Vec<Attachment>,
    /// Marks in the frames of their attachments; later marks cover earlier ones.
    pub(super) marks: Vec<(usize, Mark)>,
    /// Labels with their attachments.
    pub(super) labels: Vec<(usize, Placed)>,
    /// Lengths that elastic marks depend on.
    pub(super) lengths: Vec<Measure>,
    /// Points whose rates are shown by arrows, with their attachments.
    pub(super) points: Vec<(usize, Anchor)>,
    /// The text beside the bar that shows the scale.
    pub(super) scale_text: Text,
}

impl Stage {
    /// Returns the stage for a motion along poses, at whose first one the marks take their shape.
    /// Its scale, in units of the sheet per metre, is the one given, or fits the motion.
    pub(super) fn new(scene: &Scene, poses: &[&[f64]], scale: Option<f64>) -> Self {
        Self::with_labels(scene, poses, scale, true)
    }

    /// Returns the stage, without labels if it is not `labelled`.
    pub(super) fn with_labels(
        scene: &Scene,
        poses: &[&[f64]],
        scale: Option<f64>,
        labelled: bool,
    ) -> Self {
        let every = poses.len().div_ceil(SAMPLES).max(1);
        let sampled = || poses.iter().step_by(every).copied();
        let q = poses.first().map_or(&[][..], |q| *q);
        let scale = scale.unwrap_or_else(|| {
            let extent = extent(scene, sampled());
            let room = size(scene, q, extent, WIDTH) - Point::repeat(2.0 * (MARGIN + AROUND));
            fitting(room, extent)
        });

        let each = poses.len().div_ceil(LABEL_SAMPLES).max(1);
        let further: Vec<&[f64]> = poses.iter().step_by(each).skip(1).copied().collect();
        let others = if labelled {
            OtherPoses::Motion(&further)
        } else {
            OtherPoses::Glimpse
        };
        let (mut marks, labels) = Pen::draw(&scene.symbols, &scene.bodies, q, scale, others);
        marks.sort_by_key(|mark| mark.layer);
        let mut attachments = vec![Attachment::Ground];
        let mut lengths = Vec::new();
        let marks = (marks.into_iter())
            .map(|mut mark| {
                let home = mark.attachment.placement(q, scale);
                mark.outline = mark.outline.map(|point| home.inside(point));
                if let Some(elastic) = &mark.elastic {
                    index_in(&mut lengths, elastic.measure);
                }
                (index_in(&mut attachments, mark.attachment), mark)
            })
            .collect();
        let labels = (labels.into_iter())
            .map(|label| (index_in(&mut attachments, label.attachment), label))
            .collect();
        let points = points(&mut attachments, scene, poses);
        let mut stage = Self {
            scale,
            view: [Point::zeros(); 2],
            attachments,
            marks,
            labels,
            lengths,
            points,
            scale_text: scale_bar(Point::zeros(), scale, None).1,
        };
        stage.frame(q, sampled());
        stage
    }

    /// Finds the visible part over the motion, and puts the scale below it.
    fn frame<'a>(&mut self, home: &[f64], poses: impl Iterator<Item = &'a [f64]>) {
        let mut corners: Vec<Vec<Point>> = vec![Vec::new(); self.attachments.len()];
        for (attachment, mark) in &self.marks {
            if mark.elastic.is_none() {
                corners[*attachment].extend(mark.outline.flattened().into_iter().flatten());
            }
        }
        for corners in &mut corners {
            *corners = convex_hull(corners);
        }
        let homes: Vec<Placement> = self.placements(home);
        let mut bounds = Bounds::NONE;
        for q in poses {
            let placements = self.placements(q);
            for (placement, corners) in placements.iter().zip(&corners) {
                for corner in corners {
                    bounds.add(placement.outside(*corner));
                }
            }
            for (attachment, mark) in &self.marks {
                let Some(elastic) = &mark.elastic else {
                    continue;
                };
                for point in elastic
                    .outline(q, self.scale)
                    .flattened()
                    .into_iter()
                    .flatten()
                {
                    bounds.add(placements[*attachment].outside(point));
                }
            }
            for (attachment, label) in &self.labels {
                let center = label.center([homes[*attachment], placements[*attachment]]);
                bounds.join(&Bounds::about(center, label.text.size()));
            }
        }
        let corner = Point::new(bounds.low.x, bounds.high.y + 16.0);
        let (bar, text) = scale_bar(corner, self.scale, None);
        for point in bar.outline.flattened().into_iter().flatten() {
            bounds.add(point);
        }
        bounds.add(text.start + Point::new(text.width(), 0.0));
        self.marks.push((0, bar));
        self.scale_text = text;
        let margin = Point::repeat(MARGIN);
        self.view = [bounds.low - margin, bounds.size() + 2.0 * margin];
    }

    /// Returns the index of the frame that an anchor moves with, which is added if it is new.
    pub(super) fn attach(&mut self, anchor: Anchor) -> usize {
        index_in(&mut self.attachments, Attachment::of(anchor))
    }

    /// Returns the places of all attachments at q.
    pub(super) fn placements(&self, q: &[f64]) -> Vec<Placement> {
        let attachments = self.attachments.iter();
        attachments.map(|a| a.placement(q, self.scale)).collect()
    }
}

/// Returns the index of an item in a list, to which it is added if it is new. The items of a body
/// come one after the other: the search begins at the last ones.
fn index_in<T: PartialEq>(list: &mut Vec<T>, item: T) -> usize {
    let known = list.iter().rposition(|known| *known == item);
    known.unwrap_or_else(|| {
        list.push(item);
        list.len() - 1
    })
}

/// Returns the points of interest and the moving joints, each place once.
fn points(
    attachments: &mut Vec<Attachment>,
    scene: &Scene,
    poses: &[&[f64]],
) -> Vec<(usize, Anchor)> {
    let symbols = &scene.symbols;
    let is_named = |symbol: &&Symbol| matches!(symbol, Symbol::InterestPoint(_));
    let (named, others): (Vec<&Symbol>, Vec<&Symbol>) = symbols.iter().partition(is_named);
    let (Some(first), Some(middle)) = (poses.first(), poses.get(poses.len() / 3)) else {
        return Vec::new();
    };
    let places = |anchor: &Anchor| [first, middle].map(|q| anchor.placed(q).point);
    let mut points: Vec<(usize, Anchor)> = Vec::new();
    let mut known: Vec<[Point; 2]> = Vec::new();
    let symbols = named.into_iter().chain(others);
    for anchor in symbols.filter_map(|symbol| symbol.shape().tracked()) {
        let at = places(&anchor);
        let near = |other: &[Point; 2]| {
            let apart = (at[0] - other[0]).norm() + (at[1] - other[1]).norm();
            apart < 1e-9 * (1.0 + at[0].norm())
        };
        if anchor.body.is_some() && !known.iter().any(near) && points.len() < MOST_POINTS {
            known.push(at);
            points.push((index_in(attachments, Attachment::of(anchor)), anchor));
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use std::path::Path as FilePath;
    use std::sync::Arc;

    use super::*;
    use crate::drawing::sweep::sweep;
    use biela::kinematics::{Path, Solver};
    use biela::mechanism::{Mechanism, Source};

    /// Returns the scene of a shipped mechanism and the motion that its drawing shows as paths.
    fn shipped(file: &FilePath) -> (Scene, Vec<Vec<f64>>) {
        let source = Source::open("test".to_owned(), file).expect("it is shipped");
        let (mechanism, _) = Mechanism::parse(&source).expect("it is right");
        let mechanism = Arc::new(mechanism);
        let mut solver = Solver::new(Arc::clone(&mechanism)).expect("it is determined");
        solver.assemble(&Path::new(&mechanism)).expect("it closes");
        let motion = sweep(&mut solver);
        let (q, parameters) = (&solver.pose().q, &solver.pose().parameters);
        let scene = Scene::along(&mechanism, parameters, q, &motion, true);
        (scene, motion)
    }

    /// Returns the boxes of all labels at a pose.
    fn boxes(stage: &Stage, home: &[Placement], q: &[f64]) -> Vec<Bounds> {
        let placements = stage.placements(q);
        let labels = stage.labels.iter().map(|(attachment, label)| {
            let center = label.center([home[*attachment], placements[*attachment]]);
            Bounds::about(center, label.text.size())
        });
        labels.collect()
    }

    /// Largest part of the motion during which a label may be hidden because another one is there.
    const MOST: f64 = 0.05;

    #[test]
    fn labels_keep_apart_over_the_motion_of_every_mechanism() {
        let folder = FilePath::new(env!("CARGO_MANIFEST_DIR")).join("../../mechanisms");
        for entry in std::fs::read_dir(folder).expect("it is there") {
            let file = entry.expect("it can be read").path();
            if file.extension().is_none_or(|extension| extension != "toml") {
                continue;
            }
            let (scene, motion) = shipped(&file);
            let poses: Vec<&[f64]> = motion.iter().map(Vec::as_slice).collect();
            let stage = Stage::new(&scene, &poses, None);
            let home = stage.placements(poses[0]);
            let (mut covered, mut all) = (0, 0);
            for moment in poses.iter().step_by(12) {
                let boxes = boxes(&stage, &home, moment);
                for (index, label) in boxes.iter().enumerate() {
                    let is_covered = boxes[..index].iter().any(|b| b.overlap(label) > 0.0);
                    covered += usize::from(is_covered);
                    all += 1;
                }
            }
            let share = covered as f64 / f64::from(all.max(1) as u32);
            assert!(share < MOST, "{}: {share}", file.display());
        }
    }
}
