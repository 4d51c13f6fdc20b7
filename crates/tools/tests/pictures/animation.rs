//! Pages on which mechanisms move: what they hold is where the mechanism is.

use std::sync::Arc;

use crate::common::mechanisms::crank;
use crate::common::{assembled, parse, shipped, stems, straight_to};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use biela::kinematics::{DriverPath, ForceParts, ForceQuantity, KnownMotion, Rates};
use biela::mechanism::{DriverId, Jet, Mechanism};
use biela_tools::drawing::animation::{
    Animation, Clock, Moment, Reading, moving_gif, moving_svg, page,
};
use biela_tools::drawing::symbol::ForceKind;
use biela_tools::drawing::{ForcePlace, Scene};
use serde_json::Value;

/// A page's film: the numbers behind its picture.
struct Film {
    json: Value,
    levels: Vec<u16>,
}

impl Film {
    fn of(page: &str) -> Self {
        let start = page.find("class=\"film\">").expect("there is a film") + 13;
        let text = &page[start..];
        let text = &text[..text.find("</script>").expect("it ends")];
        let json: Value = serde_json::from_str(text).expect("it is JSON");
        let data = json["data"].as_str().expect("it has data");
        let bytes = STANDARD.decode(data).expect("it is base64");
        let words = bytes.chunks_exact(2);
        Self {
            levels: words.map(|w| u16::from_le_bytes([w[0], w[1]])).collect(),
            json,
        }
    }

    fn count(&self, key: &str) -> usize {
        self.json[key].as_array().map_or_else(
            || usize::try_from(self.json[key].as_u64().expect("a number")).expect("it is small"),
            Vec::len,
        )
    }

    /// A value with half the distance of two that are told apart.
    fn value(&self, channel: usize, moment: usize) -> (f64, f64) {
        let end = |k: usize| self.json["scales"][channel][k].as_f64().expect("a number");
        let level = self.levels[channel * self.count("moments") + moment];
        let step = (end(1) - end(0)) / 65535.0;
        // The ends have seven digits.
        let rounding = 1e-6 * end(0).abs().max(end(1).abs());
        (end(0) + step * f64::from(level), 0.5 * step + rounding)
    }
}

/// Poses with their rates, while the first driver swings about its start value if it is an input.
fn swing(mechanism: &Arc<Mechanism>, count: usize) -> Vec<(Vec<f64>, [Vec<f64>; 2])> {
    let (mut solver, mut path) = assembled(mechanism);
    let home = solver.pose().drivers.clone();
    let mut rates = Rates::new(solver.pose().q.len());
    let size = 0.05 * home[0].abs().max(0.2);
    let swing = |k: usize| {
        let t = 0.1 * k as f64;
        Jet::new(home[0] + size * t.sin(), [size * t.cos(), -size * t.sin()])
    };
    let moved = matches!(path.driver_paths[0], DriverPath::Input { .. });
    let step = |k| {
        if moved {
            straight_to(&solver, &mut path, swing(k).value);
            solver.track(&path).expect("nothing is in the way");
        }
        let driver = if moved { swing(k) } else { Jet::constant(0.0) };
        let of = |id: biela::mechanism::DriverId| {
            let still = Jet::constant(home[id.index()]);
            if id.index() == 0 { driver } else { still }
        };
        solver.solve_rates(of, &mut rates).expect("it is regular");
        let rates = [rates.velocity().to_vec(), rates.acceleration().to_vec()];
        (solver.pose().q.clone(), rates)
    };
    (0..count).map(step).collect()
}

/// An animation of a mechanism that swings.
fn animation(mechanism: &Arc<Mechanism>, moments: usize) -> Animation {
    let motion = swing(mechanism, moments);
    let poses: Vec<Vec<f64>> = motion.iter().map(|(q, _)| q.clone()).collect();
    let parameters = mechanism.default_parameters();
    Animation {
        scene: Scene::along(mechanism, &parameters, &poses[0], &poses, true),
        clock: Clock {
            start: 0.0,
            step: 0.01,
            stop: 0.01 * (moments - 1) as f64,
        },
        readings: vec![Reading {
            name: "moment".to_owned(),
            unit: "1".to_owned(),
        }],
        forces: Vec::new(),
        moments: motion
            .into_iter()
            .enumerate()
            .map(|(k, (q, rates))| Moment {
                q,
                rates,
                readings: vec![k as f64],
                forces: Vec::new(),
            })
            .collect(),
    }
}

