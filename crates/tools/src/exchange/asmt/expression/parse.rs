//! Expressions of the source, read.

use super::Term::{Call, Distance, Negative, Number, Pi, Pieces, Rate, Time};
use super::{LONGEST, Term, binary};

/// Functions, with their names in mechanism files.
const FUNCTIONS: [(&str, &str); 8] = [
    ("abs", "abs"),
    ("sin", "sin"),
    ("cos", "cos"),
    ("asin", "asin"),
    ("arcsin", "asin"),
    ("arctan", "atan"),
    ("sqrt", "sqrt"),
    ("exp", "exp"),
];

/// Deepest brackets, well below what a mechanism file may have.
const DEEPEST: usize = 32;
/// Sums and products of an expression: its tree is as deep, and is walked on stacks of a megabyte.
const MOST_OPERATORS: usize = 500;

pub(super) fn parse(text: &str) -> Option<Term> {
    if text.len() > LONGEST {
        return None;
    }
    let mut parser = Parser {
        rest: text,
        depth: 0,
        operators: 0,
    };
    let term = parser.sum()?;
    parser.blank()?;
    parser.rest.is_empty().then_some(term)
}

struct Parser<'a> {
    rest: &'a str,
    depth: usize,
    /// Sums and products so far: each is a level of the tree that others walk.
    operators: usize,
}

