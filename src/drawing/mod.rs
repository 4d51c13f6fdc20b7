//! Drawings of mechanisms: kinematic diagrams as engineers draw them.
//!
//! A [`Scene`] says what there is to draw, in the frames of the bodies: links, joints, drivers,
//! ground. It is the same for every pose. A [`Sheet`] has it on paper at one pose, with lines and
//! letters as large as the reader needs them whatever the mechanism's size. [`svg`] and [`png`]
//! write a sheet. A [`Chart`] is drawn on a sheet as well; an [`animation`] is a page on which the
//! mechanism moves.
//!
//! ```
//! use biela::drawing::{Scene, Sheet, svg};
//! use biela::kinematics::{Path, Solver};
//! use biela::mechanism::{Mechanism, Source};
//!
//! let text = include_str!("../../mechanisms/four_bar.toml");
//! let (mechanism, _) = Mechanism::parse(&Source::new("four_bar.toml", text)).unwrap();
//! let mut solver = Solver::new(mechanism.into()).unwrap();
//! let path = Path::new(solver.mechanism());
//! solver.assemble(&path).unwrap();
//!
//! let scene = Scene::new(&mut solver, true);
//! let sheet = Sheet::new(&scene, &solver.pose().q);
//! let picture = svg::write(&sheet, 640, false);
//! assert!(picture.contains("coupler"));
//! ```

pub mod animation;
mod chart;
mod compose;
mod labels;
mod lettering;
mod motion;
mod outline;
mod palette;
pub mod png;
mod rider;
mod scene;
mod sheet;
pub mod svg;
mod symbols;
mod ticks;

pub use chart::{Axis, Chart, Line, Panel};
pub use palette::Colour;
pub use scene::{Anchor, Frame, Held, Scene, Symbol, WaySide};
pub use sheet::Sheet;
