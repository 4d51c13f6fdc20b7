//! `biela draw`

use std::path::PathBuf;

use clap::Args;
use clap::builder::RangedI64ValueParser;

use super::conditions::Conditions;
use super::error::Error;
use super::input::Input;
use super::input_files::InputFiles;
use super::motion::Motion;
use super::picture::Format;
use super::signals::Signals;
use crate::drawing::{Scene, Sheet, force_arrows};

/// Draw a mechanism as a kinematic diagram, in SVG or PNG.
///
/// The picture shows the pose at the start: at the drivers' start values, or as --drive and --set
/// say. It has bodies, joints, ground, the drivers with their names, and the points of interest
/// (`[outputs] markers`) with their paths. The paths cover the prescribed motions until the file's
/// stop time. If no motion is prescribed, they cover the turns, at most eight, after which the
/// first driver that is an angle brings the mechanism back, or the part of one turn both ways that
/// it can reach and its `min` and `max` permit.
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
    /// Show forces as arrows with their sizes: what joints and drivers exert, and springs, dampers
    /// and loads. Drivers have the rates of their motions and of --drive, others are at rest.
    #[arg(long)]
    forces: bool,
    /// Leave out the white background.
    #[arg(long)]
    transparent: bool,
}

impl Draw {
    pub(super) fn run(self) -> Result<(), Error> {
        let format = self.output.as_deref().map_or(Ok(Format::Svg), Format::of)?;
        let input = Input::read(&self.file)?;
        if self.forces {
            input.check_dynamics()?;
        }
        let path = self
            .output
            .unwrap_or_else(|| PathBuf::from(format!("{}.svg", input.mechanism.name)));
        InputFiles::new(&self.file, &input.mechanism).refuse_as_outputs(&[Some(&path)])?;
        let mut solver = self.conditions.solver_at_start(&input)?;
        let mut arrows = Vec::new();
        if self.forces {
            let start = solver.pose().time;
            let motion = Motion::from(solver, Signals::default(), start);
            let motion = motion.and_then(Motion::with_forces);
            let mut motion = motion.map_err(|error| input.error(error))?;
            let places = motion.force_places();
            let values = motion.values(&places);
            arrows = force_arrows(&places.into_iter().zip(values).collect::<Vec<_>>());
            solver = motion.solver;
        }
        let mut scene = Scene::new(&mut solver, !self.no_traces);
        scene.symbols.extend(arrows);
        let sheet = Sheet::new(&scene, &solver.pose().q);
        let width = self.width.unwrap_or(sheet.width());
        format.write(&path, &sheet, width, self.transparent)
    }
}
