//! A moving picture as an SVG that plays by itself, without a script: for pages, slides and
//! readmes.

use super::Animation;
use super::picture::groups;
use super::stage::Stage;
use crate::drawing::attachment::Placement;
use crate::drawing::label::Placed;
use crate::drawing::lettering::FONT_SIZE;
use crate::drawing::outline::Point;
use crate::drawing::palette::Colour;
use crate::drawing::sheet::{Bounds, CAPITALS, Mark};
use crate::drawing::svg::{FONTS, escape, fitted_text, number, path_data};

/// Most moments: of more, every second, third and so on is shown.
const MOST_MOMENTS: usize = 240;
/// Shortest duration of a round \[s\]: a faster motion is slowed down.
const SHORTEST: f64 = 2.0;
/// Distance on the sheet, and angle in degrees, within which the end of a motion is its start.
const BACK: f64 = 0.5;
/// Height of a line of letters over that of capitals.
const LINE: f64 = 1.4;
/// Usual width of the picture in pixels.
const WIDTH: f64 = 640.0;

/// Returns a picture that moves: an SVG document in which bodies and labels follow the motion in
/// real time, at least two seconds long, again and again. A motion that does not return to its
/// start runs there and back.
///
/// The same animation gives the same bytes.
#[must_use]
pub fn moving_svg(animation: &Animation) -> String {
    let every = animation.moments.len().div_ceil(MOST_MOMENTS).max(1);
    let shown = animation.moments.iter().step_by(every);
    let poses: Vec<&[f64]> = shown.map(|moment| moment.q.as_slice()).collect();
    let stage = Stage::new(&animation.scene, &poses, None);
    let film = Film::new(&stage, &poses, animation.clock.stop - animation.clock.start);
    let home = poses.first().copied().unwrap_or_default();

    let [corner, size] = stage.view;
    let [x, y, w, h] = [corner.x, corner.y, size.x, size.y].map(number);
    let [width, height] = [WIDTH, WIDTH * size.y / size.x].map(number);
    let (name, description) = (&animation.scene.name, &animation.scene.description);
    let mut svg = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" width=\"{width}\" \
         height=\"{height}\" viewBox=\"{x} {y} {w} {h}\" role=\"img\">\n\
         <title>{}</title>\n<desc>{}</desc>\n\
         <rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" fill=\"{}\"/>\n",
        escape(name),
        escape(description),
        Colour::WHITE.hex()
    );
    let covered = film.covered();
    let moving = |attachment| [String::new(), film.transform(attachment)];
    let changing = |mark: &Mark| [String::new(), film.elastic(mark)];
    svg += &groups(home, &stage, &moving, &changing);
    let font = number(CAPITALS * FONT_SIZE);
    svg += &format!("<g font-family=\"{FONTS}\" font-size=\"{font}\">\n");
    for ((attachment, label), covered) in stage.labels.iter().zip(&covered) {
        let moves = film.label(*attachment, label) + &film.hiding(covered);
        svg += &fitted_text(&label.text).replace("</text>", &format!("{moves}</text>\n"));
    }
    svg += &fitted_text(&stage.scale_text);
    svg + "\n</g>\n</svg>\n"
}

/// The motion of all frames.
pub(super) struct Film<'a> {
    stage: &'a Stage,
    /// The poses of a round; of a motion that does not return, also those of the way back.
    pub(super) poses: Vec<&'a [f64]>,
    /// The placements of all frames at each pose.
    pub(super) placements: Vec<Vec<Placement>>,
    /// Duration of a round \[s\].
    pub(super) duration: f64,
}

