//! Lines, circles and texts of a drawing, blocks inserted.

use std::collections::{BTreeMap, HashMap};

use super::pairs::{Pair, pairs};
use crate::exchange::error::Error;

/// Deepest block within blocks.
const DEEPEST: usize = 8;

/// Most entities that insertions of blocks make.
const MOST: usize = 1 << 20;

/// A drawing, flat.
#[derive(Debug, Default)]
pub(super) struct Drawing {
    /// Code of the unit of length, 0 for none.
    pub(super) units: i64,
    /// Pieces of lines, polylines and arcs.
    pub(super) lines: Vec<Line>,
    pub(super) circles: Vec<Circle>,
    pub(super) texts: Vec<Text>,
    /// Numbers of entities that are not read, by kind.
    pub(super) others: BTreeMap<String, usize>,
}

#[derive(Clone, Debug)]
pub(super) struct Line {
    pub(super) layer: String,
    pub(super) ends: [[f64; 2]; 2],
}

#[derive(Clone, Debug)]
pub(super) struct Circle {
    pub(super) layer: String,
    pub(super) at: [f64; 2],
    pub(super) radius: f64,
}

#[derive(Clone, Debug)]
pub(super) struct Text {
    pub(super) at: [f64; 2],
    pub(super) height: f64,
    pub(super) text: String,
}

/// An entity with its pairs.
struct Entity<'a> {
    kind: &'a str,
    line: usize,
    pairs: Vec<Pair<'a>>,
}

impl<'a> Entity<'a> {
    fn first(&self, code: i32) -> Option<Pair<'a>> {
        self.pairs.iter().copied().find(|pair| pair.code == code)
    }

    fn number(&self, code: i32, otherwise: f64) -> Result<f64, Error> {
        self.first(code).map_or(Ok(otherwise), Pair::number)
    }

    fn point(&self, code: i32) -> Result<[f64; 2], Error> {
        let pair = |code, key| {
            let pair = self.first(code).ok_or_else(|| Error::Missing {
                line: self.line,
                place: format!("`{}`", crate::exchange::error::start_of(self.kind)),
                key,
            });
            pair.and_then(Pair::number)
        };
        let keys = if code == 10 {
            ["10", "20"]
        } else {
            ["11", "21"]
        };
        let [x, y] = [pair(code, keys[0])?, pair(code + 10, keys[1])?];
        Ok([x, y])
    }

    fn layer(&self) -> &'a str {
        self.first(8).map_or("0", |pair| pair.value)
    }

    /// Returns −1 if the entity lies mirrored, on the back of the drawing.
    fn side(&self) -> Result<f64, Error> {
        Ok(if self.number(230, 1.0)? < 0.0 {
            -1.0
        } else {
            1.0
        })
    }
}

/// An affine map of the plane, and the layer that layer 0 stands for.
#[derive(Clone, Copy)]
struct Placing<'a> {
    /// Images of the axes and of the origin.
    columns: [[f64; 2]; 3],
    layer: &'a str,
}

impl Placing<'_> {
    fn map(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [a, b, c] = self.columns;
        [a[0] * x + b[0] * y + c[0], a[1] * x + b[1] * y + c[1]]
    }

    fn scale(&self) -> f64 {
        let [a, b, _] = self.columns;
        (a[0] * b[1] - a[1] * b[0]).abs().sqrt()
    }
}

