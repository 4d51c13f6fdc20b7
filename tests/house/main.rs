//! The sources themselves: imports and comments.

mod language;
mod layers;
