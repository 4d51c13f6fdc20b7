//! Motions and forces as expressions of mechanism files.

use std::fmt::Write as _;

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

/// Longest text of an expression, read or written.
const LONGEST: usize = 4000;

/// Greatest jump of a function of pieces, relative to its values, that is the rounding of six digits.
const JUMP: f64 = 1e-5;

/// An expression of time, and of the distance of two markers.
#[derive(Clone, Debug)]
enum Term {
    Number(f64),
    Pi,
    Time,
    Distance,
    Rate,
    Negative(Box<Term>),
    Binary(char, Box<Term>, Box<Term>),
    Call(&'static str, Box<Term>),
    /// Functions of time, one after the other, and the times between them.
    Pieces(Vec<Term>, Vec<f64>),
}

use Term::{Binary, Call, Distance, Negative, Number, Pi, Pieces, Rate, Time};

/// Returns a motion in the words of mechanism files; `None` if it has a function that these do not
/// know, or jumps.
pub(super) fn motion(text: &str) -> Option<String> {
    let term = parse(text)?;
    (!term.has(&|term| matches!(term, Distance | Rate))).then(|| term.written())?
}

/// As [`motion`], for what does not change in time.
pub(super) fn constant(text: &str) -> Option<String> {
    let term = parse(text)?;
    term.is_constant().then(|| term.written())?
}

/// As [`motion`], for a force over the distance of its markers, its rate and time.
pub(super) fn force(text: &str) -> Option<String> {
    parse(text)?.written()
}

/// Returns whether an expression is zero at all times.
pub(super) fn is_zero(text: &str) -> bool {
    let term = parse(text);
    term.is_some_and(|term| term.is_constant() && term.value(0.0) == 0.0)
}

fn parse(text: &str) -> Option<Term> {
    if text.len() > LONGEST {
        return None;
    }
    let mut parser = Parser {
        rest: text,
        depth: 0,
    };
    let term = parser.sum()?;
    parser.blank()?;
    parser.rest.is_empty().then_some(term)
}

fn binary(sign: char, a: Term, b: Term) -> Term {
    Binary(sign, Box::new(a), Box::new(b))
}

impl Term {
    fn has(&self, is: &dyn Fn(&Self) -> bool) -> bool {
        is(self)
            || match self {
                Number(_) | Pi | Time | Distance | Rate => false,
                Negative(a) | Call(_, a) => a.has(is),
                Binary(_, a, b) => a.has(is) || b.has(is),
                Pieces(pieces, _) => pieces.iter().any(|piece| piece.has(is)),
            }
    }

    fn is_constant(&self) -> bool {
        !self.has(&|term| matches!(term, Time | Distance | Rate | Pieces(..)))
    }

    /// Returns the value at a time; distances are none.
    fn value(&self, t: f64) -> f64 {
        match self {
            Number(value) => *value,
            Pi => std::f64::consts::PI,
            Time => t,
            Distance | Rate => f64::NAN,
            Negative(a) => -a.value(t),
            Binary(sign, a, b) => {
                let (a, b) = (a.value(t), b.value(t));
                match sign {
                    '+' => a + b,
                    '-' => a - b,
                    '*' => a * b,
                    '/' => a / b,
                    _ => a.powf(b),
                }
            }
            Call(name, a) => {
                let a = a.value(t);
                match *name {
                    "abs" => a.abs(),
                    "sin" => a.sin(),
                    "cos" => a.cos(),
                    "asin" => a.asin(),
                    "atan" => a.atan(),
                    "sqrt" => a.sqrt(),
                    _ => a.exp(),
                }
            }
            Pieces(pieces, ends) => {
                let index = ends.iter().take_while(|end| t >= **end).count();
                pieces[index].value(t)
            }
        }
    }

    /// Returns how much a linear expression of time grows per second.
    fn slope(&self) -> Option<f64> {
        match self {
            Time => Some(1.0),
            Negative(a) => Some(-a.slope()?),
            Binary('+', a, b) => Some(a.slope()? + b.slope()?),
            Binary('-', a, b) => Some(a.slope()? - b.slope()?),
            Binary('*', a, b) if a.is_constant() => Some(a.value(0.0) * b.slope()?),
            Binary('*', a, b) if b.is_constant() => Some(a.slope()? * b.value(0.0)),
            Binary('/', a, b) if b.is_constant() => Some(a.slope()? / b.value(0.0)),
            term if term.is_constant() => Some(0.0),
            _ => None,
        }
    }

