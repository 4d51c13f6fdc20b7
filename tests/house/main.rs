//! The sources themselves: imports and comments.

mod joints;
mod language;
mod layers;
mod messages;
