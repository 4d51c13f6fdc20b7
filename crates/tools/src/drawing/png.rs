//! A sheet as PNG.

use std::io::Write;

use flate2::write::ZlibEncoder;
use flate2::{Compression, Crc};
use tiny_skia::{
    FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, StrokeDash, Transform,
};

use super::outline::{Outline, Segment};
use super::palette::Colour;
use super::sheet::{CAPITALS, Mark, Sheet, Text};
use super::stencil;

/// Width of the strokes of letters.
const LETTER_STROKE: f64 = 1.15;

/// Most pixels along a side of a picture.
pub const MOST_PIXELS: u32 = 16_384;

/// Returns the drawing as a PNG file `width` pixels wide, on white or transparent; `None` for a
/// picture without pixels or with more than [`MOST_PIXELS`] along a side.
///
/// Letters are made of strokes: the same drawing gives the same bytes on all machines.
#[must_use]
pub fn write(sheet: &Sheet, width: u32, transparent: bool) -> Option<Vec<u8>> {
    let scale = f64::from(width) / sheet.width;
    let height = (scale * sheet.height).round() as u32;
    if width.max(height) > MOST_PIXELS {
        return None;
    }
    let mut canvas = Canvas::new([width, height], [0.0; 2], scale)?;
    if !transparent {
        canvas.clear();
    }
    for mark in &sheet.marks {
        canvas.draw(mark);
    }
    for text in &sheet.texts {
        canvas.write(text);
    }
    Some(encode(&canvas.pixels))
}

/// Pixels on which marks and texts are drawn.
pub(super) struct Canvas {
    pixels: Pixmap,
    transform: Transform,
}

impl Canvas {
    /// Returns a transparent canvas of this width and height, which shows a sheet from its `corner`
    /// on, with `scale` pixels per unit; `None` without pixels.
    pub(super) fn new([width, height]: [u32; 2], [x, y]: [f64; 2], scale: f64) -> Option<Self> {
        let transform = Transform::from_translate(-x as f32, -y as f32);
        Some(Self {
            pixels: Pixmap::new(width, height)?,
            transform: transform.post_scale(scale as f32, scale as f32),
        })
    }

    /// Makes the canvas white.
    pub(super) fn clear(&mut self) {
        self.pixels.fill(tiny_skia::Color::WHITE);
    }

    /// Draws a line or an area.
    pub(super) fn draw(&mut self, mark: &Mark) {
        // An outline without extent has no path.
        let Some(path) = path(&mark.outline) else {
            return;
        };
        if let Some((colour, opacity)) = mark.fill {
            let paint = paint(colour, opacity);
            (self.pixels).fill_path(&path, &paint, FillRule::Winding, self.transform, None);
        }
        if let Some(stroke) = mark.stroke {
            let dashes = stroke.dashes.iter().map(|length| *length as f32).collect();
            let paint = paint(stroke.colour, 1.0);
            let style = style(stroke.width, StrokeDash::new(dashes, 0.0));
            (self.pixels).stroke_path(&path, &paint, &style, self.transform, None);
        }
    }

    /// Writes a text.
    pub(super) fn write(&mut self, text: &Text) {
        if let Some(path) = path(&stencil::strokes(&text.content, text.start, CAPITALS)) {
            let (paint, style) = (paint(text.colour, 1.0), style(LETTER_STROKE, None));
            (self.pixels).stroke_path(&path, &paint, &style, self.transform, None);
        }
    }

    /// Returns red, green and blue of each pixel, row by row.
    pub(super) fn colours(&self) -> impl Iterator<Item = [u8; 3]> {
        let pixels = self.pixels.pixels().iter();
        pixels.map(|pixel| [pixel.red(), pixel.green(), pixel.blue()])
    }
}

/// Returns the pixels as a PNG file: 8 bits per channel with opacity, each row as its difference
/// from the row above, which compresses lines and empty paper well.
fn encode(pixels: &Pixmap) -> Vec<u8> {
    const UP: u8 = 2;
    let row_length = 4 * pixels.width() as usize;
    let mut above = vec![0_u8; row_length];
    let mut packed = ZlibEncoder::new(Vec::new(), Compression::default());
    let mut line = Vec::with_capacity(row_length + 1);
    for row in pixels.pixels().chunks_exact(pixels.width() as usize) {
        let straight: Vec<u8> = row
            .iter()
            .map(|pixel| pixel.demultiply())
            .flat_map(|c| [c.red(), c.green(), c.blue(), c.alpha()])
            .collect();
        line.clear();
        line.push(UP);
        line.extend(straight.iter().zip(&above).map(|(x, b)| x.wrapping_sub(*b)));
        packed
            .write_all(&line)
            .expect("writing to memory does not fail");
        above = straight;
    }
    let data = packed.finish().expect("writing to memory does not fail");
    let mut header = Vec::new();
    header.extend(pixels.width().to_be_bytes());
    header.extend(pixels.height().to_be_bytes());
    // Bits per channel; red, green, blue, opacity; the only compression, filters, no interlacing.
    header.extend([8, 6, 0, 0, 0]);
    let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
    for (kind, content) in [(b"IHDR", &header), (b"IDAT", &data), (b"IEND", &Vec::new())] {
        let mut checked = kind.to_vec();
        checked.extend_from_slice(content);
        let mut sum = Crc::new();
        sum.update(&checked);
        // At most `MOST_PIXELS` squared pixels: far less than the format's 2 GiB.
        file.extend((content.len() as u32).to_be_bytes());
        file.extend(checked);
        file.extend(sum.sum().to_be_bytes());
    }
    file
}

/// Returns a stroke with round corners, and with round ends unless it has dashes.
fn style(width: f64, dash: Option<StrokeDash>) -> Stroke {
    let line_cap = match dash {
        Some(_) => LineCap::Butt,
        None => LineCap::Round,
    };
    Stroke {
        width: width as f32,
        line_cap,
        line_join: LineJoin::Round,
        dash,
        ..Stroke::default()
    }
}

fn paint(colour: Colour, opacity: f64) -> Paint<'static> {
    let Colour([red, green, blue]) = colour;
    let mut paint = Paint::default();
    paint.set_color_rgba8(red, green, blue, (255.0 * opacity).round() as u8);
    paint
}

fn path(outline: &Outline) -> Option<Path> {
    let mut path = PathBuilder::new();
    for segment in &outline.0 {
        match segment {
            Segment::Move(to) => path.move_to(to.x as f32, to.y as f32),
            Segment::Line(to) => path.line_to(to.x as f32, to.y as f32),
            Segment::Curve([c, d, to]) => path.cubic_to(
                c.x as f32,
                c.y as f32,
                d.x as f32,
                d.y as f32,
                to.x as f32,
                to.y as f32,
            ),
            Segment::Close => path.close(),
        }
    }
    path.finish()
}