#[test]
fn what_moves_is_where_the_mechanism_is() {
    for name in [
        "four_bar",
        "slider_crank",
        "platform_3rpr",
        "planetary_gear",
        "cam_roller",
    ] {
        let mechanism = shipped(name);
        let animation = animation(&mechanism, 40);
        let page = page(&animation);
        let film = Film::of(&page);
        let home = &animation.moments[0].q;
        // Each body has a frame among the attachments that moves with it: its place is the
        // body's origin in one scale, its angle the body's.
        let attachments = film.count("attachments");
        let mut found = 0;
        for body in 0..mechanism.bodies.len() {
            let follows = |attachment: usize, scale: f64| {
                animation.moments.iter().enumerate().all(|(k, moment)| {
                    let near = |part: usize, expected: f64| {
                        let (value, tolerance) = film.value(3 * attachment + part, k);
                        // The bar, 44 to 110 units long, is drawn to hundredths.
                        (value - expected).abs() <= tolerance + 0.01 / 44.0 * value.abs()
                    };
                    let [x, y, phi] = [0, 1, 2].map(|c| moment.q[3 * body + c]);
                    let degrees = (180.0 - phi.to_degrees()).rem_euclid(360.0) - 180.0;
                    let (angle, tolerance) = film.value(3 * attachment + 2, k);
                    let off = (angle - degrees + 180.0).rem_euclid(360.0) - 180.0;
                    near(0, scale * x) && near(1, -scale * y) && off.abs() <= tolerance + 1e-9
                })
            };
            let scale = scale_of(&page);
            let attachment = (0..attachments).find(|attachment| follows(*attachment, scale));
            assert!(
                attachment.is_some(),
                "{name}: {} (scale {scale}, {home:?})",
                mechanism.bodies[body].name
            );
            found += 1;
        }
        assert_eq!(found, mechanism.bodies.len());
        let last = animation.moments.len() - 1;
        let reading = film.levels.len() / film.count("moments") - 1;
        let (value, tolerance) = film.value(reading, last);
        assert!((value - last as f64).abs() <= tolerance);
    }
}

/// Units of the sheet for a metre, from the bar that shows the scale.
fn scale_of(page: &str) -> f64 {
    let text = page
        .split("class=\"scale-text\"")
        .nth(1)
        .expect("there is a scale");
    let text = text.split('>').nth(2).expect("it has a text");
    let text = &text[..text.find('<').expect("it ends")];
    let (number, unit) = text.split_once(' ').expect("number and unit");
    let length: f64 = number.parse().expect("a number");
    let length = if unit == "mm" {
        length / 1000.0
    } else {
        length
    };
    let bar = page
        .split("<g class=\"scale\"")
        .nth(1)
        .expect("there is a bar");
    let data = bar.split("d=\"").nth(1).expect("it is a path");
    let numbers: Vec<f64> = data[..data.find('"').expect("it ends")]
        .split(|c: char| c.is_ascii_alphabetic() || c == ' ')
        .filter_map(|number| number.parse().ok())
        .collect();
    let x = || numbers.iter().step_by(2).copied();
    (x().fold(f64::MIN, f64::max) - x().fold(f64::MAX, f64::min)) / length
}

