//! `biela draw`

use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::RangedI64ValueParser;

use crate::cli::given::bounds::{Bounds, driver_named, no_driver};
use crate::cli::given::conditions::Conditions;
use crate::cli::given::input::Input;
use crate::cli::given::input_files::InputFiles;
use crate::cli::given::signals::Signals;
use crate::cli::motion::SignalledMotion;
use crate::cli::results::output::{tell_written, write};
use crate::cli::results::picture::{Format, extension};
use crate::cli::told::error::Error;
use crate::cli::told::message::Message;
use crate::drawing::{Diagram, Followed, ForcePlace, usual_driver};
use crate::exchange::WorkshopDrawing;
use biela::dynamics::Motion;
use biela::mechanism::Mechanism;

/// Draw a mechanism as a kinematic diagram, in SVG or PNG, or for the workshop, in DXF.
///
/// The picture shows the pose at the start: at the drivers' start values, or as --drive and --set
/// say. It has bodies, joints, ground, the drivers with their names, and the points of interest
/// (`[outputs] markers`) with their paths. The paths cover the prescribed motions until the file's
/// stop time. If no motion is prescribed, they cover the turns, at most eight, after which the
/// first driver that is an angle brings the mechanism back, or the part of one turn both ways that
/// it can reach and its `min` and `max` permit; without an angle, the first driver between its limits.
/// With --driver, --from or --to they cover the range of one driver.
///
/// A DXF is in millimetres: bodies on layers of their names, pins as circles, paths, and the
/// contours of cams and curves as arcs within 0.001 mm.
///
/// The same file gives the same picture, a PNG the same bytes on every machine.
#[derive(Args, Debug)]
#[command(after_help = "Examples:\n  \
        biela draw four_bar.toml --drive 'crank_angle = 120*deg' -o four_bar.svg\n  \
        biela draw four_bar.toml --poses 8 --dimensions -o four_bar.png")]
pub(in crate::cli) struct Draw {
    /// The mechanism file.
    file: PathBuf,
    /// The picture to write; its extension, .svg, .png or .dxf, decides, and `-` is SVG to stdout
    /// [default: the mechanism's name with .svg in the current folder].
    #[arg(short, long, value_name = "PICTURE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    conditions: Conditions,
    /// Add this number of poses, spread evenly over the motion that the paths cover, as faint
    /// outlines; without angles the first driver moves.
    #[arg(
        long,
        value_name = "NUMBER",
        default_value = "0",
        hide_default_value = true,
        allow_negative_numbers = true,
        value_parser = RangedI64ValueParser::<u32>::new().range(0..=100)
    )]
    poses: u32,
    /// The driver that moves for paths and poses, from one limit to the other, while the others are
    /// held [default, with --from or --to: the first one that is an angle, or the first one].
    #[arg(long, value_name = "DRIVER")]
    driver: Option<String>,
    #[command(flatten)]
    bounds: Bounds,
    /// Add letters of the joints, the lengths between the joints and points of interest of each body,
    /// and the offsets of guides, in the unit in which the file shows lengths.
    #[arg(long)]
    dimensions: bool,
    /// Add the instant centre of each body and ground, at the velocities of --drive and of the
    /// file's motions; if all are zero, while the driver of --driver or the first angle moves
    /// alone.
    #[arg(long)]
    instant_centres: bool,
    /// Add the clearance of each contact: a dot where its shapes touch, otherwise a line between
    /// their nearest places.
    #[arg(long)]
    contacts: bool,
    /// Width of the picture in pixels; lines and letters grow with it [default: 1600 for a PNG; 640
    /// for an SVG, more where many bodies need the room].
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
    pub(in crate::cli) fn run(self) -> Result<(), Error> {
        if let Some(path) = self.output.as_deref()
            && extension(path) == "dxf"
        {
            return self.for_the_workshop(path);
        }
        let format = self.output.as_deref().map_or(Ok(Format::Svg), Format::of)?;
        let input = Input::read(&self.file)?;
        if self.forces {
            input.check_dynamics()?;
        }
        if self.contacts {
            input.check_contacts()?;
        }
        let usual = || PathBuf::from(format!("{}.svg", input.mechanism.name));
        let path = self.output.clone().unwrap_or_else(usual);
        InputFiles::new(&self.file, &input.mechanism).refuse_as_outputs(&[Some(&path)])?;
        let followed = self.followed(&input.mechanism)?;
        let mut solver = self.conditions.solver_at_start(&input)?;
        let mut forces = Vec::new();
        if self.forces {
            let start = solver.pose().time;
            let motion = SignalledMotion::from(solver, Signals::default(), start);
            let motion = motion.and_then(|motion| motion.with_forces(true));
            let motion = motion.map_err(|error| input.error(error))?;
            let Motion {
                solver: moved,
                solution,
                ..
            } = motion.motion;
            solver = moved;
            let places = ForcePlace::sought(&mut solver, &solution);
            let values = ForcePlace::values(&places, &solver, &solution);
            forces = places.into_iter().zip(values).collect();
        }
        let diagram = Diagram {
            traces: !self.no_traces,
            followed,
            poses: self.poses as usize,
            dimensions: self.dimensions,
            instant_centres: self.instant_centres,
            contacts: self.contacts,
            forces,
        };
        let sheet = diagram
            .sheet(&mut solver)
            .map_err(|error| input.error(error))?;
        let width = self.width.unwrap_or(format.width(sheet.width()));
        format.write(&path, &sheet, width, self.transparent)
    }

    /// Writes a DXF.
    fn for_the_workshop(&self, path: &Path) -> Result<(), Error> {
        let options = [
            ("--poses", self.poses > 0),
            ("--dimensions", self.dimensions),
            ("--instant-centres", self.instant_centres),
            ("--contacts", self.contacts),
            ("--width", self.width.is_some()),
            ("--forces", self.forces),
            ("--transparent", self.transparent),
        ];
        if let Some((option, _)) = options.into_iter().find(|(_, given)| *given) {
            return Err(Error::Usage(format!(
                "{option} is of pictures: leave it out for a drawing in DXF"
            )));
        }
        let input = Input::read(&self.file)?;
        InputFiles::new(&self.file, &input.mechanism).refuse_as_outputs(&[Some(path)])?;
        let diagram = Diagram {
            traces: !self.no_traces,
            followed: self.followed(&input.mechanism)?,
            ..Diagram::default()
        };
        let mut solver = self.conditions.solver_at_start(&input)?;
        let scene = diagram.scene(&mut solver);
        let drawing = WorkshopDrawing::new(&scene, &solver);
        write(path, drawing.text.as_bytes())?;
        for note in drawing.notes {
            Message::Warning(note.to_string()).show();
        }
        tell_written(path);
        Ok(())
    }

    /// Returns the driver that options name or bound.
    fn followed(&self, mechanism: &Mechanism) -> Result<Option<Followed>, Error> {
        let driver = match &self.driver {
            Some(name) => driver_named(mechanism, name)?,
            None if self.bounds.is_empty() && self.poses > 0 && mechanism.drivers.is_empty() => {
                return Err(no_driver("--poses"));
            }
            None if self.bounds.is_empty() => return Ok(None),
            None => usual_driver(mechanism).ok_or_else(|| no_driver("--from, --to"))?,
        };
        let bounds = self.bounds.of(&self.conditions, mechanism, driver)?;
        Ok(Some(Followed { driver, bounds }))
    }
}
