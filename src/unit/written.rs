//! Units as they are written: products and quotients of symbols with prefixes, such as `kN.m/deg`.

use std::f64::consts::PI;
use std::ops::Range;

use super::name::{LONGEST, UnitName};
use super::{ANGLE, ANGULAR_VELOCITY, Dimension, DisplayUnit, LENGTH, MASS, Unit, electric};

/// Fault of a text that is no unit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum UnitFault {
    /// A part, by its place in the text, is no symbol.
    Symbol(Range<usize>),
    /// A product follows a quotient: it may belong above it or below. Has the text with brackets, which
    /// put it below.
    Ambiguous(String),
    /// Its signs make no product and no quotient, or it is too long.
    Form,
}

/// A symbol of a unit. One of it is numerator / denominator in SI.
struct Symbol {
    name: &'static str,
    dimension: Dimension,
    numerator: f64,
    denominator: f64,
    has_prefixes: bool,
}

const fn si(name: &'static str, dimension: Dimension) -> Symbol {
    Symbol {
        name,
        dimension,
        numerator: 1.0,
        denominator: 1.0,
        has_prefixes: true,
    }
}

const fn other(name: &'static str, dimension: Dimension, [above, below]: [f64; 2]) -> Symbol {
    Symbol {
        numerator: above,
        denominator: below,
        has_prefixes: false,
        ..si(name, dimension)
    }
}

const fn prefixed(symbol: Symbol) -> Symbol {
    Symbol {
        has_prefixes: true,
        ..symbol
    }
}

const SECOND: Dimension = Unit::SECOND.dimension;
const PASCAL: Dimension = Unit::PASCAL.dimension;
const VOLUME: Dimension = electric([0, 3, 0, 0], 0);

/// Symbols without their prefixes: SI (Brochure, 9th edition, tables 2 and 4), and common ones.
const SYMBOLS: [Symbol; 32] = [
    si("m", LENGTH),
    // The kilogram has a prefix already.
    prefixed(other("g", MASS, [1.0, 1e3])),
    si("s", SECOND),
    si("rad", ANGLE),
    si("A", Unit::AMPERE.dimension),
    si("K", Unit::KELVIN.dimension),
    si("N", Unit::NEWTON.dimension),
    si("J", Unit::JOULE.dimension),
    si("W", Unit::WATT.dimension),
    si("Pa", PASCAL),
    si("Hz", Unit::HERTZ.dimension),
    si("V", Unit::VOLT.dimension),
    si("ohm", Unit::OHM.dimension),
    si("C", electric([0, 0, 1, 0], 1)),
    si("F", electric([-1, -2, 4, 0], 2)),
    si("H", electric([1, 2, -2, 0], -2)),
    si("T", electric([1, 0, -2, 0], -1)),
    si("Wb", electric([1, 2, -2, 0], -1)),
    si("S", electric([-1, -2, 3, 0], 2)),
    prefixed(other("bar", PASCAL, [1e5, 1.0])),
    prefixed(other("l", VOLUME, [1.0, 1e3])),
    prefixed(other("L", VOLUME, [1.0, 1e3])),
    other("t", MASS, [1e3, 1.0]),
    other("min", SECOND, [60.0, 1.0]),
    other("h", SECOND, [3600.0, 1.0]),
    other("deg", ANGLE, [PI, 180.0]),
    other("rev", ANGLE, [2.0 * PI, 1.0]),
    other("rpm", ANGULAR_VELOCITY, [PI, 30.0]),
    other("inch", LENGTH, [127.0, 5e3]),
    other("ft", LENGTH, [381.0, 1250.0]),
    // A pound of 0.453 592 37 kg under 9.806 65 m/s².
    other("lbf", Unit::NEWTON.dimension, [4.448_221_615_260_5, 1.0]),
    other("%", Dimension::ONE, [1.0, 100.0]),
];

/// Prefixes with their factors above and below.
const PREFIXES: [(&str, [f64; 2]); 14] = [
    ("p", [1.0, 1e12]),
    ("n", [1.0, 1e9]),
    // The micro sign, the Greek letter, and the letter of keyboards.
    ("µ", [1.0, 1e6]),
    ("μ", [1.0, 1e6]),
    ("u", [1.0, 1e6]),
    ("m", [1.0, 1e3]),
    ("c", [1.0, 1e2]),
    ("d", [1.0, 1e1]),
    ("da", [1e1, 1.0]),
    ("h", [1e2, 1.0]),
    ("k", [1e3, 1.0]),
    ("M", [1e6, 1.0]),
    ("G", [1e9, 1.0]),
    ("T", [1e12, 1.0]),
];

/// Product of symbols: one of it is above / below in SI.
#[derive(Clone, Copy, Debug)]
struct Product {
    dimension: Dimension,
    above: f64,
    below: f64,
}

impl Product {
    const ONE: Self = Self {
        dimension: Dimension::ONE,
        above: 1.0,
        below: 1.0,
    };

    /// Returns the unit with this symbol, with or without a prefix.
    fn of_symbol(text: &str) -> Option<Self> {
        let with = |symbol: &Symbol, [above, below]: [f64; 2]| Self {
            dimension: symbol.dimension,
            above: symbol.numerator * above,
            below: symbol.denominator * below,
        };
        if let Some(symbol) = SYMBOLS.iter().find(|symbol| symbol.name == text) {
            return Some(with(symbol, [1.0; 2]));
        }
        PREFIXES.iter().find_map(|(prefix, factor)| {
            let rest = text.strip_prefix(prefix)?;
            let mut symbols = SYMBOLS.iter().filter(|symbol| symbol.has_prefixes);
            let symbol = symbols.find(|symbol| symbol.name == rest)?;
            Some(with(symbol, *factor))
        })
    }

