//! Entries of an assembly: those that are taken, and those that do not change the mechanism.

use super::tree::Node;
use crate::exchange::others::Others;

/// Entries of the assembly that are taken.
const ASSEMBLY: [&str; 8] = [
    "Name",
    "RefPoints",
    "Parts",
    "ConstraintSets",
    "ForceTorques",
    "ForcesTorques",
    "ConstantGravity",
    "SimulationParameters",
];

/// Entries that do not change the mechanism if there is anything below them.
const SEEN: [&str; 6] = [
    "Notes",
    "RefCurves",
    "RefSurfaces",
    "FeatureOrder",
    "AnimationParameters",
    "Density",
];

/// Settings of the solver.
const SETTINGS: [&str; 9] = [
    "hmin",
    "hmax",
    "errorTol",
    "errorTolPosKine",
    "errorTolAccKine",
    "iterMaxPosKine",
    "iterMaxAccKine",
    "corAbsTol",
    "corRelTol",
];

/// Place of a part or the assembly.
const PLACE: [&str; 4] = ["Position3D", "RotationMatrix", "Velocity3D", "Omega3D"];

/// Entries of a part that are taken.
const PART: [&str; 3] = ["Name", "PrincipalMassMarker", "RefPoints"];

/// Entries of a part's mass that are taken.
const MASS: [&str; 3] = ["Name", "Mass", "MomentOfInertias"];

/// Keys of the numbers that joints have.
pub(super) const NUMBERS: [&str; 7] = [
    "radiusI",
    "radiusJ",
    "pitchRadius",
    "pitch",
    "theIzJz",
    "distanceIJ",
    "offset",
];

/// Entries of joints, motions, limits and forces that are taken, beside the [`NUMBERS`] of joints.
const ITEMS: [&str; 24] = [
    "Name",
    "MarkerI",
    "MarkerJ",
    "MarkerK",
    "MotionJoint",
    "RotationZ",
    "TranslationZ",
    "RotationOrder",
    "rIJI1",
    "rIJI2",
    "rIJI3",
    "angIJJ1",
    "angIJJ2",
    "angIJJ3",
    "Limit",
    "Type",
    "tension",
    "twist",
    "FxOnI",
    "FyOnI",
    "FzOnI",
    "TxOnI",
    "TyOnI",
    "TzOnI",
];

/// Sorts the entries of an assembly.
pub(super) fn sort(assembly: Node, others: &mut Others) {
    sort_below("assembly", assembly, &ASSEMBLY, others);
    for part in assembly.child("Parts").into_iter().flat_map(Node::children) {
        sort_below("part", part, &PART, others);
        if let Some(mass) = part.child("PrincipalMassMarker") {
            sort_below("mass", mass, &MASS, others);
        }
    }
    let sets = assembly.child("ConstraintSets");
    if let Some(sets) = sets {
        sort_below(
            "constraints",
            sets,
            &["Joints", "Motions", "Limits"],
            others,
        );
    }
    let lists = sets.into_iter().flat_map(Node::children);
    let forces = ["ForceTorques", "ForcesTorques"].map(|list| assembly.child(list));
    let taken = [&ITEMS[..], &NUMBERS].concat();
    for list in lists.chain(forces.into_iter().flatten()) {
        for item in list.children() {
            for node in item.children() {
                others.sort(item.text(), node.text(), &taken, &["Tol"]);
            }
        }
    }
    let settings = assembly.child("SimulationParameters");
    for node in settings.into_iter().flat_map(Node::children) {
        let taken = ["tstart", "tend", "hout"];
        others.sort("SimulationParameters", node.text(), &taken, &SETTINGS);
    }
}

/// Sorts the entries below one that are not empty.
fn sort_below(place: &str, node: Node, taken: &[&str], others: &mut Others) {
    let entries = node.children();
    for entry in entries.filter(|entry| entry.children().next().is_some()) {
        if !PLACE.contains(&entry.text()) {
            others.sort(place, entry.text(), taken, &SEEN);
        }
    }
}
