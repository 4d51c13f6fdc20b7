//! Tokens of the language: numbers, names and symbols, each with its place.

use super::error::ExpressionError;
use super::function::{LAW, function};
use crate::mechanism::Span;
use crate::mechanism::wording::quoted;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum TokenKind<'a> {
    Number(f64),
    /// A name, or names joined by points, such as `crank.omega`.
    Name(&'a str),
    /// One of `+ - * / ^ ( ) , =`.
    Symbol(u8),
    End,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Token<'a> {
    pub(super) kind: TokenKind<'a>,
    pub(super) start: usize,
    pub(super) end: usize,
}

impl Token<'_> {
    pub(super) fn span(&self) -> Span {
        self.start..self.end
    }

    pub(super) fn starts_operand(&self) -> bool {
        matches!(
            self.kind,
            TokenKind::Number(_) | TokenKind::Name(_) | TokenKind::Symbol(b'(')
        )
    }
}

/// Returns the token that starts at or after byte `from`, a character's boundary.
pub(super) fn scan(text: &str, from: usize) -> Result<Token<'_>, ExpressionError> {
    let bytes = text.as_bytes();
    let run = |from: usize, belongs: fn(&u8) -> bool| {
        from + bytes[from..].iter().take_while(|b| belongs(b)).count()
    };
    let start = run(from, |b| b" \t\r\n".contains(b));
    let Some(&first) = bytes.get(start) else {
        return Ok(Token {
            kind: TokenKind::End,
            start,
            end: start,
        });
    };
    let digit_follows = bytes.get(start + 1).is_some_and(u8::is_ascii_digit);
    let (kind, end) = match first {
        b'+' | b'-' | b'*' | b'/' | b'^' | b'(' | b')' | b',' | b'=' => {
            (TokenKind::Symbol(first), start + 1)
        }
        b'a'..=b'z' | b'A'..=b'Z' | b'_' => {
            let word = |from| run(from, |b| b.is_ascii_alphanumeric() || *b == b'_');
            let mut end = word(start);
            while let [b'.', b'a'..=b'z' | b'A'..=b'Z', ..] = bytes[end..] {
                end = word(end + 1);
            }
            (TokenKind::Name(&text[start..end]), end)
        }
        b'0'..=b'9' => scan_number(text, start)?,
        b'.' if digit_follows => scan_number(text, start)?,
        _ => return Err(unexpected_character(text, start)),
    };
    Ok(Token { kind, start, end })
}

/// Returns the places of the names in an expression, but for those of functions that are no functions
/// of the file; up to a fault of the text.
pub fn names_in(text: &str) -> Vec<Span> {
    let mut names: Vec<Span> = Vec::new();
    let mut at = 0;
    while let Ok(token) = scan(text, at) {
        match token.kind {
            TokenKind::End => break,
            TokenKind::Name(_) => names.push(token.span()),
            TokenKind::Symbol(b'(') => {
                let called = names.pop_if(|name| name.end == at);
                names.extend(called.filter(|name| {
                    let name = &text[name.clone()];
                    name != LAW && function(name).is_none()
                }));
            }
            _ => {}
        }
        at = token.end;
    }
    names
}

/// Scans a number: digits with at most one point, then an exponent if its digits follow.
fn scan_number(text: &str, start: usize) -> Result<(TokenKind<'_>, usize), ExpressionError> {
    let bytes = text.as_bytes();
    let digits = |from: usize| {
        from + bytes[from..]
            .iter()
            .take_while(|b| b.is_ascii_digit())
            .count()
    };
    let mut end = digits(start);
    if bytes.get(end) == Some(&b'.') {
        end = digits(end + 1);
    }
    if let Some(b'e' | b'E') = bytes.get(end) {
        let signed = matches!(bytes.get(end + 1), Some(b'+' | b'-'));
        let exponent = end + 1 + usize::from(signed);
        if bytes.get(exponent).is_some_and(u8::is_ascii_digit) {
            end = digits(exponent);
        }
    }
    if bytes.get(end) == Some(&b'.') {
        return Err(ExpressionError::new(
            start..end + 1,
            "a number has one decimal point",
        ));
    }
    let value: f64 = text[start..end]
        .parse()
        .expect("digits, a point and an exponent make a number");
    if value.is_infinite() {
        return Err(ExpressionError::new(start..end, "the number is too large"));
    }
    Ok((TokenKind::Number(value), end))
}

/// Help for a choice between values.
pub(super) const CHOICE: &str =
    "choose by `min`, `max` and `sign`: `max(sign(t - 1), 0)` is 1 after t = 1, and 0 before";

fn unexpected_character(text: &str, start: usize) -> ExpressionError {
    let character = text[start..].chars().next().unwrap_or(' ');
    let error = ExpressionError::new(
        start..start + character.len_utf8(),
        format!("unexpected character {}", quoted(&character.to_string())),
    );
    let right = match character {
        '−' | '–' => "-",
        '×' | '·' | '⋅' => "*",
        '÷' | ':' => "/",
        'π' => "pi",
        '°' => "*deg",
        '²' => "^2",
        '³' => "^3",
        '[' | '{' => "(",
        ']' | '}' => ")",
        '<' | '>' | '?' => return error.help(CHOICE),
        _ => return error,
    };
    error.help(format!("write `{right}`"))
}