#[test]
fn arrows_are_velocities_and_accelerations() {
    // The rod's tip P at distance 0.5 m: v = 0.5 u̇ across the rod, and the accelerations.
    let mechanism = shipped("pendulum");
    let animation = animation(&mechanism, 40);
    let film = Film::of(&page(&animation));
    let points = film.json["points"].as_array().expect("there are points");
    let at = 3 * film.count("attachments") + film.count("lengths");
    assert!(!points.is_empty());
    let ratio = |point: usize, moment: usize| {
        let arrow = |kind: usize| {
            let [x, y] = [0, 1].map(|c| film.value(at + 4 * point + 2 * kind + c, moment).0);
            (x, -y)
        };
        (arrow(0), arrow(1))
    };
    // The greatest is one, the others are in proportion.
    let speed = |moment: &Moment| moment.rates[0][2].abs();
    let acceleration = |moment: &Moment| {
        let (omega, alpha) = (moment.rates[0][2], moment.rates[1][2]);
        (alpha * alpha + omega.powi(4)).sqrt()
    };
    let most = |of: &dyn Fn(&Moment) -> f64| animation.moments.iter().map(of).fold(0.0, f64::max);
    let (fastest, strongest) = (most(&speed), most(&acceleration));
    for (k, moment) in animation.moments.iter().enumerate() {
        let ((vx, vy), (ax, ay)) = ratio(0, k);
        // Two components, each to within a 65,535th of the range.
        assert!((vx.hypot(vy) - speed(moment) / fastest).abs() < 1e-4);
        assert!((ax.hypot(ay) - acceleration(moment) / strongest).abs() < 1e-4);
        // Across the rod, which points along phi.
        let phi = moment.q[2];
        assert!((vx * phi.cos() + vy * phi.sin()).abs() < 1e-4);
    }
}

#[test]
fn arrows_of_forces_are_parts_of_the_largest() {
    // The pendulum with a mass: its pin bears all forces but gravity, its driver turns it.
    let text = std::fs::read_to_string(crate::common::folder("mechanisms/pendulum.toml")).unwrap();
    let mechanism = parse(&text.replace("[bodies.rod]", "[bodies.rod]\nmass = 2"));
    let mut animation = animation(&mechanism, 8);
    let (mut solver, _) = assembled(&mechanism);
    let indeterminate = solver.indeterminate();
    let parameters = mechanism.default_parameters();
    animation.forces = ForcePlace::all(&mechanism, &parameters, &indeterminate);
    let kinds: Vec<ForceKind> = animation.forces.iter().map(|force| force.kind).collect();
    assert_eq!(kinds, [ForceKind::Reaction, ForceKind::Effort]);
    for (k, moment) in animation.moments.iter_mut().enumerate() {
        let k = k as f64;
        moment.forces = vec![[3.0 + k, -4.0, 0.0], [0.0, 0.0, 0.5 * k - 1.0]];
    }
    let film = Film::of(&page(&animation));
    let forces = film.json["forces"].as_array().expect("there are forces");
    let torques = film.json["torques"].as_array().expect("there are torques");
    assert_eq!((forces.len(), torques.len()), (1, 1));
    assert_eq!(forces[0]["kind"], "reaction");
    assert_eq!(torques[0]["kind"], "effort");
    let most = |kind: usize| film.json["most"][kind].as_f64().expect("a number");
    let largest = 10.0_f64.hypot(4.0);
    // Seven digits.
    assert!((most(2) - largest).abs() < 1e-5 && (most(3) - 2.5).abs() < 1e-6);
    let at = 3 * film.count("attachments") + film.count("lengths") + 4 * film.count("points");
    for (k, moment) in animation.moments.iter().enumerate() {
        let [[x, y, _], [_, _, torque]] = moment.forces[..] else {
            panic!("two forces");
        };
        for (channel, expected) in [x / largest, -y / largest, torque / 2.5].iter().enumerate() {
            let (found, tolerance) = film.value(at + channel, k);
            assert!((found - expected).abs() <= tolerance + 1e-12, "{channel}");
        }
    }
}

