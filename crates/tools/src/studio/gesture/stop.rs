//! Stops: limits of a coordinate.

use super::{Editing, Refusal};
use crate::write::degrees;
use biela::mechanism::{Coordinate, CoordinateKind, Mechanism, rounded};

/// Usual way of an angle to each of its stops \[rad\].
const ANGLE: f64 = std::f64::consts::PI / 6.0;
/// Usual way of a length to each of its stops, in parts of the drawing's size.
const WAY: f64 = 0.25;
/// Significant digits of a usual limit of a length.
const DIGITS: usize = 2;
/// Decimals of a limit of an angle \[deg\].
const ANGLE_DECIMALS: usize = 3;
/// Significant digits of a value in a message.
const SHOWN: usize = 4;

/// Adds stops on both sides of where a `driver`, a freedom or a measure is drawn, or the coordinate of a
/// `joint`; or at the limits \[m or rad\] that the gesture gives.
pub(super) fn stop(
    editing: &mut Editing,
    driver: Option<&str>,
    joint: Option<&str>,
    given: [Option<f64>; 2],
) -> Result<(), Refusal> {
    let mechanism = editing.mechanism()?;
    let (coordinate, keys, word) = match (driver, joint) {
        (Some(name), _) => {
            let named = known(mechanism).find(|(known, _)| *known == name);
            let (_, coordinate) =
                named.ok_or_else(|| Refusal::Because(format!("there is no driver `{name}`")))?;
            (coordinate, format!("of = \"{name}\""), name.to_owned())
        }
        (None, Some(name)) => {
            let coordinate = editing.joint(name)?.free_coordinate().ok_or_else(|| {
                Refusal::Because(format!(
                    "joint `{name}` has no coordinate of its own to be limited: choose a pin or a \
                     slide"
                ))
            })?;
            let keys = match known(mechanism).find(|(_, other)| *other == coordinate) {
                Some((known, _)) => format!("of = \"{known}\""),
                None => editing.coordinate_keys(coordinate)?,
            };
            (coordinate, keys, name.to_owned())
        }
        (None, None) => return Err("a stop limits a driver or a joint".into()),
    };
    let limits = limits(editing, given, coordinate)?;
    let name = editing.names.new_name(&format!("{word}_stop"));
    let value = format!("{{ {keys}, {limits} }}");
    editing.text.set(&["stops", &name], &value);
    Ok(())
}

/// Returns the names and coordinates of drivers, freedoms and measures.
pub(super) fn known(mechanism: &Mechanism) -> impl Iterator<Item = (&str, Coordinate)> {
    let drivers = mechanism.drivers.iter();
    let drivers = drivers.map(|driver| (&*driver.name, driver.coordinate));
    let measures = mechanism.measures.iter();
    drivers.chain(measures.map(|measure| (&*measure.name, measure.coordinate)))
}

/// Writes the limits of a coordinate, which have its present value between them.
fn limits(
    editing: &Editing,
    given: [Option<f64>; 2],
    coordinate: Coordinate,
) -> Result<String, Refusal> {
    let mechanism = editing.mechanism()?;
    let is_angle = coordinate.kind.is_angle();
    let mut drivers = mechanism.drivers.iter();
    // Angles of drivers count turns.
    let start = drivers.find(|driver| driver.coordinate == coordinate);
    let start = start.and_then(biela::mechanism::Driver::start);
    let now = start.unwrap_or_else(|| editing.drawn.value(coordinate));
    let [min, max] = match given {
        [None, None] if is_angle => [Some(now - ANGLE), Some(now + ANGLE)],
        [None, None] => {
            let way = rounded(WAY * editing.drawn.size(), DIGITS);
            let least = match coordinate.kind {
                CoordinateKind::Distance => (now - way).max(now / 2.0),
                _ => now - way,
            };
            [Some(least), Some(now + way)]
        }
        given => given,
    };
    let slack = editing.same();
    if min.is_some_and(|min| now < min - slack) || max.is_some_and(|max| now > max + slack) {
        let at = if is_angle {
            format!("{}°", rounded(now.to_degrees(), SHOWN))
        } else {
            format!("{} m", rounded(now, SHOWN))
        };
        return Err(format!("it is at {at} now: choose limits on both sides of that").into());
    }
    if let [Some(min), Some(max)] = [min, max]
        && min >= max
    {
        return Err("`min` is not below `max`".into());
    }
    // A limit may be turns away.
    let write = |value: f64| {
        if is_angle {
            degrees(value, ANGLE_DECIMALS)
        } else {
            editing.usual(value)
        }
    };
    let limits = [("min", min), ("max", max)].into_iter();
    let limits = limits.filter_map(|(key, limit)| Some(format!("{key} = {}", write(limit?))));
    Ok(limits.collect::<Vec<_>>().join(", "))
}