    fn times(self, other: Self) -> Option<Self> {
        Some(Self {
            dimension: self.dimension.times(other.dimension)?,
            above: self.above * other.above,
            below: self.below * other.below,
        })
    }

    fn to_power(self, power: i32) -> Option<Self> {
        let [above, below] = if power < 0 {
            [self.below, self.above]
        } else {
            [self.above, self.below]
        };
        let size = power.abs();
        Some(Self {
            dimension: self.dimension.to_power(f64::from(power))?,
            above: above.powi(size),
            below: below.powi(size),
        })
    }
}

/// Reader of a unit.
struct Reader<'a> {
    text: &'a str,
    at: usize,
}

impl Reader<'_> {
    fn take(&mut self, sign: char) -> bool {
        let is_next = self.text[self.at..].starts_with(sign);
        if is_next {
            self.at += sign.len_utf8();
        }
        is_next
    }

    /// Takes the longest part of such characters, and returns its place.
    fn take_all(&mut self, is_part: impl Fn(char) -> bool) -> Range<usize> {
        let rest = &self.text[self.at..];
        let length = rest.find(|c| !is_part(c)).unwrap_or(rest.len());
        self.at += length;
        self.at - length..self.at
    }

    /// Reads products and quotients, from left to right.
    fn product(&mut self) -> Result<Product, UnitFault> {
        let mut whole = self.factor()?;
        let mut below = None;
        loop {
            if self.take('/') {
                below = Some(self.at);
                let factor = self.factor()?.to_power(-1);
                whole = factor.and_then(|f| whole.times(f)).ok_or(UnitFault::Form)?;
            } else if self.take('.') {
                let factor = self.factor()?;
                if let Some(first) = below {
                    while self.take('.') {
                        self.factor()?;
                    }
                    let [before, inside, after] = [
                        &self.text[..first],
                        &self.text[first..self.at],
                        &self.text[self.at..],
                    ];
                    return Err(UnitFault::Ambiguous(format!("{before}({inside}){after}")));
                }
                whole = whole.times(factor).ok_or(UnitFault::Form)?;
            } else {
                return Ok(whole);
            }
        }
    }

    /// Reads a symbol with its exponent, `1`, or a product in brackets.
    fn factor(&mut self) -> Result<Product, UnitFault> {
        let base = if self.take('(') {
            let inside = self.product()?;
            if !self.take(')') {
                return Err(UnitFault::Form);
            }
            inside
        } else if self.text[self.at..].starts_with(|c: char| c.is_ascii_digit()) {
            let number = self.take_all(|c| c.is_ascii_digit());
            return match &self.text[number] {
                "1" => Ok(Product::ONE),
                _ => Err(UnitFault::Form),
            };
        } else {
            let place = self.take_all(|c| c.is_alphabetic() || c == '%');
            let symbol = &self.text[place.clone()];
            match Product::of_symbol(symbol) {
                Some(symbol) => symbol,
                None if symbol.is_empty() => return Err(UnitFault::Form),
                None => return Err(UnitFault::Symbol(place)),
            }
        };
        let start = self.at;
        self.take('-');
        self.take_all(|c| c.is_ascii_digit());
        if start == self.at {
            return Ok(base);
        }
        let exponent = self.text[start..self.at].parse().ok();
        exponent
            .and_then(|exponent: i8| base.to_power(exponent.into()))
            .ok_or(UnitFault::Form)
    }
}

impl DisplayUnit {
    /// Reads a unit: symbols with prefixes and exponents, products and quotients of them from left to
    /// right, `1`, and brackets, such as `kN`, `l/min` and `W/(m2.K)`.
    ///
    /// # Errors
    ///
    /// The fault of a text that is none.
    pub fn read(text: &str) -> Result<Self, UnitFault> {
        let unit = read(text)?;
        Ok(Self {
            name: UnitName::new(text),
            factor: unit.below / unit.above,
            dimension: unit.dimension,
        })
    }
}

/// Returns the size of one unit in SI: 1e5 for `bar`.
///
/// # Errors
///
/// Those of [`DisplayUnit::read`].
pub fn size_of_unit(text: &str) -> Result<f64, UnitFault> {
    read(text).map(|unit| unit.above / unit.below)
}

fn read(text: &str) -> Result<Product, UnitFault> {
    if text.len() > LONGEST {
        return Err(UnitFault::Form);
    }
    let mut reader = Reader { text, at: 0 };
    let unit = reader.product()?;
    let sizes = [unit.above / unit.below, unit.below / unit.above];
    let is_possible = sizes.iter().all(|size| size.is_finite() && *size > 0.0);
    if reader.at == text.len() && is_possible {
        Ok(unit)
    } else {
        Err(UnitFault::Form)
    }
}

/// Returns the symbols with all their prefixes.
#[must_use]
pub fn symbols() -> Vec<String> {
    let mut all: Vec<String> = SYMBOLS
        .iter()
        .map(|symbol| symbol.name.to_owned())
        .collect();
    let prefixed = SYMBOLS.iter().filter(|symbol| symbol.has_prefixes);
    all.extend(prefixed.flat_map(|symbol| {
        let prefixes = PREFIXES.iter();
        prefixes.map(move |(prefix, _)| format!("{prefix}{}", symbol.name))
    }));
    all
}
