//! Motions as expressions of mechanism files.

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

/// Returns an expression in the words of mechanism files; `None` if it has a function that these do
/// not know.
pub(super) fn translated(text: &str) -> Option<String> {
    let mut out = String::new();
    let mut depth = 0_usize;
    let mut operand_next = true;
    let mut rest = text.trim();
    while let Some(c) = rest.chars().next() {
        let taken = match c {
            ' ' | '\t' => 1,
            // A comment in quotes, and the mark of a line's end.
            '"' => rest[1..].find('"')? + 2,
            '<' if rest.starts_with("<n>") => 3,
            '0'..='9' | '.' => {
                let (number, taken) = number(rest)?;
                if !operand_next {
                    return None;
                }
                out.push_str(&number);
                operand_next = false;
                taken
            }
            'a'..='z' | 'A'..='Z' => {
                let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
                let taken = rest.find(|c| !is_word(c)).unwrap_or(rest.len());
                if !operand_next {
                    return None;
                }
                let word = &rest[..taken];
                match word {
                    "time" => out.push('t'),
                    "pi" => out.push_str("pi"),
                    _ => {
                        let (_, name) = FUNCTIONS.iter().find(|(known, _)| *known == word)?;
                        rest[taken..].trim_start().strip_prefix('(')?;
                        out.push_str(name);
                    }
                }
                operand_next = !matches!(word, "time" | "pi");
                taken
            }
            '(' if operand_next => {
                depth += 1;
                out.push(c);
                1
            }
            ')' if !operand_next && depth > 0 => {
                depth -= 1;
                out.push(c);
                1
            }
            '+' | '-' => {
                match operand_next {
                    true => out.push(c),
                    false => out.push_str(&format!(" {c} ")),
                }
                operand_next = true;
                1
            }
            '*' | '/' | '^' if !operand_next => {
                out.push(c);
                operand_next = true;
                1
            }
            _ => return None,
        };
        if depth > DEEPEST || out.len() > 4000 {
            return None;
        }
        rest = &rest[taken..];
    }
    (depth == 0 && !operand_next).then_some(out)
}

/// Returns the number at the start of a text as mechanism files write it, and its length.
fn number(text: &str) -> Option<(String, usize)> {
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
    let usable = crate::exchange::error::is_usable(value) && !mantissa.trim_matches('.').is_empty();
    usable.then(|| (format!("{value}"), end))
}

#[cfg(test)]
mod tests {
    use super::translated;

    #[test]
    fn expressions_are_written_in_the_words_of_mechanism_files() {
        for (theirs, ours) in [
            ("pi/3 + 2*pi*time", "pi/3 + 2*pi*t"),
            ("2.0d*time", "2*t"),
            ("1.5d-1*sin(2*pi*time)", "0.15*sin(2*pi*t)"),
            ("\"a comment\" -arctan(time)<n>", "-atan(t)"),
            ("1-(time)^2", "1 - (t)^2"),
        ] {
            assert_eq!(translated(theirs).as_deref(), Some(ours), "{theirs}");
        }
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
        ] {
            assert_eq!(translated(unknown), None, "{unknown}");
        }
    }
}
