//! A cylinder: a driver of the distance between two points.

use super::{Editing, Refusal, Target};

/// Adds a driver of the distance between two points of different bodies; one on the bare sheet is a
/// point of ground.
pub(super) fn cylinder(editing: &mut Editing, points: &[Target]) -> Result<(), Refusal> {
    let (ends, long) = ends(editing, "cylinder", points)?;
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

/// Returns the markers at two points of different bodies, which are added if there are none, and the
/// distance between them \[m\].
pub(super) fn ends(
    editing: &mut Editing,
    noun: &str,
    points: &[Target],
) -> Result<([String; 2], f64), Refusal> {
    let [from, to] = points else {
        return Err(format!("a {noun} has two ends").into());
    };
    let [a, b] = [editing.settled(from)?, editing.settled(to)?];
    let long = f64::hypot(b[0] - a[0], b[1] - a[1]);
    if long <= editing.same() {
        return Err(format!("the ends of the {noun} are one point").into());
    }
    let ends = [editing.marker_at(from)?, editing.marker_at(to)?];
    let owner = |path: &str| path.split('.').next().unwrap_or_default().to_owned();
    if owner(&ends[0]) == owner(&ends[1]) {
        return Err(
            format!("both ends of the {noun} are on one body: put one of them on another").into(),
        );
    }
    Ok((ends, long))
}
