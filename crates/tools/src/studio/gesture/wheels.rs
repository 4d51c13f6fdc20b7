//! Pairs of wheels: in mesh, or on a belt.

use super::wheel::Centre;
use super::{Editing, Refusal, Target, WheelPair};

/// Adds two wheels, which mesh as they are drawn: in mesh with pitch circles that meet at a contact, on a
/// belt with radii. A centre of a wheel that is there already takes that wheel, so that trains are drawn
/// one pair after the other.
pub(super) fn wheels(
    editing: &mut Editing,
    pair: WheelPair,
    points: &[Target],
    fixed: [bool; 2],
    contact: Option<[f64; 2]>,
    radii: Option<[f64; 2]>,
) -> Result<(), Refusal> {
    let [first, second] = points else {
        return Err("a pair of wheels has two centres".into());
    };
    let centres = [
        Centre::of(editing, first, fixed[0])?,
        Centre::of(editing, second, fixed[1])?,
    ];
    let [a, b] = centres.each_ref().map(|centre| centre.at);
    let way = [b[0] - a[0], b[1] - a[1]];
    let apart = f64::hypot(way[0], way[1]);
    if apart <= editing.same() {
        return Err("the centres of the wheels are one point: put them apart".into());
    }
    let carrier = carrier(&centres)?;
    let radii = match pair {
        WheelPair::Gear | WheelPair::Internal => {
            let contact = contact.ok_or("wheels in mesh meet at a `contact`")?;
            let along = [0, 1].map(|k| (contact[k] - a[k]) * way[k] / apart);
            in_mesh(
                pair == WheelPair::Internal,
                editing.rounded(along[0] + along[1]),
                apart,
            )?
        }
        WheelPair::Belt | WheelPair::Crossed => {
            let radii = radii.ok_or("wheels on a belt have `radii`")?;
            on_belt(pair == WheelPair::Crossed, radii, apart)?
        }
    };
    let radii = radii.map(|radius| editing.length(radius));
    if radii.iter().any(|radius| radius == "0") {
        return Err("a wheel has no radius: click further from its centre".into());
    }
    for centre in &centres {
        centre.settle(editing);
    }
    let [first, second] = [
        centres[0].make(editing, "wheel")?,
        centres[1].make(editing, "wheel")?,
    ];
    let (word, flag) = match pair {
        WheelPair::Gear => ("gear", ""),
        WheelPair::Internal => ("gear", ", internal = true"),
        WheelPair::Belt => ("belt", ""),
        WheelPair::Crossed => ("belt", ", crossed = true"),
    };
    let carrier = match &*carrier {
        "ground" => String::new(),
        body => format!(", carrier = \"{body}\""),
    };
    let name = editing.names.new_name(word);
    let value = format!(
        "{{ type = \"{word}\", markers = [\"{first}\", \"{second}\"], radii = [{}, \
         {}]{flag}{carrier}, phase = \"drawn\" }}",
        radii[0], radii[1],
    );
    editing.text.set(&["joints", &name], &value);
    Ok(())
}

/// Returns the body that carries both centres.
fn carrier(centres: &[Centre; 2]) -> Result<String, Refusal> {
    let [first, second] = centres.each_ref().map(|centre| &centre.carriers);
    let mut shared = first.iter().filter(|body| second.contains(body));
    let ground = shared.clone().find(|body| *body == "ground");
    if let Some(body) = ground.or_else(|| shared.next()) {
        return Ok(body.clone());
    }
    let names = [first, second].map(|bodies| match bodies.first().map(String::as_str) {
        None | Some("ground") => "ground".to_owned(),
        Some(body) => format!("`{body}`"),
    });
    let [first, second] = names;
    Err(format!(
        "one centre is on {first}, the other on {second}: put both on one body, or both on ground, \
         which keeps them apart"
    )
    .into())
}

/// Returns the radii of two pitch circles that meet at a way along the line of centres.
fn in_mesh(internal: bool, along: f64, apart: f64) -> Result<[f64; 2], Refusal> {
    let is_between = along > 0.0 && along < apart;
    match (internal, is_between) {
        (false, true) => Ok([along, apart - along]),
        (false, false) => Err(
            "two wheels meet between their centres: click there, or draw an \
                               internal gear"
                .into(),
        ),
        (true, false) if along < 0.0 => Ok([-along, apart - along]),
        (true, false) if along > apart => Ok([along, along - apart]),
        (true, _) => {
            Err("a wheel meets the ring around it beyond their centres: click there".into())
        }
    }
}

/// Checks the radii of two wheels on a belt.
fn on_belt(crossed: bool, radii: [f64; 2], apart: f64) -> Result<[f64; 2], Refusal> {
    let [first, second] = radii;
    if first <= 0.0 || second <= 0.0 {
        return Err("a wheel has no radius: click further from its centre".into());
    }
    let room = if crossed {
        first + second
    } else {
        f64::abs(first - second)
    };
    if apart > room {
        Ok(radii)
    } else if crossed {
        Err("the wheels overlap, where a belt cannot cross between them: make them smaller".into())
    } else {
        Err("one wheel is inside the other, where no belt runs: make it smaller".into())
    }
}
