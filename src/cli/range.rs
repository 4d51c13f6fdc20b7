//! `biela range`

mod forces;

use std::fmt::Write as _;
use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;
use forces::describe_largest;

use super::check::scientific;

use super::conditions::{Conditions, unknown};
use super::error::Error;
use super::input::Input;
use super::input_files::InputFiles;
use super::message::Message;
use super::output::{print, tell_written, write};
use super::picture::Format;
use super::plot::{MOST_BODIES, axis, varies};

use super::stdout::is_stdout;
use crate::drawing::{Axis, Chart, Line, Panel, Sheet};
use crate::kinematics::{End, Range as Motion, RangeSettings, Reason, Sample, in_line};
use crate::mechanism::{CoordinateKind, DriverId, Mechanism, Unit, shown};

/// Find how far a driver can go.
///
/// biela follows the driver both ways from the start, and holds the others, until the mechanism
/// returns to its pose or meets a limit. A dead point is located to rounding, and the bodies that
/// line up there are named. The transmission angle is that of the worst pair of links, from 0 deg
/// at a dead point to 90 deg at best; the reciprocal condition is that of `check`.
#[derive(Args, Debug)]
#[command(after_help = "Example: biela range tlv.toml --driver side_length --plot range.svg")]
pub(super) struct Range {
    /// The mechanism file.
    file: PathBuf,
    /// The driver to follow [default: each in turn].
    #[arg(long, value_name = "DRIVER")]
    driver: Option<String>,
    #[command(flatten)]
    conditions: Conditions,
    /// Speed of the driver in m/s or rad/s, for the largest effort and reaction of a mechanism with
    /// masses or forces [default: at rest].
    #[arg(long, value_name = "SPEED", allow_negative_numbers = true)]
    speed: Option<f64>,
    /// Write the poses of the motion: the driver's value, transmission angle, reciprocal condition,
    /// and the position of every body, in SI units; `-` for stdout.
    #[arg(long, value_name = "CSV")]
    csv: Option<PathBuf>,
    /// Plot angles of bodies, transmission angle and reciprocal condition over the driver's value;
    /// the picture's extension, .svg or .png, decides, and `-` is SVG to stdout.
    #[arg(short, long, value_name = "PICTURE")]
    plot: Option<PathBuf>,
}

impl Range {
    pub(super) fn run(self) -> Result<(), Error> {
        let format = self.plot.as_deref().map(Format::of).transpose()?;
        let input = Input::read(&self.file)?;
        InputFiles::new(&self.file, &input.mechanism)
            .refuse_as_outputs(&[self.csv.as_deref(), self.plot.as_deref()])?;
        let drivers = self.drivers(&input.mechanism)?;
        self.check_speed(&input.mechanism)?;
        let mut solver = self.conditions.solver_at_start(&input)?;
        let driven = Arc::clone(solver.mechanism());
        let mut text = String::new();
        for &driver in &drivers {
            let start = solver.pose().drivers[driver.index()];
            let range = solver.range(driver, &RangeSettings::default());
            describe(&mut text, &driven, driver, start, &range);
            if driven.has_dynamics() {
                let speed = self.speed.unwrap_or(0.0);
                describe_largest(&mut text, &mut solver, driver, &range, speed);
            }
            if let Some(path) = &self.csv {
                write(path, table(&driven, driver, &range).as_bytes())?;
                tell_written(path);
            }
            if let (Some(path), Some(format)) = (&self.plot, format) {
                let turning = turning(&driven, &range).count();
                if turning > MOST_BODIES {
                    let note = format!(
                        "the plot shows {MOST_BODIES} of {turning} bodies that turn; --csv has all"
                    );
                    Message::Note(note).show();
                }
                let sheet = Sheet::chart(&chart(&driven, driver, &range));
                format.write_chart(path, &sheet)?;
            }
        }
        // A table or a picture on stdout is not mixed with text.
        if ![self.csv, self.plot]
            .iter()
            .flatten()
            .any(|path| is_stdout(path))
        {
            print(&text)?;
        }
        Ok(())
    }

