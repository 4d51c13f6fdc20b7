//! Sketch of a drawing, for the pointer to find: points, bars, joints, drivers, and their names.

use serde_json::{Value, json};

use super::drawn::Drawn;
use biela::mechanism::{Body, Joint, MarkerId, Mechanism};

/// Describes what is drawn. Points are global \[m\], angles in radians.
///
/// `points` have a place `at`, the paths of their `markers`, the `joints` there, and whether they are
/// on `ground`; `bodies` a `name`, a `frame` and the ends of their `bars`; `joints`, `drivers` and
/// `forces` their names and where they are. The document adds the names of what has no place.
pub(super) fn sketch(drawn: &Drawn) -> Value {
    let Some(mechanism) = &drawn.mechanism else {
        return json!({
            "points": [], "bodies": [], "joints": [], "drivers": [], "forces": [], "stops": [],
            "parameters": [], "size": 0.0,
        });
    };
    let named = |id: usize| !mechanism.markers[id].name.is_empty();
    let markers = (0..mechanism.markers.len())
        .filter(|id| named(*id))
        .map(MarkerId);
    json!({
        "points": points(drawn, mechanism, markers.collect()),
        "bodies": bodies(drawn, mechanism),
        "joints": mechanism.joints.iter().map(|joint| {
            let [x, y, angle] = drawn.place(joint.from);
            json!({
                "name": joint.name,
                "is_pin": joint.is_pin(),
                "at": [x, y],
                "to": &drawn.place(joint.to)[..2],
                "angle": angle,
                "markers": paths(mechanism, [joint.from, joint.to]),
                "drives": joint.free_coordinate().is_some(),
            })
        }).collect::<Vec<_>>(),
        "drivers": mechanism.drivers.iter().map(|driver| {
            let coordinate = driver.coordinate;
            let at = [coordinate.from, coordinate.to].map(|id| drawn.place(id));
            json!({
                "name": driver.name,
                "is_free": driver.is_free(),
                "coordinate": coordinate.kind.word(),
                "at": &at[0][..2],
                "to": &at[1][..2],
                "markers": paths(mechanism, [coordinate.from, coordinate.to]),
            })
        }).collect::<Vec<_>>(),
        "forces": mechanism.forces.iter().map(|force| {
            let coordinate = force.load.coordinate();
            let place = |id: MarkerId| {
                let [x, y, _] = drawn.place(id);
                [x, y]
            };
            json!({
                "name": force.name,
                "coordinate": coordinate.map(|coordinate| coordinate.kind.word()),
                "at": coordinate.map(|coordinate| place(coordinate.from)),
                "to": coordinate.map(|coordinate| place(coordinate.to)),
            })
        }).collect::<Vec<_>>(),
        "stops": mechanism.stops.iter().map(|stop| json!({ "name": stop.name }))
            .collect::<Vec<_>>(),
        "parameters": mechanism.parameters.iter().zip(&drawn.parameters).map(|(parameter, value)| {
            json!({ "name": parameter.name, "value": value })
        }).collect::<Vec<_>>(),
        "traced": mechanism.outputs.markers.iter().map(|id| mechanism.marker_path(*id))
            .collect::<Vec<_>>(),
        "size": drawn.size(),
    })
}

fn points(drawn: &Drawn, mechanism: &Mechanism, mut left: Vec<MarkerId>) -> Vec<Value> {
    let near = drawn.same();
    let mut points = Vec::new();
    while let Some(&first) = left.first() {
        let [x, y, angle] = drawn.place(first);
        let here = |marker: &MarkerId| {
            let [u, v, _] = drawn.place(*marker);
            f64::hypot(u - x, v - y) <= near
        };
        let (together, apart): (Vec<_>, Vec<_>) = left.iter().copied().partition(here);
        left = apart;
        let is_here = |joint: &&Joint| {
            together.contains(&joint.from) && together.contains(&joint.to)
                || (joint.guide()).is_some_and(|guide| guide.aside.is_none())
                    && (together.contains(&joint.from) || together.contains(&joint.to))
        };
        let joints = mechanism.joints.iter().filter(is_here);
        let on_ground = |marker: &MarkerId| mechanism.markers[marker.index()].body.is_none();
        points.push(json!({
            "at": drawn.point(first),
            "angle": angle,
            "markers": together.iter().map(|m| mechanism.marker_path(*m)).collect::<Vec<_>>(),
            "joints": joints.map(|joint| &joint.name).collect::<Vec<_>>(),
            "ground": together.iter().any(on_ground),
        }));
    }
    points
}

fn bodies(drawn: &Drawn, mechanism: &Mechanism) -> Vec<Value> {
    let bodies = mechanism.bodies.iter().enumerate();
    let bodies = bodies.map(|(index, body)| {
        let places: Vec<[f64; 3]> = body.markers.iter().map(|id| drawn.place(*id)).collect();
        let count = places.len();
        let sides = match count {
            0 | 1 => 0,
            2 => 1,
            _ => count,
        };
        let bars = (0..sides).map(|k| {
            let (from, to) = (places[k], places[(k + 1) % count]);
            [[from[0], from[1]], [to[0], to[1]]]
        });
        json!({
            "name": body.name,
            "is_wheel": is_wheel(mechanism, body),
            "frame": drawn.frame(Some(biela::mechanism::BodyId(index))),
            "markers": body.markers.iter().map(|id| mechanism.marker_path(*id)).collect::<Vec<_>>(),
            "bars": bars.collect::<Vec<_>>(),
            "mass": mechanism.weight_at(biela::mechanism::BodyId(index), &drawn.parameters).map(|weight| weight.mass),
        })
    });
    bodies.collect()
}

/// Returns whether a body is a wheel, or a cam: it has a face around its centre.
fn is_wheel(mechanism: &Mechanism, body: &Body) -> bool {
    let round =
        (mechanism.joints.iter()).filter(|joint| joint.wheels().is_some() || joint.cam().is_some());
    let mut ends = round.flat_map(|joint| [joint.from, joint.to]);
    ends.any(|id| body.markers.contains(&id))
}

fn paths(mechanism: &Mechanism, markers: [MarkerId; 2]) -> [String; 2] {
    markers.map(|id| mechanism.marker_path(id))
}
