//! The studio: a mechanism is drawn by hand, and its file is written along.
//!
//! The text of the file is the truth. A gesture changes the text as a person would, comments and
//! layout stay, and the drawing follows from the text; what is typed goes the same way. Undo goes
//! through texts. [`Host`] answers requests in JSON, which the studio's scripts send, and passes on
//! those of [`page`](crate::page), by which the mechanism moves.
//!
//! | file | subject |
//! |---|---|
//! | `reference` | the names in the texts of a file |
//! | `names` | new names |
//! | `unit_of` | the unit of a number by its place |
//! | `drawn` | the mechanism where its file starts it |
//! | `gesture` | gestures, one file each |
//! | `sketch` | what is drawn, for the pointer to find |
//! | `inspect` | what is selected, as a form |
//! | `status` | what a half-done drawing lacks |
//! | `four_bar` | the type of a four-bar |
//! | `document` | a file with its undo |
//! | `request`, `host` | requests and gestures, and [`Host`], which answers them |

mod document;
mod drawn;
mod four_bar;
mod gesture;
mod host;
mod inspect;
mod new_names;
mod reference;
mod request;
mod sketch;
mod status;
#[cfg(test)]
mod tests;
mod unit_of;

pub use host::Host;
