//! A cam with its follower.

use std::f64::consts::FRAC_PI_2;

use super::wheel::Centre;
use super::{Editing, Follower, Refusal, Target, marker_name};

/// Lift of the follower in parts of the cam's least radius.
const LIFT: f64 = 1.0 / 3.0;
/// Radius of a follower's roller in parts of the cam's least radius.
const ROLLER: f64 = 1.0 / 3.0;

/// Adds a cam at a target on ground, and a follower that slides on a guide of ground along the line
/// from the centre through the contact. The cam's x-axis points to the contact, where its contour is
/// nearest to the centre.
pub(super) fn cam(
    editing: &mut Editing,
    target: &Target,
    contact: [f64; 2],
    follower: Follower,
) -> Result<(), Refusal> {
    let centre = Centre::of(editing, target)?;
    if centre.carriers.iter().all(|body| body != "ground") {
        return Err(
            "the follower slides on ground: put the centre of the cam on ground, too".into(),
        );
    }
    let way = [0, 1].map(|k| contact[k] - centre.at[k]);
    let radius = editing.rounded(f64::hypot(way[0], way[1]));
    if radius <= 0.0 {
        return Err("the cam has no radius: click further from its centre".into());
    }
    let angle = f64::atan2(way[1], way[0]);
    let pivot = editing.marker_at(target)?;
    let letter = marker_name(&pivot).to_owned();
    let [x, y] = centre.at;
    let cam = editing.add_body("cam", &[(letter.clone(), [0.0; 3])], [x, y, angle]);
    let axle = format!("{cam}.{letter}");
    let roller = editing.rounded(radius * ROLLER);
    let reach = match follower {
        Follower::Roller => radius + roller,
        Follower::Knife | Follower::Flat => radius,
    };
    let (sin, cos) = angle.sin_cos();
    let guide = editing.ground_name("guide");
    let guide = editing.add_marker("ground", &guide, [x, y, angle]);
    let stem = editing.names.new_letter();
    let mut markers = vec![(stem.clone(), [0.0; 3])];
    if follower == Follower::Flat {
        // The face is its x-axis, at right angles to the guide.
        markers.push(("face".to_owned(), [0.0, 0.0, -FRAC_PI_2]));
    }
    let place = [x + cos * reach, y + sin * reach, angle];
    let body = editing.add_body("follower", &markers, place);
    let stem = format!("{body}.{stem}");
    editing.join(&letter, "revolute", [&pivot, &axle]);
    editing.join("guide", "translational", [&guide, &stem]);
    let (touching, keys) = match follower {
        Follower::Knife => (stem, "\"knife\"".to_owned()),
        Follower::Flat => (format!("{body}.face"), "\"flat\"".to_owned()),
        Follower::Roller => {
            let radius = editing.length(roller);
            (stem, format!("\"roller\"\nradius = {radius}"))
        }
    };
    let half = editing.length(radius * LIFT / 2.0);
    let radius = editing.length(radius);
    let name = editing.names.new_name("contact");
    let lines = format!(
        "type = \"cam\"\nmarkers = [\"{axle}\", \"{touching}\"]\nfollower = {keys}\nprofile = \
         \"{radius} + {half}*(1 - cos(theta))\""
    );
    editing.text.add_section(&["joints", &name], &lines);
    Ok(())
}
