//! Names: legal ones, and suggestions for wrong ones.

use std::cell::Cell;
use std::collections::HashMap;

use super::wording::{either, quoted};

/// Most suggestions per table of names: a file of wrong names would take quadratic time.
const MAX_SUGGESTIONS: u32 = 100;

/// Length of the longest name that gets a suggestion: edit distance is quadratic in the length.
const MAX_SUGGESTED_LENGTH: usize = 64;

/// Most names that a message lists.
const MAX_LISTED: usize = 30;

/// Returns whether `name` matches `[A-Za-z][A-Za-z0-9_]*`.
///
/// Names of FMI type definitions have other characters, so that they never equal a variable's
/// (FMI 2.0.4, section 2.2.3).
pub(super) fn is_legal(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_')
}

/// Returns whether `name` is a device of Windows, which no file there can be called: `CON`, `com1`.
pub(super) fn is_device(name: &str) -> bool {
    let is = |device: &&str| name.eq_ignore_ascii_case(device);
    let is_port = |port: &&str| {
        let (start, number) = name.split_at_checked(3).unwrap_or_default();
        start.eq_ignore_ascii_case(port) && matches!(number.as_bytes(), [b'0'..=b'9'])
    };
    ["con", "prn", "aux", "nul"].iter().any(is) || ["com", "lpt"].iter().any(is_port)
}

/// Returns the words of C, up to C23.
pub(super) fn c_keywords() -> impl Iterator<Item = &'static str> {
    "\
    _Alignas _Alignof _Atomic _BitInt _Bool _Complex _Decimal128 _Decimal32 _Decimal64 \
    _Generic _Imaginary _Noreturn _Static_assert _Thread_local alignas alignof auto bool break \
    case char const constexpr continue default do double else enum extern false float for goto \
    if inline int long nullptr register restrict return short signed sizeof static \
    static_assert struct switch thread_local true typedef typeof typeof_unqual union unsigned \
    void volatile while"
        .split(' ')
}

/// Length of the longest name of a mechanism: files in the FMU are called so, whose names have at
/// most 255 characters with their extension.
pub(super) const MOST_CHARACTERS: usize = 240;

/// Returns whether a mechanism may have this name: a C identifier that is no device of Windows, and
/// no longer than a file's name.
#[must_use]
pub fn is_identifier(name: &str) -> bool {
    is_c_identifier(name) && !is_device(name) && name.len() <= MOST_CHARACTERS
}

/// Returns an identifier similar to a name that is none: a word of C, a device of Windows, or one that
/// is too long.
#[must_use]
pub fn similar_identifier(name: &str) -> Option<String> {
    /// Length of a name that stays legible.
    const LEGIBLE: usize = 40;
    let start = name.get(..LEGIBLE).unwrap_or(name);
    let similar = [start.to_owned(), format!("{start}_1")];
    similar.into_iter().find(|similar| is_identifier(similar))
}

/// Returns whether `name` is an identifier of the C language and none of its words.
pub(super) fn is_c_identifier(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_')
        && !c_keywords().any(|word| word == name)
}

/// Names with their meanings, and a bounded number of suggestions for wrong ones.
#[derive(Debug)]
pub(super) struct NameTable<'a, T> {
    meanings: HashMap<&'a str, T>,
    suggestions_left: Cell<u32>,
}

impl<'a, T: Copy> NameTable<'a, T> {
    pub(super) fn new() -> Self {
        Self {
            meanings: HashMap::new(),
            suggestions_left: Cell::new(MAX_SUGGESTIONS),
        }
    }

    /// Adds a name; keeps and returns the meaning of one that the table has already.
    pub(super) fn insert(&mut self, name: &'a str, meaning: T) -> Option<T> {
        let earlier = self.get(name);
        if earlier.is_none() {
            self.meanings.insert(name, meaning);
        }
        earlier
    }

    pub(super) fn get(&self, name: &str) -> Option<T> {
        self.meanings.get(name).copied()
    }

    /// Returns all names with their meanings, in the order of the names.
    pub(super) fn in_order(&self) -> Vec<(&'a str, T)> {
        let mut all: Vec<_> = self
            .meanings
            .iter()
            .map(|(name, of)| (*name, *of))
            .collect();
        all.sort_unstable_by_key(|(name, _)| *name);
        all
    }

    /// Returns help for a name that is not in the table: the nearest one, otherwise all if they are
    /// few.
    pub(super) fn help(&self, name: &str) -> Option<String> {
        help(name, &self.candidates()?, &[])
    }

    /// Returns help for such a name, if one of the table or of `further` is near.
    pub(super) fn near(&self, name: &str, further: &[&str]) -> Option<String> {
        did_you_mean(name, &[&self.candidates()?, further].concat())
    }

    /// Returns help for a name that is none of its owner's: "expected `crank.phi`, `crank.x`…".
    pub(super) fn of_same_owner(&self, name: &str) -> Option<String> {
        let (owner, _) = name.rsplit_once('.')?;
        let mut names = self.candidates()?;
        names.retain(|known| known.rsplit_once('.').is_some_and(|(of, _)| of == owner));
        list(&names)
    }

