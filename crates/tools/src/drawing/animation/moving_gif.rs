//! A moving picture as GIF, for slides and messages that show no SVG.

use std::borrow::Cow;

use gif::{Encoder, Frame, Repeat};

use super::Animation;
use super::moving_svg::Film;
use super::stage::Stage;
use crate::drawing::outline::Point;
use crate::drawing::png::Canvas;
use crate::drawing::sheet::{Layer, Mark, Text};

/// Width of the picture in pixels.
const WIDTH: u32 = 640;
/// Largest height of the picture in pixels: a higher one is narrower.
const HIGHEST: f64 = 900.0;
/// Most pictures of one way of the motion.
const MOST_MOMENTS: usize = 150;
/// Shortest time between two pictures \[s\]: browsers slow down what is faster than 20 ms.
const SHORTEST: f64 = 0.04;
/// Hundredths of a second, the format's unit of time, in a second.
const HUNDREDTHS: f64 = 100.0;
/// Colours of the palette, the most of the format.
const COLOURS: usize = 256;
/// Proof that writing succeeds.
const IN_MEMORY: &str = "writing to memory does not fail";
/// Bits of a channel by which colours are counted.
const BITS: u32 = 5;

/// Returns a picture that moves in real time, at least two seconds long, again and again, as
/// [`moving_svg`](super::moving_svg) does.
///
/// The same animation gives the same bytes.
#[must_use]
pub fn moving_gif(animation: &Animation) -> Vec<u8> {
    let duration = animation.clock.stop - animation.clock.start;
    let most = ((duration.max(2.0) / SHORTEST) as usize).clamp(1, MOST_MOMENTS);
    let every = animation.moments.len().div_ceil(most).max(1);
    let shown = animation.moments.iter().step_by(every);
    let poses: Vec<&[f64]> = shown.map(|moment| moment.q.as_slice()).collect();
    let stage = Stage::new(&animation.scene, &poses, None);
    let film = Film::new(&stage, &poses, duration);
    let [corner, size] = stage.view;
    let scale = (f64::from(WIDTH) / size.x).min(HIGHEST / size.y);
    let pixels = [size.x, size.y].map(|length| ((scale * length).round() as u32).max(1));
    let mut canvas = Canvas::new(pixels, corner.into(), scale).expect("it has pixels");
    let covered = film.covered();
    let mut pictures = Vec::new();
    // The end of a round is its start.
    let count = film.poses.len().saturating_sub(1).max(1);
    for moment in 0..count {
        draw(&mut canvas, &stage, &film, moment, &covered);
        pictures.push(canvas.colours().collect::<Vec<_>>());
    }
    let palette = Palette::of(&pictures);
    write(&pictures, &palette, pixels, film.duration)
}

/// Draws a moment of a film.
fn draw(canvas: &mut Canvas, stage: &Stage, film: &Film, moment: usize, covered: &[Vec<bool>]) {
    let (q, placements) = (film.poses[moment], &film.placements[moment]);
    canvas.clear();
    for (layer, _) in Layer::ALL {
        for (attachment, mark) in stage.marks.iter().filter(|(_, mark)| mark.layer == layer) {
            let outline = match &mark.elastic {
                Some(elastic) => elastic.outline(q, stage.scale),
                None => mark.outline.clone(),
            };
            canvas.draw(&Mark {
                outline: outline.map(|point| placements[*attachment].outside(point)),
                ..mark.clone()
            });
        }
    }
    for ((attachment, label), covered) in stage.labels.iter().zip(covered) {
        if !covered[moment] {
            let (center, size) = (
                film.center(*attachment, label, placements),
                label.text.size(),
            );
            canvas.write(&Text {
                start: center + Point::new(-0.5 * size.x, 0.5 * size.y),
                ..label.text.clone()
            });
        }
    }
    canvas.write(&stage.scale_text);
}

