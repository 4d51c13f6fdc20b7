//! Mutations without an engine: the same inputs every time, for the tests.

/// A source of numbers that look random (xorshift, G. Marsaglia, J. Stat. Softw. 8 (2003) 14).
#[derive(Debug)]
pub struct Chance(u64);

impl Chance {
    /// The same numbers for the same seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        // Zero would stay zero.
        Self(seed | 1 << 63)
    }

    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// A number below `end`, which is positive.
    pub fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }

    /// A number from `low` to `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.next() >> 11) as f64 / (1_u64 << 53) as f64)
    }

    fn byte(&mut self) -> u8 {
        self.next() as u8
    }
}

/// Replacements of numbers and brackets of a text.
const TOKENS: [&str; 24] = [
    "0",
    "-1",
    "1e-300",
    "1e300",
    "1e999",
    "nan",
    "inf",
    "-0.0",
    "0x7fffffffffffffff",
    "\"t\"",
    "\"1/0\"",
    "\"sqrt(-1)\"",
    "\"pi^1e9\"",
    "[]",
    "{}",
    "[[",
    "]]",
    "\"\"",
    "\n",
    "= ",
    "\"ground.O\"",
    "true",
    "1979-05-27",
    "\"theta\"",
];

/// Changes a text or other bytes here and there, as `chance` has it; `others` lend parts.
pub fn mutate(bytes: &mut Vec<u8>, others: &[Vec<u8>], chance: &mut Chance) {
    for _ in 0..=chance.below(4) {
        let at = chance.below(bytes.len() + 1);
        let scale = 1 << chance.below(8);
        let length = 1 + chance.below(scale);
        let end = bytes.len().min(at + length);
        match chance.below(8) {
            0 if at < bytes.len() => bytes[at] = chance.byte(),
            1 if at < bytes.len() => bytes[at] ^= 1 << chance.below(8),
            2 => drop(bytes.drain(at..end)),
            3 => {
                let part = bytes[at..end].to_vec();
                let to = chance.below(bytes.len() + 1);
                bytes.splice(to..to, part);
            }
            4 => {
                let other = &others[chance.below(others.len())];
                let from = chance.below(other.len() + 1);
                let until = other.len().min(from + length);
                bytes.splice(at..end, other[from..until].iter().copied());
            }
            5 => {
                let new: Vec<u8> = (0..length.min(16)).map(|_| chance.byte()).collect();
                bytes.splice(at..at, new);
            }
            _ => {
                // A word gives way to another.
                let is_word = |byte: &u8| !b" \t\n,=[]{}\"".contains(byte);
                let before = bytes[..at]
                    .iter()
                    .rev()
                    .take_while(|byte| is_word(byte))
                    .count();
                let after = bytes[at..].iter().take_while(|byte| is_word(byte)).count();
                let token = TOKENS[chance.below(TOKENS.len())].bytes();
                bytes.splice(at - before..at + after, token);
            }
        }
    }
}
