//! `biela draw`

use std::path::PathBuf;

use clap::Args;
use clap::builder::RangedI64ValueParser;

use super::conditions::Conditions;
use super::error::Error;
use super::input::Input;
use super::message::tell;
use super::originals::Originals;
use super::picture::Format;
use crate::drawing::{Scene, Sheet};

/// Draw a mechanism as a kinematic diagram, in SVG or PNG.
///
/// Shown is the pose at the start: at the drivers' start values, or where --drive and --set say.
/// There are bodies, joints, ground, the drivers with their names, and the points of interest
/// (`[outputs] markers`) with the paths that they take: over the prescribed motions until the
/// file's stop time or, if none moves, over turns of the first driver that is an angle: as many,
/// up to eight, as bring the mechanism back, or one, as far as it gets both ways.
///
/// The same file gives the same picture.
#[derive(Args, Debug)]
#[command(
    after_help = "Example: biela draw four_bar.toml --drive 'crank_angle = 120*deg' -o four_bar.svg"
)]
pub(super) struct Draw {
    /// The mechanism file.
    file: PathBuf,
    /// The picture to write; its extension, .svg or .png, decides, and `-` is SVG to stdout
    /// [default: the mechanism's name with .svg in the current folder].
    #[arg(short, long, value_name = "PICTURE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    conditions: Conditions,
    /// Width of the picture in pixels; lines and letters grow with it [default: 640, more where
    /// many bodies need the room].
    #[arg(
        long,
        value_name = "PIXELS",
        allow_negative_numbers = true,
        value_parser = RangedI64ValueParser::<u32>::new().range(16..=8192)
    )]
    width: Option<u32>,
    /// Leave out the paths of the points of interest.
    #[arg(long)]
    no_traces: bool,
    /// Leave out the white background.
    #[arg(long)]
    transparent: bool,
}

impl Draw {
    pub(super) fn run(self) -> Result<(), Error> {
        let format = self.output.as_deref().map_or(Ok(Format::Svg), Format::of)?;
        let input = Input::read(&self.file)?;
        let is_named = self.output.is_some();
        let path = self
            .output
            .unwrap_or_else(|| PathBuf::from(format!("{}.svg", input.mechanism.name)));
        Originals::new(&self.file, &input.mechanism).refuse_as(&[Some(&path)])?;
        let mut solver = self.conditions.solver_at_start(&input)?;
        let scene = Scene::new(&mut solver, !self.no_traces);
        let sheet = Sheet::new(&scene, &solver.pose().q);
        let width = self.width.unwrap_or(sheet.width());
        format.write(&path, &sheet, width, self.transparent)?;
        if !is_named {
            tell(format_args!("wrote {}", path.display()));
        }
        Ok(())
    }
}