    /// Returns the integral over time: that of a first piece has no constant.
    fn integral(&self) -> Option<Term> {
        Some(match self {
            term if term.is_constant() => binary('*', term.clone(), Time),
            Time => binary('/', binary('^', Time, Number(2.0)), Number(2.0)),
            Negative(a) => Negative(Box::new(a.integral()?)),
            Binary(sign @ ('+' | '-'), a, b) => binary(*sign, a.integral()?, b.integral()?),
            Binary('*', a, b) if a.is_constant() => binary('*', (**a).clone(), b.integral()?),
            Binary(sign @ ('*' | '/'), a, b) if b.is_constant() => {
                binary(*sign, a.integral()?, (**b).clone())
            }
            Binary('^', a, b) if b.is_constant() && b.value(0.0) != -1.0 => {
                let slope = a.slope().filter(|slope| *slope != 0.0)?;
                let power = b.value(0.0) + 1.0;
                let raised = binary('^', (**a).clone(), Number(power));
                binary('/', raised, Number(power * slope))
            }
            Call(name @ ("sin" | "cos"), a) => {
                let slope = a.slope().filter(|slope| *slope != 0.0)?;
                let (name, slope) = match *name {
                    "sin" => ("cos", -slope),
                    _ => ("sin", slope),
                };
                binary('/', Call(name, a.clone()), Number(slope))
            }
            Pieces(pieces, ends) => {
                let mut joined: Vec<Term> = Vec::new();
                for (index, piece) in pieces.iter().enumerate() {
                    let mut next = piece.integral()?;
                    if let Some(last) = joined.last() {
                        let end = ends[index - 1];
                        let step = last.value(end) - next.value(end);
                        next = binary('+', next, Number(step));
                    }
                    joined.push(next);
                }
                Pieces(joined, ends.clone())
            }
            _ => return None,
        })
    }

    fn written(&self) -> Option<String> {
        let mut out = String::new();
        self.write("t", 0, &mut out)?;
        Some(out)
    }

    /// Writes the expression with a text for time; `strength` is that of the operator around it.
    fn write(&self, time: &str, strength: u8, out: &mut String) -> Option<()> {
        if out.len() > LONGEST {
            return None;
        }
        let own = match self {
            Binary('+' | '-', ..) | Pieces(..) => 1,
            Binary('*' | '/', ..) => 2,
            Negative(_) => 3,
            Number(value) if *value < 0.0 => 3,
            Binary(..) => 4,
            _ => 5,
        };
        let is_bracketed = own < strength || (own == 3 && strength > 1);
        if is_bracketed {
            out.push('(');
        }
        match self {
            Number(value) if !value.is_finite() => return None,
            Number(value) => out.push_str(&format!("{value}")),
            Pi => out.push_str("pi"),
            Time => out.push_str(time),
            Distance => out.push_str("position"),
            Rate => out.push_str("velocity"),
            Negative(a) => {
                out.push('-');
                a.write(time, 3, out)?;
            }
            Binary(sign, a, b) => {
                // A power groups to the right, the others to the left.
                let is_power = *sign == '^';
                a.write(time, own + u8::from(is_power), out)?;
                match sign {
                    '+' | '-' => {
                        let _ = write!(out, " {sign} ");
                    }
                    _ => out.push(*sign),
                }
                b.write(time, own + u8::from(!is_power), out)?;
            }
            Call(name, a) => {
                out.push_str(name);
                out.push('(');
                a.write(time, 0, out)?;
                out.push(')');
            }
            Pieces(pieces, ends) => Self::write_pieces(pieces, ends, time, out)?,
        }
        if is_bracketed {
            out.push(')');
        }
        Some(())
    }

