//! Bounds of a contour over ranges of the polar angle, by sectors of the turn.
//!
//! The sectors of level k are 2ᵏ equal parts of the turn; each halves into two of the next level.
//! The coarsest ones that are fine enough cover a range. Each is bounded once per set of
//! parameters and kept, so that bounds over a range take no interval arithmetic as a rule, and
//! depend on the contour and the range alone.
//!
//! A sector with the middle m in which the contour is three times differentiable keeps an expansion:
//!
//! > R″(θ) = R″(m) + R‴ (θ − m), R′(θ) = R′(m) + R″(m) (θ − m) + R‴ (θ − m)²/2, …
//!
//! with the bounds of R‴ in the sector.

use std::cell::Cell;
use std::f64::consts::TAU;

use super::{Joint, ProfileBounds};
use crate::mechanism::{Expression, Interval, Jet3, ParameterId};

/// Level of the widest sectors.
const FIRST_LEVEL: u32 = 5;
/// Level of the narrowest sectors: some thousand roundings of an angle.
const LAST_LEVEL: u32 = 40;
/// Number of sectors that are kept: all up to level 8.
const KEPT: usize = 512;
/// Largest width of the bounds of R‴ in a sector that is fine enough for any range \[radii\].
const RESOLVED: f64 = 0.1;
/// Width of a sector that is fine enough in any case, as a part of the range.
const NARROW: f64 = 0.125;
/// Overlap of a sector with its neighbours, as a part of its width: a kink between two of them is
/// in both.
const OVERLAP: f64 = 1.0 / 1024.0;
/// Bound of the rounding of an expansion, relative to its terms: some ten operations.
const TERM_ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Number `index` of the 2^`level` equal parts of the turn.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sector {
    level: u32,
    index: u64,
}

/// R and its derivatives in a sector.
#[derive(Clone, Copy, Debug)]
enum SectorBounds {
    /// The contour is three times differentiable.
    Smooth(Expansion),
    /// It cannot be shown to be so.
    Seam,
    /// Bounds over all pieces that may meet there.
    Pieces(Option<ProfileBounds>),
}

/// R and its derivatives, expanded about the middle of a sector.
#[derive(Clone, Copy, Debug)]
struct Expansion {
    /// R, R′ and R″ in the middle, and bounds of their errors.
    middle: [f64; 3],
    errors: [f64; 3],
    /// R‴ in the sector.
    third: Interval,
}

/// An expression's contour, to be bounded.
#[derive(Clone, Copy)]
pub(super) struct Contour<'a> {
    pub(super) expression: &'a Expression,
    /// Values of all parameters.
    pub(super) parameters: &'a [f64],
    /// Continuity where its pieces meet.
    pub(super) joint: Joint,
}

/// A range of polar angles to be covered.
#[derive(Clone, Copy)]
struct Cover<'a> {
    contour: Contour<'a>,
    /// Within the turn.
    range: Interval,
    /// Width of a sector that is fine enough in any case.
    narrow: f64,
}

/// The sectors bounded last.
#[derive(Clone, Debug)]
pub(super) struct Sectors(Box<[Kept]>);

/// Place of a sector that is kept.
type Kept = Cell<Option<(Sector, SectorBounds)>>;

impl Sector {
    fn width(self) -> f64 {
        // Exact.
        TAU / (1_u64 << self.level) as f64
    }

    fn low(self) -> f64 {
        self.index as f64 * self.width()
    }

    /// Returns the angle in its middle.
    fn middle(self) -> f64 {
        (self.index as f64 + 0.5) * self.width()
    }

    /// Returns its polar angles, with the overlap.
    fn range(self) -> Interval {
        overlapping([self.low(), self.low() + self.width()])
    }

    fn halves(self) -> [Self; 2] {
        [0, 1].map(|k| Self {
            level: self.level + 1,
            index: 2 * self.index + k,
        })
    }

    /// Returns its place among those that are kept.
    fn place(self) -> usize {
        let number = (1 << self.level) + self.index;
        if number < KEPT as u64 {
            return number as usize;
        }
        // Multiplication by the golden ratio spreads the numbers evenly.
        let spread = number.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        (spread >> (u64::BITS - KEPT.ilog2())) as usize
    }
}

/// Returns a range within the turn, a little wider.
pub(super) fn overlapping([low, high]: [f64; 2]) -> Interval {
    let overlap = OVERLAP * (high - low);
    Interval::new((low - overlap).max(0.0), (high + overlap).min(TAU))
}

impl Expansion {
    /// Makes it from R and its derivatives in the middle of a sector and R‴ in the whole of it.
    fn new(middle: Jet3<Interval>, third: Interval) -> Self {
        let [first, second, _] = middle.derivatives;
        let terms = [middle.value, first, second, third];
        Self {
            middle: [0, 1, 2].map(|k| terms[k].midpoint()),
            // The offset from the middle is below one.
            errors: [0, 1, 2].map(|k| {
                let rounding = TERM_ROUNDING * (terms[k].magnitude() + terms[k + 1].magnitude());
                terms[k].high - terms[k].low + rounding
            }),
            third,
        }
    }

    /// Returns whether the bounds of R‴ are narrow.
    fn is_resolved(&self) -> bool {
        self.third.high - self.third.low <= RESOLVED * self.middle[0]
    }

