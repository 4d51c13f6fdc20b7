//! Files of other programs: whatever the bytes, they are a mechanism file or it is told why not.

use biela::mechanism::{Mechanism, Source};
use biela_tools::exchange::{Format, LengthUnit};

/// More bytes bring nothing new, only time.
const LONGEST: usize = 1 << 16;

/// Reads the bytes in every format; what is read is written as a file without errors of syntax.
///
/// # Panics
///
/// A fault of biela.
pub fn run(data: &[u8]) {
    if data.len() > LONGEST {
        return;
    }
    // A file of any name is read by its content.
    let _ = Format::of("", data);
    for format in [
        Format::Asmt,
        Format::Linkage,
        Format::Pmks,
        Format::Pylinkage,
        Format::Dxf,
    ] {
        for unit in [None, Some(LengthUnit::Millimetre)] {
            let draft = match format.read(data, "fuzz", unit) {
                Ok(draft) => draft,
                Err(error) => {
                    assert!(!error.to_string().contains('\n'), "{error}");
                    continue;
                }
            };
            let text = draft.write("fuzz.dxf");
            let source = Source::new("fuzz.toml", text.as_str());
            if let Err(diagnostics) = Mechanism::parse(&source) {
                for diagnostic in diagnostics {
                    let code = diagnostic.code;
                    let names = ["syntax", "illegal-name", "reserved-name", "duplicate-name"];
                    assert!(!names.contains(&code), "{code}:\n{text}");
                }
            }
        }
    }
}