/// Writes pictures whose pixels are of a palette; of each the part that differs from the one before.
fn write(
    pictures: &[Vec<[u8; 3]>],
    palette: &Palette,
    [width, height]: [u32; 2],
    duration: f64,
) -> Vec<u8> {
    // At most `WIDTH` and `HIGHEST`.
    let [width, height] = [width, height].map(|side| side as u16);
    let mut file = Vec::new();
    let colours: Vec<u8> = palette.colours.concat();
    let mut encoder = Encoder::new(&mut file, width, height, &colours).expect(IN_MEMORY);
    encoder.set_repeat(Repeat::Infinite).expect(IN_MEMORY);
    let mut before: Option<Vec<u8>> = None;
    for (number, picture) in pictures.iter().enumerate() {
        let indices: Vec<u8> = picture.iter().map(|c| palette.index(*c)).collect();
        // Rounding of one delay does not add to the next.
        let time =
            |number: usize| (HUNDREDTHS * duration * number as f64 / pictures.len() as f64).round();
        let [low, high] = changed(
            before.as_deref(),
            &indices,
            [width, height].map(usize::from),
        );
        let rows = (low[1]..high[1]).map(|y| y * usize::from(width));
        let part: Vec<u8> = rows
            .flat_map(|row| indices[row + low[0]..row + high[0]].iter().copied())
            .collect();
        let [left, top, part_width, part_height] =
            [low[0], low[1], high[0] - low[0], high[1] - low[1]].map(|side| side as u16);
        let frame = Frame {
            delay: (time(number + 1) - time(number)) as u16,
            left,
            top,
            width: part_width,
            height: part_height,
            buffer: Cow::Owned(part),
            ..Frame::default()
        };
        encoder.write_frame(&frame).expect(IN_MEMORY);
        before = Some(indices);
    }
    drop(encoder);
    file
}

/// Returns the corners of the part of a picture that differs from the one before: at least a pixel.
fn changed(before: Option<&[u8]>, now: &[u8], [width, height]: [usize; 2]) -> [[usize; 2]; 2] {
    let Some(before) = before else {
        return [[0, 0], [width, height]];
    };
    let (mut low, mut high) = ([width, height], [0, 0]);
    let pairs = before.iter().zip(now).enumerate();
    for (at, _) in pairs.filter(|(_, (a, b))| a != b) {
        let place = [at % width, at / width];
        for axis in 0..2 {
            low[axis] = low[axis].min(place[axis]);
            high[axis] = high[axis].max(place[axis] + 1);
        }
    }
    if high == [0, 0] {
        return [[0, 0], [1, 1]];
    }
    [low, high]
}

/// The colours that most pixels have.
struct Palette {
    colours: Vec<[u8; 3]>,
    /// The index in the palette for each class of colours.
    indices: Vec<u8>,
}

impl Palette {
    fn of(pictures: &[Vec<[u8; 3]>]) -> Self {
        let classes = 1 << (3 * BITS);
        let mut counts = vec![0_u64; classes];
        let mut sums = vec![[0_u64; 3]; classes];
        for colour in pictures.iter().flatten() {
            let class = class(*colour);
            counts[class] += 1;
            for (sum, channel) in sums[class].iter_mut().zip(colour) {
                *sum += u64::from(*channel);
            }
        }
        let mut used: Vec<usize> = (0..classes).filter(|class| counts[*class] > 0).collect();
        used.sort_by_key(|class| std::cmp::Reverse(counts[*class]));
        let mean = |class: usize| sums[class].map(|sum| (sum / counts[class]) as u8);
        let colours: Vec<[u8; 3]> = used
            .iter()
            .take(COLOURS)
            .map(|class| mean(*class))
            .collect();
        let mut indices = vec![0; classes];
        for class in used {
            let wanted = mean(class);
            let apart = |colour: &[u8; 3]| -> u32 {
                let channels = colour.iter().zip(wanted);
                channels.map(|(a, b)| u32::from(a.abs_diff(b)).pow(2)).sum()
            };
            let nearest = (0..colours.len()).min_by_key(|index| apart(&colours[*index]));
            indices[class] = nearest.unwrap_or(0) as u8;
        }
        Self { colours, indices }
    }

    fn index(&self, colour: [u8; 3]) -> u8 {
        self.indices[class(colour)]
    }
}

/// Returns the class of a colour: its channels without their last bits.
fn class(colour: [u8; 3]) -> usize {
    colour.iter().fold(0, |class, channel| {
        (class << BITS) | usize::from(channel >> (8 - BITS))
    })
}