    /// Returns bounds between two offsets from the middle: each derivative differs from its value
    /// between them by at most half their distance times the bound of the next one.
    fn bounds(&self, [from, to]: [f64; 2]) -> Jet3<Interval> {
        let (x, half) = (0.5 * (from + to), 0.5 * (to - from));
        let ([r, r1, r2], [error, error1, error2]) = (self.middle, self.errors);
        let r3 = self.third.midpoint();
        let spread = (self.third.high - r3).max(r3 - self.third.low) * x.abs();
        let around = |value: f64, error: f64, next: Interval| {
            let off = error + half * next.magnitude();
            Interval::new(value - off, value + off)
        };
        let second = around(r2 + r3 * x, error2 + spread, self.third);
        let error1 = error1 + 0.5 * spread * x.abs();
        let first = around(r1 + x * (r2 + 0.5 * r3 * x), error1, second);
        let error = error + spread * x * x / 6.0;
        let value = around(r + x * (r1 + x * (0.5 * r2 + r3 * x / 6.0)), error, first);
        Jet3::new(value, [first, second, self.third])
    }
}

impl Sectors {
    /// Makes the storage.
    pub(super) fn new() -> Self {
        Self(vec![Cell::new(None); KEPT].into())
    }

    /// Forgets all sectors.
    pub(super) fn forget(&mut self) {
        self.0.fill(Cell::new(None));
    }

    /// Returns bounds of a contour for polar angles up to `reach` from `theta`, of any number of
    /// turns; `None` if the slope may jump there, or the radius. Allocates nothing.
    pub(super) fn bounds(
        &self,
        contour: Contour<'_>,
        theta: f64,
        reach: f64,
    ) -> Option<ProfileBounds> {
        // The ends are rounded.
        let reach = reach + 4.0 * f64::EPSILON * (theta.abs() + TAU);
        let width = (2.0 * reach).min(TAU);
        let low = (theta - reach).rem_euclid(TAU);
        if !(low + reach).is_finite() {
            return None;
        }
        let over = |low, high| {
            let cover = Cover {
                contour,
                range: Interval::new(low, high),
                narrow: NARROW * width,
            };
            let count = 1 << FIRST_LEVEL;
            let index = |theta: f64| ((theta / TAU * count as f64) as u64).min(count - 1);
            let sectors = (index(low)..=index(high)).map(|index| Sector {
                level: FIRST_LEVEL,
                index,
            });
            self.over_sectors(cover, sectors)
        };
        if width >= TAU {
            return over(0.0, TAU);
        }
        let high = low + width;
        if high <= TAU {
            return over(low, high);
        }
        Some(over(low, TAU)?.hull(over(0.0, high - TAU)?))
    }

    fn over_sectors(
        &self,
        cover: Cover<'_>,
        mut sectors: impl Iterator<Item = Sector>,
    ) -> Option<ProfileBounds> {
        let first = self.within(cover, sectors.next()?)?;
        sectors.try_fold(first, |hull, sector| {
            Some(hull.hull(self.within(cover, sector)?))
        })
    }

    /// Returns bounds over the part of a range in a sector.
    fn within(&self, cover: Cover<'_>, sector: Sector) -> Option<ProfileBounds> {
        let Cover {
            contour,
            range,
            narrow,
        } = cover;
        let is_narrow = sector.width() <= narrow || sector.level == LAST_LEVEL;
        let place = &self.0[sector.place()];
        let keep = |bounds| {
            place.set(Some((sector, bounds)));
            bounds
        };
        let bounds = match place.get() {
            Some((kept, bounds)) if kept == sector => bounds,
            _ => keep(contour.in_sector(sector)),
        };
        let bounds = match bounds {
            SectorBounds::Seam if is_narrow => {
                keep(SectorBounds::Pieces(contour.pieces(sector.range())))
            }
            bounds => bounds,
        };
        match bounds {
            SectorBounds::Smooth(expansion) if is_narrow || expansion.is_resolved() => {
                let Interval { low, high } = sector.range();
                let ends = [range.low.max(low), range.high.min(high)];
                return Some(ProfileBounds {
                    radius: expansion.bounds(ends.map(|end| end - sector.middle())),
                    jumps: false,
                });
            }
            SectorBounds::Pieces(bounds) if is_narrow => return bounds,
            _ => {}
        }
        let [before, after] = sector.halves();
        let meets = [range.low <= after.low(), range.high >= after.low()];
        let halves = [before, after].into_iter().zip(meets);
        let halves = halves.filter_map(|(half, meets)| meets.then_some(half));
        self.over_sectors(cover, halves)
    }
}

impl Contour<'_> {
    fn in_sector(self, sector: Sector) -> SectorBounds {
        let parameter = |p: ParameterId| self.parameters[p.index()];
        let expansion = self
            .expression
            .expand(&parameter, sector.range(), sector.middle());
        expansion.map_or(SectorBounds::Seam, |[middle, all]| {
            SectorBounds::Smooth(Expansion::new(middle, all.third()))
        })
    }

    /// Returns bounds over all pieces that may meet in a range; `None` if they may do so with a
    /// jump of the slope or the radius.
    fn pieces(self, range: Interval) -> Option<ProfileBounds> {
        if self.joint == Joint::Kink {
            return None;
        }
        let parameter = |p: ParameterId| self.parameters[p.index()];
        Some(ProfileBounds {
            radius: self.expression.enclose_pieces(&parameter, range)?,
            jumps: self.joint == Joint::Slope,
        })
    }
}