impl Parser<'_> {
    /// Passes blanks, comments in quotes, and marks of a line's end.
    fn blank(&mut self) -> Option<()> {
        loop {
            self.rest = self.rest.trim_start();
            if let Some(comment) = self.rest.strip_prefix('"') {
                self.rest = comment.split_once('"')?.1;
            } else if let Some(rest) = self.rest.strip_prefix("<n>") {
                self.rest = rest;
            } else {
                return Some(());
            }
        }
    }

    /// Passes a character if it comes next.
    fn takes(&mut self, c: char) -> Option<bool> {
        self.blank()?;
        let rest = self.rest.strip_prefix(c);
        self.rest = rest.unwrap_or(self.rest);
        Some(rest.is_some())
    }

    fn sum(&mut self) -> Option<Term> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return None;
        }
        let mut sum = self.product()?;
        loop {
            let sign = match (self.takes('+')?, self.rest.starts_with('-')) {
                (true, _) => '+',
                (_, true) if self.takes('-')? => '-',
                _ => break,
            };
            self.count()?;
            sum = binary(sign, sum, self.product()?);
        }
        self.depth -= 1;
        Some(sum)
    }

    fn product(&mut self) -> Option<Term> {
        let mut product = self.signed()?;
        loop {
            let sign = match (self.takes('*')?, self.rest.starts_with('/')) {
                (true, _) => '*',
                (_, true) if self.takes('/')? => '/',
                _ => return Some(product),
            };
            self.count()?;
            product = binary(sign, product, self.signed()?);
        }
    }

    /// Counts a sum or a product; `None` beyond the most.
    fn count(&mut self) -> Option<()> {
        self.operators += 1;
        (self.operators <= MOST_OPERATORS).then_some(())
    }

    fn signed(&mut self) -> Option<Term> {
        let mut is_negative = false;
        loop {
            if self.takes('-')? {
                is_negative = !is_negative;
            } else if !self.takes('+')? {
                break;
            }
        }
        let mut term = self.operand()?;
        if self.takes('^')? {
            self.depth += 1;
            if self.depth > DEEPEST {
                return None;
            }
            term = binary('^', term, self.signed()?);
            self.depth -= 1;
        }
        Some(if is_negative {
            Negative(Box::new(term))
        } else {
            term
        })
    }

    fn operand(&mut self) -> Option<Term> {
        if self.takes('(')? {
            let term = self.sum()?;
            return self.takes(')')?.then_some(term);
        }
        if self
            .rest
            .starts_with(|c: char| c.is_ascii_digit() || c == '.')
        {
            let (value, taken) = number(self.rest)?;
            self.rest = &self.rest[taken..];
            return Some(Number(value));
        }
        let word = self.word()?;
        match word {
            "time" => return Some(Time),
            "pi" => return Some(Pi),
            _ => {}
        }
        if !self.takes('(')? {
            return None;
        }
        let term = match word {
            "rIJ" | "angleIJz" => self.own().map(|()| Distance)?,
            "vrIJ" => self.own().map(|()| Rate)?,
            "omeIJKi" => {
                // The component along the third axis of marker I.
                self.own()?;
                let is_about_z =
                    self.takes(',')? && self.takes('I')? && self.takes(',')? && self.takes('3')?;
                is_about_z.then_some(Rate)?
            }
            "rampstep" => self.ramp()?,
            "integral" => {
                self.over_time()?;
                self.sum()?.integral()?
            }
            "piecewise" => self.pieces()?,
            _ => {
                let (_, name) = FUNCTIONS.iter().find(|(known, _)| *known == word)?;
                Call(name, Box::new(self.sum()?))
            }
        };
        self.takes(')')?.then_some(term)
    }

    fn word(&mut self) -> Option<&'static str> {
        const WORDS: [&str; 12] = [
            "time",
            "pi",
            "rIJ",
            "vrIJ",
            "angleIJz",
            "omeIJKi",
            "self",
            "rampstep",
            "integral",
            "piecewise",
            "functions",
            "transitions",
        ];
        let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let end = self.rest.find(|c| !is_word(c)).unwrap_or(self.rest.len());
        let word = &self.rest[..end];
        let functions = FUNCTIONS.iter().map(|(known, _)| *known);
        let found = WORDS
            .into_iter()
            .chain(functions)
            .find(|known| *known == word)?;
        self.rest = &self.rest[end..];
        Some(found)
    }

    /// Passes the word for the markers of the force itself.
    fn own(&mut self) -> Option<()> {
        self.blank()?;
        (self.word()? == "self").then_some(())
    }

    /// Passes the first argument of a function over time, and the comma behind it.
    fn over_time(&mut self) -> Option<()> {
        let is_time = matches!(self.sum()?, Time);
        (is_time && self.takes(',')?).then_some(())
    }

    /// Reads constants to the closing bracket.
    fn constants(&mut self) -> Option<Vec<f64>> {
        let mut constants = Vec::new();
        loop {
            let term = self.sum()?;
            let value = term.is_constant().then(|| term.value(0.0))?;
            constants.push(value.is_finite().then_some(value)?);
            if !self.takes(',')? {
                return Some(constants);
            }
        }
    }

    /// Reads a ramp between two points: level, straight, level.
    fn ramp(&mut self) -> Option<Term> {
        self.over_time()?;
        let [x0, y0, x1, y1] = self.constants()?[..] else {
            return None;
        };
        let slope = (y1 - y0) / (x1 - x0);
        let way = binary('*', Number(slope), binary('-', Time, Number(x0)));
        let straight = binary('+', Number(y0), way);
        (x1 > x0).then(|| Pieces(vec![Number(y0), straight, Number(y1)], vec![x0, x1]))
    }

    fn pieces(&mut self) -> Option<Term> {
        self.over_time()?;
        self.blank()?;
        (self.word()? == "functions" && self.takes('(')?).then_some(())?;
        let mut pieces = vec![self.sum()?];
        while self.takes(',')? {
            pieces.push(self.sum()?);
        }
        (self.takes(')')? && self.takes(',')?).then_some(())?;
        self.blank()?;
        (self.word()? == "transitions" && self.takes('(')?).then_some(())?;
        let ends = self.constants()?;
        self.takes(')')?.then_some(())?;
        let are_in_order = ends.is_sorted_by(|a, b| a < b) && ends.len() + 1 == pieces.len();
        are_in_order.then_some(Pieces(pieces, ends))
    }
}

/// Returns the number at the start of a text, and its length.
fn number(text: &str) -> Option<(f64, usize)> {
    /// Greatest number: times far behind the end of a motion.
    const MOST: f64 = 1e12;
    let bytes = text.as_bytes();
    let digits = |from: usize| {
        let rest = bytes.get(from..).unwrap_or_default();
        rest.iter().take_while(|byte| byte.is_ascii_digit()).count()
    };
    let mut end = digits(0);
    if bytes.get(end) == Some(&b'.') {
        end += 1 + digits(end + 1);
    }
    let mantissa = &text[..end];
    let mut exponent = 0_i32;
    if let Some(b'e' | b'E' | b'd' | b'D') = bytes.get(end) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let count = digits(end + 1 + sign);
        if count > 0 {
            exponent = text[end + 1..end + 1 + sign + count].parse().ok()?;
        }
        // `2.0d` is a number of its own.
        end += 1 + if count > 0 { sign + count } else { 0 };
    }
    let value: f64 = format!("{mantissa}e{exponent}").parse().ok()?;
    let usable = value.abs() <= MOST && !mantissa.trim_matches('.').is_empty();
    usable.then_some((value, end))
}
