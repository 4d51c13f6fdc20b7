//! A cylinder: a driver of the distance between two points.

use super::{Editing, Refusal, Target};

/// Adds a driver of the distance between two points of different bodies; one on the bare sheet is a
/// point of ground.
pub(super) fn cylinder(editing: &mut Editing, points: &[Target]) -> Result<(), Refusal> {
    let [from, to] = points else {
        return Err("a cylinder has two ends".into());
    };
    let ends = [editing.marker_at(from)?, editing.marker_at(to)?];
    let owner = |path: &str| path.split('.').next().unwrap_or_default().to_owned();
    if owner(&ends[0]) == owner(&ends[1]) {
        return Err("both ends of the cylinder are on one body: put one of them on another".into());
    }
    let places = [from, to].map(|target| match &target.onto {
        super::Onto::Marker(path) => {
            let marker = editing.marker(path)?;
            let [x, y, _] = editing.drawn.place(marker);
            Ok([x, y])
        }
        _ => Ok(target.at),
    });
    let [a, b]: [Result<[f64; 2], Refusal>; 2] = places;
    let (a, b) = (a?, b?);
    let long = f64::hypot(b[0] - a[0], b[1] - a[1]);
    if long <= editing.same() {
        return Err("the ends of the cylinder are one point".into());
    }
    let name = editing.names.new_name("cylinder");
    let value = format!(
        "{{ coordinate = \"distance\", markers = [\"{}\", \"{}\"], start = {} }}",
        ends[0],
        ends[1],
        editing.length(long)
    );
    editing.text.set(&["drivers", &name], &value);
    Ok(())
}
