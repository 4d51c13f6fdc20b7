//! Motions and forces as expressions of mechanism files.
//!
//! | file | subject |
//! |---|---|
//! | `parse` | texts of the source |

mod parse;
#[cfg(test)]
mod tests;

use std::fmt::Write as _;

use parse::parse;

/// Longest text of an expression, read or written.
const LONGEST: usize = 4000;

/// Greatest jump of a function of pieces, relative to its values, that is the rounding of six digits.
const JUMP: f64 = 1e-5;

/// An expression of time, and of the distance of two markers or their angle.
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

/// As [`motion`], for what does not change in time; with its value.
pub(super) fn constant(text: &str) -> Option<(String, f64)> {
    let term = parse(text).filter(Term::is_constant)?;
    Some((term.written()?, term.value(0.0)))
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
            Binary('^', a, b) if matches!(**a, Time) && b.is_constant() && b.value(0.0) > 0.0 => {
                let power = b.value(0.0) + 1.0;
                binary('/', binary('^', Time, Number(power)), Number(power))
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
            let jump = (value - before).abs();
            if jump.is_nan() || jump > JUMP * size {
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