    /// Returns the names in order, `None` after too many suggestions.
    pub(super) fn candidates(&self) -> Option<Vec<&'a str>> {
        let left = self.suggestions_left.get().checked_sub(1)?;
        self.suggestions_left.set(left);
        let mut candidates: Vec<&str> = self.meanings.keys().copied().collect();
        candidates.sort_unstable();
        Some(candidates)
    }
}

impl<'a, T: Copy> FromIterator<(&'a str, T)> for NameTable<'a, T> {
    fn from_iter<I: IntoIterator<Item = (&'a str, T)>>(names: I) -> Self {
        let mut table = Self::new();
        for (name, meaning) in names {
            table.insert(name, meaning);
        }
        table
    }
}

/// Returns help for a wrong name: the nearest of `candidates` and `further`, otherwise the
/// candidates if they are few.
pub fn help(name: &str, candidates: &[&str], further: &[&str]) -> Option<String> {
    did_you_mean(name, &[candidates, further].concat()).or_else(|| list(candidates))
}

/// Returns "did you mean `crank`?" if that is near.
pub fn did_you_mean(name: &str, candidates: &[&str]) -> Option<String> {
    nearest(name, candidates).map(|near| format!("did you mean {}?", quoted(near)))
}

/// Returns "expected `x`, `y` or `angle`" if there are few candidates.
fn list(candidates: &[&str]) -> Option<String> {
    (1..=MAX_LISTED)
        .contains(&candidates.len())
        .then(|| format!("expected {}", either(candidates)))
}

/// Returns the candidate nearest to `name` in edit distance, if one is near enough.
pub(super) fn nearest<'a>(name: &str, candidates: &[&'a str]) -> Option<&'a str> {
    let length = name.chars().count();
    if length > MAX_SUGGESTED_LENGTH {
        return None;
    }
    // One slip in a short word, up to one per three letters of a long one. A single letter is near
    // to itself in the other case only.
    let near = if length < 2 { 0 } else { length.div_ceil(3) };
    // `body` for `bodies`; other plurals are one letter longer.
    let is_plural = |candidate: &str| {
        let stem = candidate.strip_suffix("ies");
        stem.is_some_and(|stem| name.strip_suffix('y') == Some(stem))
    };
    let distance = |candidate: &str| {
        if candidate.eq_ignore_ascii_case(name) || is_plural(candidate) {
            Some(0)
        } else if candidate.len().abs_diff(name.len()) > 4 * near {
            None
        } else {
            Some(strsim::damerau_levenshtein(name, candidate)).filter(|d| *d <= near)
        }
    };
    // An abbreviation, such as `deg` of `degree`, counts as farther than any slip.
    let abbreviation = |candidate: &str| {
        let (short, long) = if candidate.len() < name.len() {
            (candidate, name)
        } else {
            (name, candidate)
        };
        (short.len() >= 3 && long.starts_with(short)).then_some(usize::MAX)
    };
    candidates
        .iter()
        .filter(|candidate| candidate.len() <= MAX_SUGGESTED_LENGTH)
        .filter_map(|candidate| {
            let distance = distance(candidate).or_else(|| abbreviation(candidate))?;
            Some((distance, *candidate))
        })
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn legal_names_are_ascii_words_that_start_with_a_letter() {
        for name in ["a", "A1", "crank_2_", "x"] {
            assert!(is_legal(name), "{name}");
        }
        for name in ["", "_a", "1a", "a-b", "a.b", "ä", "a b", "a\0"] {
            assert!(!is_legal(name), "{name}");
        }
    }

    #[test]
    fn devices_have_their_names_in_any_case() {
        for name in ["CON", "nul", "Aux", "prn", "COM0", "COM1", "lpt9"] {
            assert!(is_device(name), "{name}");
        }
        for name in ["", "con1", "com", "com10", "lpt", "crank", "ñul"] {
            assert!(!is_device(name), "{name}");
        }
    }

    #[test]
    fn the_nearest_name_is_one_slip_away() {
        let candidates = ["crank", "coupler", "rocker"];
        assert_eq!(nearest("cranck", &candidates), Some("crank"));
        assert_eq!(nearest("Coupler", &candidates), Some("coupler"));
        assert_eq!(nearest("rokcer", &candidates), Some("rocker"));
        assert_eq!(nearest("slider", &candidates), None);
        assert_eq!(nearest("body", &["joints", "bodies"]), Some("bodies"));
        assert_eq!(nearest("A", &["B"]), None);
        assert_eq!(nearest("a", &["B", "A"]), Some("A"));
        assert_eq!(nearest("degrees", &["degre", "deg"]), Some("degre"));
        assert_eq!(nearest("degree", &["crank", "deg"]), Some("deg"));
        assert_eq!(nearest(&"x".repeat(1_000_000), &candidates), None);
    }

    #[test]
    fn suggestions_are_bounded_in_number() {
        let table: NameTable<()> = [("crank", ())].into_iter().collect();
        for _ in 0..MAX_SUGGESTIONS {
            assert!(table.help("cranc").is_some());
        }
        assert_eq!(table.help("cranc"), None);
    }
}
