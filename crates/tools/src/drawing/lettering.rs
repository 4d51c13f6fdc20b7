//! Widths of texts: those of Helvetica, which fonts of browsers share or come near to.

/// Height of capitals over the baseline, in units of letters.
pub(super) const CAPITALS: f64 = 10.0;
/// Depth of descenders under the baseline, in units of letters.
pub(super) const DESCENDERS: f64 = 3.0;
/// Size of a font over the height of its capitals.
pub(super) const FONT_SIZE: f64 = 1.39;
/// Widths of characters in Helvetica, in thousandths of the size of the font; others have the width
/// of a digit.
const WIDTHS: [(&str, f64); 12] = [
    ("ijl", 222.0),
    ("ft I.:,;/[]", 278.0),
    ("r-()²", 333.0),
    ("ckvxyszJ", 500.0),
    ("abdeghnopqu_L0123456789", 556.0),
    ("=", 584.0),
    ("FTZ", 611.0),
    ("ABEKPSVXY", 667.0),
    ("wCDHNRU", 722.0),
    ("GOQ", 778.0),
    ("mM", 833.0),
    ("W", 944.0),
];
const DIGIT: f64 = 556.0;

/// Returns the width of a text whose capitals are `height` high.
pub(super) fn width(text: &str, height: f64) -> f64 {
    let of = |character| {
        let known = WIDTHS.iter().find(|(same, _)| same.contains(character));
        known.map_or(DIGIT, |(_, width)| *width)
    };
    let thousandths: f64 = text.chars().map(of).sum();
    thousandths / 1000.0 * FONT_SIZE * height
}

#[cfg(test)]
mod tests {
    use super::*;

    // Times 1000 over the size of the font, as its makers tell them.
    #[test]
    fn widths_are_those_of_helvetica() {
        for (text, expected) in [
            ("Width", 944.0 + 222.0 + 556.0 + 278.0 + 556.0),
            ("é", 556.0),
        ] {
            assert!((width(text, 1.0) - 1.39e-3 * expected).abs() < 1e-12);
        }
    }
}