    /// Refuses a speed that is not finite, or that has no effect.
    fn check_speed(&self, mechanism: &Mechanism) -> Result<(), Error> {
        match self.speed {
            Some(speed) if !speed.is_finite() => Err(Error::Usage(format!(
                "--speed is {speed}; expected a finite number"
            ))),
            Some(_) if !mechanism.has_dynamics() => Err(Error::Usage(
                "--speed is of forces, but the mechanism has neither `mass` nor `[forces]`"
                    .to_owned(),
            )),
            _ => Ok(()),
        }
    }

    fn drivers(&self, mechanism: &Mechanism) -> Result<Vec<DriverId>, Error> {
        if let Some(name) = &self.driver {
            let driver = mechanism.driver_id(name).ok_or_else(|| {
                let names = mechanism.drivers.iter().map(|d| d.name.as_str());
                unknown("--driver", "driver", name, &names.collect::<Vec<_>>())
            })?;
            return Ok(vec![driver]);
        }
        let count = mechanism.drivers.len();
        if count > 1 && (self.csv.is_some() || self.plot.is_some()) {
            return Err(Error::Usage(
                "there are several drivers: --csv and --plot need one, named by --driver"
                    .to_owned(),
            ));
        }
        Ok((0..count).map(DriverId).collect())
    }
}

fn describe(
    text: &mut String,
    mechanism: &Mechanism,
    driver: DriverId,
    start: f64,
    range: &Motion,
) {
    let kind = mechanism.drivers[driver.index()].coordinate.kind;
    let value = |value: f64| with_unit(kind, value);
    let name = &mechanism.drivers[driver.index()].name;
    let gap = if text.is_empty() { "" } else { "\n" };
    let _ = writeln!(text, "{gap}{name}, from {}", value(start));
    if let End::Turns(turns) = range.upper {
        let turns = match turns {
            1 => "a turn".to_owned(),
            turns => format!("{turns} turns"),
        };
        let _ = writeln!(
            text,
            "  turns fully: after {turns} the mechanism is where it was"
        );
    } else {
        for (way, end) in [("down to", &range.lower), ("up to", &range.upper)] {
            let _ = writeln!(text, "  {way:<8}{}", end_text(end, driver, kind));
        }
    }
    for point in &range.crossings {
        let _ = writeln!(
            text,
            "  passes a change point at {} where {}",
            value(point.value),
            in_line(&point.bodies, "")
        );
    }
    let extreme = |of: fn(&Sample) -> Option<f64>| {
        let known = range
            .samples
            .iter()
            .filter_map(|s| Some((of(s)?, s.driver)));
        let worst = known.clone().min_by(|a, b| a.0.total_cmp(&b.0));
        worst.zip(known.max_by(|a, b| a.0.total_cmp(&b.0)))
    };
    if let Some(((worst, at), (best, best_at))) = extreme(|sample| sample.transmission) {
        let [worst, best] = [worst, best].map(|angle| format!("{:.2} deg", angle.to_degrees()));
        let _ = if worst == best {
            writeln!(text, "  transmission angle {worst} everywhere")
        } else {
            let [at, best_at] = [at, best_at].map(value);
            writeln!(
                text,
                "  transmission angle from {worst}, at {at}, to {best}, at {best_at}"
            )
        };
    }
    if let Some(((worst, at), (best, _))) = extreme(|sample| Some(sample.rcond)) {
        let [worst, best] = [worst, best].map(|rcond| scientific(rcond, 2));
        let _ = if worst == best {
            writeln!(text, "  reciprocal condition {worst} everywhere")
        } else {
            let at = value(at);
            writeln!(text, "  reciprocal condition {worst} at worst, at {at}")
        };
    }
}

pub(super) fn end_text(end: &End, driver: DriverId, kind: CoordinateKind) -> String {
    let value = |value: f64| with_unit(kind, value);
    match end {
        End::Turns(_) => "no limit".to_owned(),
        End::Singular(point) => format!("{}: {point}", value(point.drivers[driver.index()])),
        End::Blocked { value: at, reason } => {
            let reason = match reason {
                Reason::Value(error) => error.to_string(),
                Reason::TooLong => "it takes too many sub-steps".to_owned(),
                _ => "no continuous motion leads on".to_owned(),
            };
            format!("{}: {reason}", value(*at))
        }
        // The end of the search is no property of the mechanism: four digits are enough.
        End::NotFound { value: at } => {
            format!("{} and farther: no limit was found", about(kind, *at))
        }
    }
}

