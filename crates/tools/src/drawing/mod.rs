//! Drawings of mechanisms: kinematic diagrams as engineers draw them.
//!
//! A [`Scene`] holds the symbols of a mechanism in the frames of its bodies: links, joints,
//! drivers, ground. It is the same for every pose. A [`Sheet`] has the scene on paper at one pose,
//! with lines and letters of a readable size whatever the mechanism's size. [`svg`] and [`png`]
//! write a sheet. A [`LineChart`] is drawn on a sheet as well; an [`animation`] is a page on which the
//! mechanism moves.
//!
//! | module | subject |
//! |---|---|
//! | `outline` | lines and curves in the plane |
//! | `anchor`, `attachment` | frames on bodies, and frames that marks move with |
//! | `sheet`, `label` | marks and texts on paper, and places of names |
//! | [`symbol`] | one file per symbol: its joint, its shape, its motion |
//! | `force_place` | forces that pictures show, and where they act |
//! | `sweep`, `scene`, `layout` | the motion shown, all symbols, and their fit on a sheet |
//! | `diagram` | what a diagram shows on demand |
//!
//! ```
//! use biela_tools::drawing::{Scene, Sheet, svg};
//! use biela::kinematics::{Path, Solver};
//! use biela::mechanism::{Mechanism, Source};
//!
//! let text = include_str!("../../../../mechanisms/four_bar.toml");
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

mod anchor;
pub mod animation;
mod attachment;
mod chart;
mod diagram;
mod force_place;
mod label;
mod layout;
mod lettering;
mod outline;
mod palette;
#[cfg(feature = "program")]
pub mod png;
mod scene;
mod sheet;
#[cfg(feature = "program")]
mod stencil;
pub mod svg;
mod sweep;
pub mod symbol;
mod ticks;

pub use anchor::{Anchor, Frame};
pub use chart::{Axis, COLOURS, Line, LineChart, Panel};
pub use diagram::{Diagram, Followed};
pub use force_place::ForcePlace;
pub use palette::Colour;
pub use scene::Scene;
pub use sheet::Sheet;
pub use sweep::usual_driver;
pub use symbol::Symbol;
