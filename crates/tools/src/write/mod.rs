//! Writer of mechanism files: numbers, sections, and changes of a text in place.
//!
//! | file | subject |
//! |---|---|
//! | `number` | numbers and estimates as a file has them, each in the unit of the one before |
//! | `section` | the sections in their order, and entries of a table |
//! | `text` | [`TomlText`]: the text of a file, changed as a person would |
//! | `braces` | entries of a table in braces, with their commas and comments |
//! | `places` | its keys and texts at their places |

mod braces;
mod number;
mod places;
mod section;
mod text;

pub use number::{NumberInUnit, degrees, estimate, in_unit, largest_coordinate, written};
pub use places::WrittenText;
pub use section::{in_braces, in_lines, sections};
pub use text::TomlText;
