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
    let centre = Centre::of(editing, target, false)?;
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
    let [x, y] = centre.at;
    let (pivot, axle) = add_cam(editing, target, [x, y, angle])?;
    let letter = marker_name(&pivot).to_owned();
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
    add_contact(editing, [&axle, &touching], &keys, radius);
    Ok(())
}

/// Adds a cam at a target, which a roller follows at a marker of another body that moves. It touches the
/// roller where its contour is nearest to the centre.
pub(super) fn followed(editing: &mut Editing, target: &Target, path: &str) -> Result<(), Refusal> {
    let marker = editing.marker(path)?;
    let centre = Centre::of(editing, target, false)?;
    let pinned = editing.drawn.pinned_to(marker);
    let bodies = pinned.iter().map(|id| editing.body_of(*id));
    let bodies: Vec<&str> = bodies.collect::<Result<_, _>>()?;
    if let Some(body) = bodies
        .iter()
        .find(|body| centre.carriers.iter().any(|own| own == *body))
    {
        return Err(format!(
            "`{path}` is on {}, as the centre of the cam is: choose a point that moves past it",
            if *body == "ground" {
                "ground".to_owned()
            } else {
                format!("`{body}`")
            },
        )
        .into());
    }
    let ([x, y], [u, v]) = (centre.at, editing.drawn.point(marker));
    let reach = f64::hypot(u - x, v - y);
    if reach <= editing.same() {
        return Err("the roller is at the centre of the cam: put them apart".into());
    }
    let roller = editing.rounded(reach * ROLLER / (1.0 + ROLLER));
    let (pivot, axle) = add_cam(editing, target, [x, y, f64::atan2(v - y, u - x)])?;
    editing.join(marker_name(&pivot), "revolute", [&pivot, &axle]);
    let keys = format!("\"roller\"\nradius = {}", editing.length(roller));
    add_contact(editing, [&axle, path], &keys, reach - roller);
    Ok(())
}

/// Adds the body of a cam, whose x-axis points to its contact; returns the markers at its centre, of the
/// body that carries it and its own.
fn add_cam(
    editing: &mut Editing,
    target: &Target,
    frame: [f64; 3],
) -> Result<(String, String), Refusal> {
    let pivot = editing.marker_at(target)?;
    let letter = marker_name(&pivot).to_owned();
    let cam = editing.add_body("cam", &[(letter.clone(), [0.0; 3])], frame);
    Ok((pivot, format!("{cam}.{letter}")))
}

/// Adds the joint of a cam with its follower, with the keys of that; `radius` is the least one of the
/// contour \[m\].
fn add_contact(editing: &mut Editing, [axle, touching]: [&str; 2], keys: &str, radius: f64) {
    let half = editing.usual(radius * LIFT / 2.0);
    let radius = editing.length(radius);
    let name = editing.names.new_name("contact");
    let lines = format!(
        "type = \"cam\"\nmarkers = [\"{axle}\", \"{touching}\"]\nfollower = {keys}\nprofile = \
         \"{radius} + {half}*(1 - cos(theta))\""
    );
    editing.text.add_section(&["joints", &name], &lines);
}