#[test]
fn forces_are_shown_where_they_act() {
    // The loader: a cylinder pushes along itself, the load acts along ground's axes.
    let mechanism = shipped("loader");
    let (mut solver, _) = assembled(&mechanism);
    let indeterminate = solver.indeterminate();
    let parameters = mechanism.default_parameters();
    let places = ForcePlace::all(&mechanism, &parameters, &indeterminate);
    let mut rates = Rates::new(solver.pose().q.len());
    let still = [Jet::constant(0.0); 2];
    solver
        .solve_rates(|_| still[0], &mut rates)
        .expect("it is regular");
    let mut forces = solver.forces();
    let motion = KnownMotion {
        rates: &rates,
        driver_rates: &still,
        inputs: &[120.0, -500.0, 7.0],
    };
    (solver.solve_forces(motion, ForceParts::ALL, &mut forces)).expect("forces have values");
    let q = &solver.pose().q;
    let values: Vec<[f64; 3]> = places.iter().map(|place| place.value(&forces, q)).collect();
    let of = |kind| {
        places
            .iter()
            .zip(&values)
            .filter(move |(place, _)| place.kind == kind)
    };
    let loads = of(ForceKind::Load).map(|(_, value)| value.map(f64::to_bits));
    let loads: Vec<[u64; 3]> = loads.collect();
    let given = [[120.0, -500.0, 7.0]].map(|load| load.map(f64::to_bits));
    assert_eq!(loads, given);
    for (index, (place, [x, y, torque])) in of(ForceKind::Effort).enumerate() {
        let effort = forces.value(ForceQuantity::Effort(DriverId(index)));
        let coordinate = &mechanism.drivers[index].coordinate;
        let [from, to] = [coordinate.from, coordinate.to]
            .map(|marker| solver.marker(marker, &rates).map(|jet| jet.value));
        let head = place.at.placed(q).point;
        let along = [to[0] - from[0], to[1] - from[1]];
        let length = along[0].hypot(along[1]);
        // Rounding of lengths of a few metres, times forces.
        let limit = 1e-13 * effort.abs();
        assert!((head.x - to[0]).hypot(head.y - to[1]) < 1e-13);
        assert!((x - effort * along[0] / length).abs() < limit);
        assert!((y - effort * along[1] / length).abs() < limit);
        assert!(*torque == 0.0);
    }
    for (index, (_, value)) in of(ForceKind::Reaction).enumerate() {
        let of_joint = [0, 1, 2].map(|k| forces.value(ForceQuantity::Reaction(index, k)));
        assert_eq!(value.map(f64::to_bits), of_joint.map(f64::to_bits));
    }
}

#[test]
fn pages_hold_together_whatever_the_names_are() {
    let text = std::fs::read_to_string(crate::common::folder("mechanisms/pendulum.toml")).unwrap();
    let description = text
        .lines()
        .find(|line| line.starts_with("description"))
        .unwrap();
    let hostile = "description = \"</script><b>&amp; {{film}} \\\" '\"";
    let mechanism = parse(&text.replace(description, hostile));
    let mut animation = animation(&mechanism, 3);
    animation.readings[0].name = "</script><script>alert(1)".to_owned();
    let page = page(&animation);
    assert!(page.contains("&lt;/script&gt;&lt;b&gt;&amp;amp; {{film}}"));
    // The film and the player, nothing else.
    assert_eq!(page.matches("</script>").count(), 2);
    assert_eq!(
        Film::of(&page).json["readings"][0]["name"],
        "</script><script>alert(1)"
    );
    // Nothing comes from elsewhere: the only address is the name of SVG.
    let addresses: Vec<&str> = page.split("http").skip(1).collect();
    assert_eq!(addresses.len(), 1);
    assert!(addresses[0].starts_with("://www.w3.org/2000/svg\""));
}

#[test]
fn long_films_stay_small_and_every_mechanism_has_one() {
    let mechanism = shipped("four_bar");
    let long = page(&animation(&mechanism, 10_000));
    assert!(long.len() < 1_000_000, "{}", long.len());
    for name in stems("mechanisms", "toml") {
        let mechanism = shipped(&name);
        let animation = animation(&mechanism, 3);
        let page = page(&animation);
        for body in &mechanism.bodies {
            assert!(
                page.contains(&format!(">{}</text>", body.name)),
                "{name}: {}",
                body.name
            );
        }
        assert_eq!(page, biela_tools::drawing::animation::page(&animation));
    }
}

/// Returns the value of an attribute of an element, `None` if it has none.
fn attribute<'a>(element: &'a str, name: &str) -> Option<&'a str> {
    let start = element.find(&format!(" {name}=\""))? + name.len() + 3;
    element[start..].split('"').next()
}

/// A name in a picture that moves by itself.
struct MovingName {
    /// Left end of the line of letters, and its width.
    start: [f64; 2],
    width: f64,
    /// Shifts at moments of equal distance, one if it rests.
    shifts: Vec<[f64; 2]>,
    /// When it is hidden or shown, as a part of the whole time, and whether it is shown then.
    shown: Vec<(f64, bool)>,
}