impl<'a> Film<'a> {
    /// Returns a round of a motion that takes `duration` from its first pose to its last.
    pub(super) fn new(stage: &'a Stage, poses: &[&'a [f64]], duration: f64) -> Self {
        let placements = |q: &&[f64]| stage.placements(q);
        let (first, last) = (poses.first().map(placements), poses.last().map(placements));
        let is_back = first.zip(last).is_some_and(|(first, last)| {
            first.iter().zip(&last).all(|(first, last)| {
                let turned = (last.angle - first.angle).to_degrees();
                let whole = (turned / 360.0).round() * 360.0;
                (last.origin - first.origin).norm() < BACK && (turned - whole).abs() < BACK
            })
        });
        let mut poses = poses.to_vec();
        let mut duration = duration;
        if !is_back {
            let back: Vec<&[f64]> = poses.iter().rev().skip(1).copied().collect();
            poses.extend(back);
            duration *= 2.0;
        }
        let placements = poses.iter().map(|q| stage.placements(q)).collect();
        let duration = duration.max(SHORTEST);
        Self {
            stage,
            poses,
            placements,
            duration,
        }
    }

    /// Returns the attributes of every animation.
    fn clock(&self) -> String {
        let duration = number(self.duration);
        format!("dur=\"{duration}s\" repeatCount=\"indefinite\"")
    }

    /// Returns the animations of a frame, which replace its place at the first moment.
    fn transform(&self, attachment: usize) -> String {
        let places = || self.placements.iter().map(|places| &places[attachment]);
        let origins = places().map(|place| pair(place.origin));
        let mut turned = 0.0_f64;
        let mut before: Option<f64> = None;
        let angles = places().map(|place| {
            // Angles count turns: a frame never turns back between two moments.
            let angle = place.angle.to_degrees();
            if let Some(before) = before {
                turned += (before - angle + 180.0).div_euclid(360.0) * 360.0;
            }
            before = Some(angle);
            number(angle + turned)
        });
        let [origins, angles] = [changes(origins), changes(angles)];
        if origins.len() == 1 && angles.len() == 1 {
            return String::new();
        }
        self.animate("translate", &origins, "replace") + &self.animate("rotate", &angles, "sum")
    }

    /// Returns the animation of a line whose length changes.
    fn elastic(&self, mark: &Mark) -> String {
        let Some(elastic) = &mark.elastic else {
            return String::new();
        };
        let outlines = self
            .poses
            .iter()
            .map(|q| elastic.outline(q, self.stage.scale));
        let values = outlines.map(|outline| path_data(&outline));
        let values = values.collect::<Vec<_>>().join(";");
        format!(
            "<animate attributeName=\"d\" values=\"{values}\" {}/>",
            self.clock()
        )
    }

    /// Returns the middle of a label at a moment.
    pub(super) fn center(&self, attachment: usize, label: &Placed, places: &[Placement]) -> Point {
        label.center([&self.placements[0], places].map(|places| places[attachment]))
    }

    /// Returns for each label whether it would be over an earlier one at each moment.
    pub(super) fn covered(&self) -> Vec<Vec<bool>> {
        let labels = &self.stage.labels;
        let mut covered = vec![Vec::with_capacity(self.placements.len()); labels.len()];
        for places in &self.placements {
            let mut seen: Vec<Bounds> = Vec::with_capacity(labels.len());
            for ((attachment, label), covered) in labels.iter().zip(&mut covered) {
                let size = Point::new(label.text.width(), LINE * CAPITALS);
                let bounds = Bounds::about(self.center(*attachment, label, places), size);
                let is_covered = seen.iter().any(|other| other.overlap(&bounds) > 0.0);
                covered.push(is_covered);
                if !is_covered {
                    seen.push(bounds);
                }
            }
        }
        covered
    }

    /// Returns the animation of a label that is hidden while it is covered.
    fn hiding(&self, covered: &[bool]) -> String {
        let changes = covered.iter().enumerate();
        let changes = changes.filter(|(k, now)| *k == 0 || covered[k - 1] != **now);
        let (values, times): (Vec<&str>, Vec<String>) = changes
            .map(|(moment, covered)| {
                let value = if *covered { "hidden" } else { "visible" };
                // A place lasts until the next one, the last one for no time.
                let time = moment as f64 / (self.placements.len().max(2) - 1) as f64;
                (value, format!("{time:.4}"))
            })
            .unzip();
        if values == ["visible"] {
            return String::new();
        }
        let (values, times) = (values.join(";"), times.join(";"));
        format!(
            "<animate attributeName=\"visibility\" calcMode=\"discrete\" values=\"{values}\" \
             keyTimes=\"{times}\" {}/>",
            self.clock()
        )
    }

    /// Returns the animation of a label, from its place at the first moment.
    fn label(&self, attachment: usize, label: &Placed) -> String {
        let home = self.center(attachment, label, &self.placements[0]);
        let places = (self.placements.iter())
            .map(|places| pair(self.center(attachment, label, places) - home));
        match &changes(places)[..] {
            [_] => String::new(),
            places => self.animate("translate", places, "replace"),
        }
    }

    /// Returns the animation of a transformation.
    fn animate(&self, kind: &str, values: &[String], additive: &str) -> String {
        let values = values.join(";");
        format!(
            "<animateTransform attributeName=\"transform\" type=\"{kind}\" additive=\"{additive}\" \
             values=\"{values}\" {}/>",
            self.clock()
        )
    }
}

/// Returns the values of all moments, or one if they are the same.
fn changes(values: impl Iterator<Item = String>) -> Vec<String> {
    let mut values: Vec<String> = values.collect();
    if values.windows(2).all(|pair| pair[0] == pair[1]) {
        values.truncate(1);
    }
    values
}

fn pair(point: Point) -> String {
    format!("{} {}", number(point.x), number(point.y))
}