impl Drawing {
    pub(super) fn read(text: &str) -> Result<Self, Error> {
        let mut drawing = Self::default();
        let mut blocks: HashMap<&str, Vec<Entity>> = HashMap::new();
        let mut own: Vec<Entity> = Vec::new();
        let mut section = "";
        let mut block = "";
        let mut is_units = false;
        // The entity that pairs belong to.
        let mut open: Option<Entity> = None;
        let mut ended = false;
        for pair in pairs(text) {
            let pair = pair?;
            if pair.code != 0 {
                match (section, pair.code) {
                    ("", 2) => section = pair.value,
                    ("HEADER", 9) => is_units = pair.value == "$INSUNITS",
                    ("HEADER", 70) if is_units => drawing.units = pair.number()? as i64,
                    _ => {
                        if let Some(entity) = &mut open {
                            entity.pairs.push(pair);
                        }
                    }
                }
                continue;
            }
            if let Some(entity) = open.take() {
                match (section, entity.kind) {
                    ("BLOCKS", "BLOCK") => block = entity.first(2).map_or("", |pair| pair.value),
                    ("BLOCKS", _) => blocks.entry(block).or_default().push(entity),
                    _ => own.push(entity),
                }
            }
            match pair.value {
                "SECTION" | "ENDSEC" => section = "",
                "ENDBLK" => block = "",
                "EOF" => {
                    ended = true;
                    break;
                }
                kind if section == "ENTITIES" || section == "BLOCKS" => {
                    open = Some(Entity {
                        kind,
                        line: pair.line,
                        pairs: Vec::new(),
                    });
                }
                _ => {}
            }
        }
        if !ended {
            let line = text.lines().count();
            let last = text.lines().next_back().unwrap_or_default().trim();
            return Err(Error::unexpected(
                line,
                last,
                "`EOF`, the end of the drawing",
            ));
        }
        let placing = Placing {
            columns: [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]],
            layer: "0",
        };
        drawing.add(&own, &blocks, placing, 0)?;
        Ok(drawing)
    }

    /// Returns the drawing with all lengths times a factor.
    pub(super) fn scaled(mut self, factor: f64) -> Self {
        let scale = |at: &mut [f64; 2]| *at = at.map(|x| x * factor);
        for line in &mut self.lines {
            line.ends.iter_mut().for_each(scale);
        }
        for circle in &mut self.circles {
            scale(&mut circle.at);
            circle.radius *= factor;
        }
        for text in &mut self.texts {
            scale(&mut text.at);
            text.height *= factor;
        }
        self
    }

    fn add(
        &mut self,
        entities: &[Entity],
        blocks: &HashMap<&str, Vec<Entity>>,
        placing: Placing,
        depth: usize,
    ) -> Result<(), Error> {
        let mut vertices: Option<(Vec<[f64; 2]>, bool, &str)> = None;
        for entity in entities {
            if self.lines.len() + self.circles.len() + self.texts.len() > MOST {
                return Err(Error::TooLong);
            }
            let layer = match entity.layer() {
                "0" => placing.layer,
                layer => layer,
            };
            let side = entity.side()?;
            let place = |[x, y]: [f64; 2]| placing.map([side * x, y]);
            match entity.kind {
                // Its points are those of the drawing, on whichever side it lies.
                "LINE" => {
                    let ends = [entity.point(10)?, entity.point(11)?].map(|at| placing.map(at));
                    self.add_line(layer, ends);
                }
                "CIRCLE" => self.circles.push(Circle {
                    layer: layer.to_owned(),
                    at: place(entity.point(10)?),
                    radius: entity.number(40, 0.0)?.abs() * placing.scale(),
                }),
                "ARC" => {
                    let ([x, y], radius) = (entity.point(10)?, entity.number(40, 0.0)?);
                    let ends = [entity.number(50, 0.0)?, entity.number(51, 0.0)?];
                    let ends = ends.map(|angle| {
                        let (sin, cos) = angle.to_radians().sin_cos();
                        place([x + radius * cos, y + radius * sin])
                    });
                    self.add_line(layer, ends);
                }
                "LWPOLYLINE" => {
                    let closed = entity.number(70, 0.0)? as i64 & 1 == 1;
                    let [xs, ys] = [10, 20].map(|code| {
                        let pairs = entity.pairs.iter().filter(move |pair| pair.code == code);
                        pairs
                            .map(|pair| pair.number())
                            .collect::<Result<Vec<f64>, Error>>()
                    });
                    let at: Vec<_> = xs?
                        .into_iter()
                        .zip(ys?)
                        .map(|(x, y)| place([x, y]))
                        .collect();
                    self.add_polyline(layer, &at, closed);
                }
                "POLYLINE" => {
                    let closed = entity.number(70, 0.0)? as i64 & 1 == 1;
                    vertices = Some((Vec::new(), closed, layer));
                }
                "VERTEX" => {
                    if let Some((at, ..)) = &mut vertices {
                        at.push(place(entity.point(10)?));
                    }
                }
                "SEQEND" => {
                    if let Some((at, closed, layer)) = vertices.take() {
                        self.add_polyline(layer, &at, closed);
                    }
                }
                "TEXT" | "MTEXT" => self.texts.push(Text {
                    at: place(entity.point(10)?),
                    height: entity.number(40, 0.0)?.abs() * placing.scale(),
                    text: entity.first(1).map_or("", |pair| pair.value).to_owned(),
                }),
                "INSERT" => {
                    if depth == DEEPEST {
                        return Err(Error::TooDeep { line: entity.line });
                    }
                    let name = entity.first(2).map_or("", |pair| pair.value);
                    let inner = inserted(entity, placing, layer, side)?;
                    if let Some(block) = blocks.get(name) {
                        self.add(block, blocks, inner, depth + 1)?;
                    }
                }
                kind => {
                    let kind = crate::exchange::error::start_of(kind);
                    *self.others.entry(kind).or_default() += 1;
                }
            }
        }
        Ok(())
    }

    fn add_line(&mut self, layer: &str, ends: [[f64; 2]; 2]) {
        self.lines.push(Line {
            layer: layer.to_owned(),
            ends,
        });
    }

    fn add_polyline(&mut self, layer: &str, at: &[[f64; 2]], closed: bool) {
        for pair in at.windows(2) {
            self.add_line(layer, [pair[0], pair[1]]);
        }
        if let (true, [first, .., last]) = (closed, at) {
            self.add_line(layer, [*last, *first]);
        }
    }
}

/// Returns the placing of a block that is inserted.
fn inserted<'a>(
    entity: &Entity,
    outer: Placing<'_>,
    layer: &'a str,
    side: f64,
) -> Result<Placing<'a>, Error> {
    let at = entity.point(10)?;
    let scales = [entity.number(41, 1.0)?, entity.number(42, 1.0)?];
    let (sin, cos) = entity.number(50, 0.0)?.to_radians().sin_cos();
    let own = [
        [side * scales[0] * cos, scales[0] * sin],
        [-side * scales[1] * sin, scales[1] * cos],
    ];
    let linear = |[x, y]: [f64; 2]| {
        let [a, b, _] = outer.columns;
        [a[0] * x + b[0] * y, a[1] * x + b[1] * y]
    };
    let [a, b] = own.map(linear);
    Ok(Placing {
        columns: [a, b, outer.map([side * at[0], at[1]])],
        layer,
    })
}