impl MovingName {
    fn new(element: &str) -> Self {
        let number = |text: &str| text.parse::<f64>().expect("a number");
        let of = |name| number(attribute(element, name).expect("it has a place and a width"));
        let animated = |kind: &str| {
            let start = element.find(kind)?;
            let animation = element[start..].split("/>").next()?;
            let values = attribute(animation, "values")?
                .split(';')
                .collect::<Vec<_>>();
            Some((values, attribute(animation, "keyTimes")))
        };
        let (shifts, _) = animated("<animateTransform").unwrap_or((vec!["0 0"], None));
        let (states, times) = animated("<animate ").unwrap_or((vec!["visible"], Some("0")));
        let times = times.expect("it has times").split(';').map(number);
        Self {
            start: [of("x"), of("y")],
            width: of("textLength"),
            shifts: (shifts.iter())
                .map(|shift| {
                    let (x, y) = shift.split_once(' ').expect("x and y");
                    [number(x), number(y)]
                })
                .collect(),
            shown: times
                .zip(states.iter().map(|state| *state == "visible"))
                .collect(),
        }
    }

    /// Returns the left end at a moment of `last + 1`, `None` while it is hidden.
    fn at(&self, moment: usize, last: usize) -> Option<[f64; 2]> {
        // Times have four digits.
        let now = moment as f64 / last as f64 + 1e-4;
        let (_, is_shown) = self.shown.iter().rfind(|(time, _)| *time <= now)?;
        let [x, y] = self.shifts[moment.min(self.shifts.len() - 1)];
        is_shown.then_some([self.start[0] + x, self.start[1] + y])
    }
}

/// Returns how many names of a picture that moves by itself are hidden at times; none may cover
/// another one.
fn hidden_names(animation: &Animation) -> usize {
    const CAPITALS: f64 = 8.6;
    let name = &animation.scene.name;
    let picture = moving_svg(animation);
    let lines = picture.lines().filter(|line| line.starts_with("<text "));
    let names: Vec<MovingName> = lines.map(MovingName::new).collect();
    assert!(!names.is_empty(), "{name}");
    let moments = names.iter().map(|n| n.shifts.len()).max();
    let last = moments.map_or(1, |moments| (moments - 1).max(1));
    for moment in 0..=last {
        let shown: Vec<([f64; 2], f64)> = (names.iter())
            .filter_map(|n| Some((n.at(moment, last)?, n.width)))
            .collect();
        for (index, ([x, y], width)) in shown.iter().enumerate() {
            for ([other_x, other_y], other_width) in &shown[..index] {
                let is_apart = x + width <= *other_x
                    || other_x + other_width <= *x
                    || (y - other_y).abs() >= CAPITALS;
                assert!(is_apart, "{name}: two names meet at moment {moment}");
            }
        }
    }
    names.iter().filter(|n| n.shown.len() > 1).count()
}

#[test]
fn names_in_moving_pictures_never_cover_each_other() {
    for name in stems("mechanisms", "toml") {
        hidden_names(&animation(&shipped(&name), 24));
    }
    // Blocks on one line pass each other in the middle, where their names have no room.
    const BLOCKS: usize = 8;
    let text: String = (0..BLOCKS)
        .map(|k| {
            format!(
                "[bodies.block_{k}]\nmarkers = {{ O = [0, 0] }}\n\
                 [joints.way_{k}]\ntype = 'translational'\nmarkers = ['ground.O', 'block_{k}.O']\n\
                 [drivers.shift_{k}]\ncoordinate = 'x'\nmarkers = ['ground.O', 'block_{k}.O']\n\
                 start = 0\n"
            )
        })
        .collect();
    let mechanism = parse(&format!(
        "format = 1\nname = 'blocks'\n[ground.markers]\nO = [0, 0]\n{text}"
    ));
    let pose = |moment: usize| -> Vec<f64> {
        let part = 1.0 - moment as f64 / 30.0;
        let places = (0..BLOCKS).map(|k| part * (k as f64 - 3.5));
        places.flat_map(|x| [x, 0.0, 0.0]).collect()
    };
    let poses: Vec<Vec<f64>> = (0..=60).map(pose).collect();
    let passing = Animation {
        scene: Scene::along(&mechanism, &[], &poses[0], &poses, true),
        clock: Clock {
            start: 0.0,
            step: 0.1,
            stop: 6.0,
        },
        readings: Vec::new(),
        forces: Vec::new(),
        moments: (poses.iter())
            .map(|q| Moment {
                q: q.clone(),
                rates: Default::default(),
                readings: Vec::new(),
                forces: Vec::new(),
            })
            .collect(),
    };
    assert!(hidden_names(&passing) > 0);
}