    /// Writes pieces that join without a jump: each one's growth between its ends.
    fn write_pieces(pieces: &[Term], ends: &[f64], time: &str, out: &mut String) -> Option<()> {
        let (first, others) = pieces.split_first()?;
        first.write(&format!("min({time}, {})", ends[0]), 1, out)?;
        for (index, piece) in others.iter().enumerate() {
            let start = ends[index];
            let (before, value) = (pieces[index].value(start), piece.value(start));
            let size = before.abs().max(value.abs()).max(1.0);
            // A comparison with a value that is none fails too.
            if !((value - before).abs() <= JUMP * size) {
                return None;
            }
            if piece.is_constant() {
                continue;
            }
            let time = match ends.get(index + 1) {
                None => format!("max({time}, {start})"),
                Some(end) => format!("max({start}, min({time}, {end}))"),
            };
            out.push_str(" + ");
            piece.write(&time, 2, out)?;
            out.push_str(" - ");
            Number(value).write(&time, 2, out)?;
        }
        Some(())
    }
}

struct Parser<'a> {
    rest: &'a str,
    depth: usize,
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
            product = binary(sign, product, self.signed()?);
        }
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
        Some(match is_negative {
            true => Negative(Box::new(term)),
            false => term,
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
            "rIJ" | "vrIJ" => {
                self.blank()?;
                (self.word()? == "self").then_some(())?;
                if word == "rIJ" { Distance } else { Rate }
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
        const WORDS: [&str; 10] = [
            "time",
            "pi",
            "rIJ",
            "vrIJ",
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
            constants.push(term.is_constant().then(|| term.value(0.0))?);
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

#[cfg(test)]
mod tests {
    use super::{constant, force, is_zero, motion, parse};

    #[test]
    fn expressions_are_written_in_the_words_of_mechanism_files() {
        for (theirs, ours) in [
            ("pi/3 + 2*pi*time", "pi/3 + 2*pi*t"),
            ("2.0d*time", "2*t"),
            ("1.5d-1*sin(2*pi*time)", "0.15*sin(2*pi*t)"),
            ("\"a comment\" -arctan(time)<n>", "-atan(t)"),
            ("1-(time)^2", "1 - t^2"),
            ("2*-1*(time - (1 - time))", "2*(-1)*(t - (1 - t))"),
            ("-(1 + time)/2/(3*time)", "-(1 + t)/2/(3*t)"),
        ] {
            assert_eq!(motion(theirs).as_deref(), Some(ours), "{theirs}");
        }
        let spring = "(0.0d + 10.0d*(rIJ(self) + (-0.5d)) + 2*vrIJ(self))";
        let ours = "0 + 10*(position + (-0.5)) + 2*velocity";
        assert_eq!(force(spring).as_deref(), Some(ours));
        assert_eq!(motion(spring), None);
        assert_eq!(constant("time"), None);
        assert!(is_zero("0.0d") && !is_zero("1") && !is_zero("time"));
        for unknown in [
            "",
            "spline(time)",
            "2 time",
            "(time",
            "time)",
            "sin",
            "time +",
            "\"open",
            "1..2",
            ".",
            "é",
            "2*é",
            "9d999",
            "rIJ(a)",
            "integral(time, sin(time^2))",
        ] {
            assert_eq!(motion(unknown), None, "{unknown}");
        }
    }

    /// Functions of pieces have the values of their closed forms, before, between and behind their
    /// ends, as they are read and as they are written.
    #[test]
    fn integrals_and_ramps_have_their_values() {
        type Function = fn(f64) -> f64;
        let cases: [(&str, Function); 4] = [
            ("rampstep(time, 1, 2, 3, 6)", |t| {
                2.0 + 2.0 * (t.clamp(1.0, 3.0) - 1.0)
            }),
            ("integral(time, rampstep(time, 0.25, 0, 3, 5.5))*-1", |t| {
                let ramp = t.clamp(0.25, 3.0) - 0.25;
                -(ramp * ramp + 5.5 * (t.max(3.0) - 3.0))
            }),
            (
                "integral(time, piecewise(time, functions(0, 4*sin(2*(time - 0.5)), 1), transitions(0.5, 2)))",
                |t| {
                    let phase = 2.0 * (t.clamp(0.5, 2.0) - 0.5);
                    2.0 * (1.0 - phase.cos()) + (t.max(2.0) - 2.0)
                },
            ),
            ("integral(time, (2*time + 1)^2)", |t| {
                (2.0 * t + 1.0).powi(3) / 6.0
            }),
        ];
        for (text, function) in cases {
            let term = parse(text).expect("it is read");
            let written = motion(text).expect("it is written");
            let again = crate::mechanism::Mechanism::parse(&crate::mechanism::Source::new(
                "test.toml",
                format!(
                    "format = 1\nname = \"a\"\n[ground.markers]\nO = [0, 0]\n\
                     [bodies.b]\nmarkers = {{ O = [0, 0] }}\n[joints]\n\
                     O_pin = {{ type = \"revolute\", markers = [\"ground.O\", \"b.O\"] }}\n\
                     [drivers]\nd = {{ coordinate = \"angle\", markers = [\"ground.O\", \"b.O\"], motion = \"{written}\" }}\n"
                ),
            ));
            assert!(again.is_ok(), "{written}");
            for t in [0.0, 0.3, 0.9, 1.7, 2.5, 4.0] {
                let right = function(t);
                // Some ten operations.
                let rounding = 1e-14 * right.abs().max(1.0);
                assert!((term.value(t) - right).abs() <= rounding, "{text} at {t}");
            }
        }
        assert_eq!(
            motion("piecewise(time, functions(0, 1), transitions(2))"),
            None
        );
    }
}
