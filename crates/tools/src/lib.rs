//! The program `biela` and what it is made of, on the library [`biela`].
//!
//! | layer | subject |
//! |---|---|
//! | [`mod@write`] | the text of a mechanism file: places, numbers, estimates, changes that keep the rest |
//! | [`drawing`] | pictures: a scene in the frames of the bodies, a sheet, its files |
//! | [`page`] | a mechanism that is moved by hand, drawn and saved: what a page holds |
//! | [`studio`] | a mechanism that is drawn by hand: gestures as changes of its file |
//! | [`exchange`] | mechanisms of other programs, read and written |
//! | [`cli`] | the commands of the program |
//!
//! Each layer uses only layers above it in this table. The solver inside a page needs neither the
//! feature `program` nor what it brings: `cli`, `exchange`, pictures as PNG and GIF.

#[cfg(feature = "program")]
pub mod cli;
pub mod drawing;
#[cfg(feature = "program")]
pub mod exchange;
pub mod page;
#[cfg(feature = "program")]
pub mod studio;
pub mod write;