/// The pictures of a GIF, each whole, and the sum of their delays \[s\].
fn pictures_of(gif: &[u8]) -> (Vec<Vec<u8>>, f64) {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(gif).expect("it is a GIF");
    assert_eq!(decoder.repeat(), gif::Repeat::Infinite);
    let [width, height] = [decoder.width(), decoder.height()].map(usize::from);
    let (mut shown, mut delays) = (vec![0; 4 * width * height], 0.0);
    let mut pictures = Vec::new();
    while let Some(frame) = decoder.read_next_frame().expect("it is whole") {
        delays += f64::from(frame.delay) / 100.0;
        let row = 4 * usize::from(frame.width);
        for (y, pixels) in frame.buffer.chunks_exact(row).enumerate() {
            let start = 4 * ((usize::from(frame.top) + y) * width + usize::from(frame.left));
            shown[start..start + row].copy_from_slice(pixels);
        }
        pictures.push(shown.clone());
    }
    (pictures, delays)
}

// A crank that turns once in a second: the picture takes two, and its halves mirror each other.
#[test]
fn a_gif_shows_the_motion_in_its_time() {
    let (mut solver, mut path) = assembled(&parse(&crank("start = 0")));
    let scene = Scene::new(&mut solver, true);
    let moments = (0..=20).map(|k| {
        let angle = std::f64::consts::TAU * f64::from(k) / 20.0;
        path.driver_paths[0] = DriverPath::held(angle, solver.pose().drivers[0]);
        solver.track(&path).expect("it turns");
        Moment {
            q: solver.pose().q.clone(),
            rates: Default::default(),
            readings: Vec::new(),
            forces: Vec::new(),
        }
    });
    let animation = Animation {
        moments: moments.collect(),
        scene,
        clock: Clock {
            start: 0.0,
            step: 0.05,
            stop: 1.0,
        },
        readings: Vec::new(),
        forces: Vec::new(),
    };
    let gif = moving_gif(&animation);
    assert_eq!(gif, moving_gif(&animation));
    let (pictures, duration) = pictures_of(&gif);
    // The last moment is the first one.
    assert_eq!(pictures.len(), 20);
    assert!((duration - 2.0).abs() < 1e-9, "{duration}");
    // The middle of the crank's colour is on a circle about its pivot, in the order of the angles.
    let blue = |picture: &[u8]| -> [f64; 2] {
        let pixels = picture.chunks_exact(4).enumerate();
        let of_crank = pixels.filter(|(_, p)| p[2] > 200 && p[0] < 160);
        let places: Vec<[f64; 2]> = of_crank
            .map(|(k, _)| [(k % 640) as f64, (k / 640) as f64])
            .collect();
        assert!(places.len() > 1000, "{}", places.len());
        [0, 1].map(|axis| places.iter().map(|p| p[axis]).sum::<f64>() / places.len() as f64)
    };
    let middles: Vec<[f64; 2]> = pictures.iter().map(|picture| blue(picture)).collect();
    let centre = [0, 1].map(|axis| middles.iter().map(|m| m[axis]).sum::<f64>() / 20.0);
    for (k, [x, y]) in middles.iter().enumerate() {
        let turned = f64::atan2(centre[1] - y, x - centre[0]);
        let angle = std::f64::consts::TAU * k as f64 / 20.0;
        let off = (turned - angle + 0.5).rem_euclid(std::f64::consts::TAU) - 0.5;
        // Joints cover parts of the crank: a twentieth of a turn is 0.31.
        assert!(off.abs() < 0.1, "{k}: {off}");
    }
}