/// Formats a value in deg or m with ten decimals: limits are located to rounding.
pub(super) fn with_unit(kind: CoordinateKind, value: f64) -> String {
    let (value, unit) = in_unit(kind, value);
    let text = format!("{value:.10}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    // A smaller value is rounding.
    let text = if text == "-0" { "0" } else { text };
    format!("{text} {unit}")
}

/// Formats a value in deg or m with four digits.
fn about(kind: CoordinateKind, value: f64) -> String {
    let (value, unit) = in_unit(kind, value);
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    format!("{} {unit}", shown(rounded))
}

fn in_unit(kind: CoordinateKind, value: f64) -> (f64, &'static str) {
    if kind.is_angle() {
        (value.to_degrees(), "deg")
    } else {
        (value, "m")
    }
}

fn table(mechanism: &Mechanism, driver: DriverId, range: &Motion) -> String {
    let has_transmission = range.samples.iter().all(|s| s.transmission.is_some());
    let mut text = format!("{}.position", mechanism.drivers[driver.index()].name);
    if has_transmission {
        text.push_str(",transmission_angle");
    }
    text.push_str(",rcond");
    for body in &mechanism.bodies {
        let name = &body.name;
        let _ = write!(text, ",{name}.x,{name}.y,{name}.phi");
    }
    for sample in &range.samples {
        let _ = write!(text, "\n{:?}", sample.driver);
        if let Some(transmission) = sample.transmission.filter(|_| has_transmission) {
            let _ = write!(text, ",{transmission:?}");
        }
        let _ = write!(text, ",{:?}", sample.rcond);
        for value in &sample.q[..3 * mechanism.bodies.len()] {
            let _ = write!(text, ",{value:?}");
        }
    }
    text.push('\n');
    text
}

/// Returns the bodies whose angles change.
fn turning(mechanism: &Mechanism, range: &Motion) -> impl Iterator<Item = usize> {
    (0..mechanism.bodies.len()).filter(|body| {
        let angles: Vec<f64> = range.samples.iter().map(|s| s.q[3 * body + 2]).collect();
        varies(&angles)
    })
}

fn chart(mechanism: &Mechanism, driver: DriverId, range: &Motion) -> Chart {
    let unit = mechanism.drivers[driver.index()].coordinate.kind.unit();
    let factor = unit.display.map_or(1.0, |display| display.factor);
    let line = |name: &str, look: usize, of: &dyn Fn(&Sample) -> f64| Line {
        name: name.to_owned(),
        look,
        values: range.samples.iter().map(of).collect(),
    };
    let mut panels = Vec::new();
    let angles: Vec<Line> = turning(mechanism, range)
        .take(MOST_BODIES)
        .map(|body| {
            let name = format!("{}.phi", mechanism.bodies[body].name);
            line(&name, body, &|s| s.q[3 * body + 2].to_degrees())
        })
        .collect();
    if !angles.is_empty() {
        panels.push(Panel {
            y: axis(Unit::RADIAN),
            lines: angles,
        });
    }
    if range.samples.iter().any(|s| s.transmission.is_some()) {
        panels.push(Panel {
            y: Axis {
                label: "transmission angle".to_owned(),
                unit: "deg".to_owned(),
            },
            lines: vec![line("worst pair of links", 0, &|s| {
                s.transmission.map_or(f64::NAN, f64::to_degrees)
            })],
        });
    }
    panels.push(Panel {
        y: Axis {
            label: "reciprocal condition".to_owned(),
            unit: "1".to_owned(),
        },
        lines: vec![line("rcond", 0, &|s| s.rcond)],
    });
    Chart {
        title: format!(
            "{}: range of {}",
            mechanism.name,
            mechanism.drivers[driver.index()].name
        ),
        description: mechanism.description.clone(),
        x: Axis {
            label: mechanism.drivers[driver.index()].name.clone(),
            unit: axis(unit).unit,
        },
        at: (range.samples.iter())
            .map(|sample| sample.driver * factor)
            .collect(),
        panels,
    }
}
