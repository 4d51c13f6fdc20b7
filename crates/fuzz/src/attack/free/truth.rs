//! Motions in closed form: parabolas from event to event.

use biela::dynamics::EventKind;

use super::align::Happening;

/// A sine over time: a sin(w t + p).
#[derive(Clone, Copy, Debug)]
pub struct Sine {
    pub amplitude: f64,
    pub frequency: f64,
    pub phase: f64,
}

impl Sine {
    /// Returns value, rate and acceleration at a time.
    pub fn at(&self, time: f64) -> [f64; 3] {
        let Self {
            amplitude,
            frequency,
            phase,
        } = *self;
        let (sin, cos) = (frequency * time + phase).sin_cos();
        let value = amplitude * sin;
        [
            value,
            amplitude * frequency * cos,
            -frequency * frequency * value,
        ]
    }

    /// Returns the expression of it in a file.
    pub fn expression(&self) -> String {
        let Self {
            amplitude,
            frequency,
            phase,
        } = self;
        format!("({amplitude:?})*sin(({frequency:?})*t + ({phase:?}))")
    }
}

/// A part of a motion on a parabola, or with a sine.
#[derive(Clone, Copy, Debug)]
struct Part {
    start: f64,
    /// Value and rate at the start, and acceleration; `None` where it moves with the sine at a distance.
    parabola: Option<[f64; 3]>,
    offset: f64,
}

/// A motion of one coordinate, part by part.
#[derive(Clone, Debug)]
pub struct Parts {
    sine: Sine,
    parts: Vec<Part>,
}

impl Parts {
    fn new(sine: Sine) -> Self {
        Self {
            sine,
            parts: Vec::new(),
        }
    }

    fn fly(&mut self, start: f64, parabola: [f64; 3]) {
        self.parts.push(Part {
            start,
            parabola: Some(parabola),
            offset: 0.0,
        });
    }

    fn ride(&mut self, start: f64, offset: f64) {
        self.parts.push(Part {
            start,
            parabola: None,
            offset,
        });
    }

    /// Returns the value at a time.
    pub fn at(&self, time: f64) -> f64 {
        let part = self.parts.iter().rev().find(|part| part.start <= time);
        let part = part.unwrap_or(&self.parts[0]);
        match part.parabola {
            Some(parabola) => along(parabola, time - part.start)[0],
            None => self.sine.at(time)[0] + part.offset,
        }
    }
}

/// Returns value and rate on a parabola.
fn along([value, rate, acceleration]: [f64; 3], time: f64) -> [f64; 2] {
    [
        value + time * (rate + 0.5 * acceleration * time),
        rate + acceleration * time,
    ]
}

/// Returns the first time after `start` at which a function is no longer positive, sought in steps and
/// found to rounding. The function is positive from the second step on.
fn first_zero(function: impl Fn(f64) -> f64, start: f64, until: f64, step: f64) -> Option<f64> {
    let mut last = start;
    loop {
        let next = (last + step).min(until);
        if function(next) <= 0.0 {
            let (mut low, mut high) = (last, next);
            // The start itself may be a zero, from which the function rises.
            if low.to_bits() == start.to_bits() && function(low) <= 0.0 {
                low = (0..60)
                    .map(|halving| start + (next - start) * 0.5_f64.powi(halving))
                    .find(|time| function(*time) > 0.0)?;
            }
            for _ in 0..80 {
                let middle = 0.5 * (low + high);
                if function(middle) > 0.0 {
                    low = middle
                } else {
                    high = middle
                }
            }
            return Some(high);
        }
        if next >= until {
            return None;
        }
        last = next;
    }
}

/// Speed of a bounce below which a ball rests \[m/s\]: bounces of less than 1e-15 m.
const LAST_BOUNCE: f64 = 1e-7;
/// Bounces, far more than are compared.
const MOST_BOUNCES: usize = 20_000;

/// A ball that falls on a table which shakes.
#[derive(Clone, Copy, Debug)]
pub struct Ball {
    pub table: Sine,
    pub gravity: f64,
    pub restitution: f64,
    /// Height and speed at the start.
    pub start: [f64; 2],
}

impl Ball {
    /// Returns the motion up to a time, with the impacts at the stop of a name.
    pub fn motion(&self, name: &str, until: f64) -> (Parts, Vec<Happening>) {
        let Self {
            table,
            gravity,
            restitution,
            start: [height, speed],
        } = *self;
        let step = until.min(std::f64::consts::TAU / table.frequency) / 200.0;
        let mut parts = Parts::new(table);
        let mut impacts = Vec::new();
        let (mut time, mut parabola) = (0.0, [height, speed, -gravity]);
        while impacts.len() < MOST_BOUNCES {
            parts.fly(time, parabola);
            let gap = |at: f64| along(parabola, at - time)[0] - table.at(at)[0];
            let Some(hit) = first_zero(gap, time, until, step) else {
                break;
            };
            let [place, rate, _] = table.at(hit);
            let speed = rate - along(parabola, hit - time)[1];
            impacts.push(Happening {
                time: hit,
                name: name.to_owned(),
                kind: EventKind::Impact { speed },
            });
            time = hit;
            parabola = [place, rate + restitution * speed, -gravity];
            let [_, _, acceleration] = table.at(hit);
            if restitution * speed < LAST_BOUNCE && acceleration + gravity > 0.0 {
                parts.ride(hit, 0.0);
                // The table throws the ball where it would have to pull it down.
                let push = |at: f64| table.at(at)[2] + gravity;
                let Some(thrown) = first_zero(push, hit, until, step) else {
                    break;
                };
                time = thrown;
                let [place, rate, _] = table.at(thrown);
                parabola = [place, rate, -gravity];
            }
        }
        (parts, impacts)
    }
}

/// A block on a plate that moves to and fro, with friction between them.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    pub plate: Sine,
    /// Deceleration by friction that slides, and the largest acceleration by friction that sticks.
    pub friction: [f64; 2],
    /// Acceleration by a load.
    pub load: f64,
    /// Place and speed at the start.
    pub start: [f64; 2],
}

impl Block {
    /// Returns the motion up to a time.
    pub fn motion(&self, until: f64) -> Parts {
        let Self {
            plate,
            friction: [sliding, sticking],
            load,
            start,
        } = *self;
        let step = until.min(std::f64::consts::TAU / plate.frequency) / 200.0;
        let mut parts = Parts::new(plate);
        let (mut time, [mut place, mut speed]) = (0.0, start);
        let slack = 1e-12 * (1.0 + plate.amplitude * plate.frequency);
        while parts.parts.len() < MOST_BOUNCES {
            let relative = speed - plate.at(time)[1];
            let needed = |at: f64| (plate.at(at)[2] - load).abs();
            let mut direction = relative.signum();
            if relative.abs() <= slack {
                if needed(time) < sticking {
                    parts.ride(time, place - plate.at(time)[0]);
                    let left = first_zero(|at| sticking - needed(at), time, until, step);
                    let Some(left) = left else {
                        break;
                    };
                    place += plate.at(left)[0] - plate.at(time)[0];
                    speed = plate.at(left)[1];
                    time = left;
                }
                direction = (load - plate.at(time)[2]).signum();
            }
            let parabola = [place, speed, load - direction * sliding];
            parts.fly(time, parabola);
            let relative = |at: f64| direction * (along(parabola, at - time)[1] - plate.at(at)[1]);
            let Some(met) = first_zero(relative, time, until, step) else {
                break;
            };
            place = along(parabola, met - time)[0];
            speed = plate.at(met)[1];
            time = met;
        }
        parts
    }
}

/// A mass in a row.
#[derive(Clone, Copy, Debug)]
pub struct Mass {
    pub mass: f64,
    pub place: f64,
    pub speed: f64,
}

/// A contact of a row: with a wall, or of a mass with the next one.
#[derive(Clone, Debug)]
pub struct Contact {
    pub name: String,
    /// The masses on its left and on its right, `None` for a wall.
    pub between: [Option<usize>; 2],
    /// Distance at which they touch, or place of the wall.
    pub touch: f64,
    pub restitution: f64,
}

/// Masses in a row without forces: straight from impact to impact.
#[derive(Clone, Debug)]
pub struct MassRow {
    pub masses: Vec<Mass>,
    pub contacts: Vec<Contact>,
}

/// A motion of masses in a row: the time of each impact, and the masses after it.
pub type RowParts = Vec<(f64, Vec<Mass>)>;

impl MassRow {
    /// Returns the gap of a contact and its rate.
    fn gap(&self, contact: &Contact) -> [f64; 2] {
        let of = |mass: usize| [self.masses[mass].place, self.masses[mass].speed];
        match contact.between {
            [Some(left), Some(right)] => {
                [0, 1].map(|k| of(right)[k] - of(left)[k] - [contact.touch, 0.0][k])
            }
            [None, Some(right)] => [of(right)[0] - contact.touch, of(right)[1]],
            [Some(left), None] => [contact.touch - of(left)[0], -of(left)[1]],
            [None, None] => [f64::INFINITY, 0.0],
        }
    }

    /// Returns the motion up to a time with its impacts, and the time up to which it is known: two
    /// impacts at one instant are not.
    pub fn motion(mut self, until: f64) -> (RowParts, Vec<Happening>, f64) {
        let mut time = 0.0;
        let mut parts = vec![(0.0, self.masses.clone())];
        let mut impacts = Vec::new();
        loop {
            let times = self.contacts.iter().map(|contact| {
                let [gap, rate] = self.gap(contact);
                if rate < 0.0 {
                    gap.max(0.0) / -rate
                } else {
                    f64::INFINITY
                }
            });
            let mut order: Vec<(usize, f64)> = times.enumerate().collect();
            order.sort_by(|a, b| a.1.total_cmp(&b.1));
            let (first, after) = order[0];
            if time + after >= until {
                return (parts, impacts, until);
            }
            let next = order.get(1).map_or(f64::INFINITY, |(_, after)| *after);
            if next - after < 1e-6 || impacts.len() > MOST_BOUNCES {
                return (parts, impacts, time + after - 1e-6);
            }
            time += after;
            for mass in &mut self.masses {
                mass.place += after * mass.speed;
            }
            let contact = self.contacts[first].clone();
            let closing = -self.gap(&contact)[1];
            let inverse = |mass: Option<usize>| mass.map_or(0.0, |m| 1.0 / self.masses[m].mass);
            let [left, right] = contact.between;
            let impulse = (1.0 + contact.restitution) * closing / (inverse(left) + inverse(right));
            for (mass, sign) in [(left, -1.0), (right, 1.0)] {
                if let Some(mass) = mass {
                    let mass = &mut self.masses[mass];
                    mass.speed += sign * impulse / mass.mass;
                }
            }
            impacts.push(Happening {
                time,
                name: contact.name.clone(),
                kind: EventKind::Impact { speed: closing },
            });
            parts.push((time, self.masses.clone()));
        }
    }
}

/// Returns the places of the masses at a time.
pub fn places(parts: &RowParts, time: f64) -> Vec<f64> {
    let part = parts.iter().rev().find(|(start, _)| *start <= time);
    let (start, masses) = part.unwrap_or(&parts[0]);
    let places = masses.iter();
    places
        .map(|mass| mass.place + (time - start) * mass.speed)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const STILL: Sine = Sine {
        amplitude: 0.0,
        frequency: 10.0,
        phase: 0.0,
    };

    /// Times of a ball that falls from h on ground: t0 (1 + 2 e + 2 e² + …) with t0 = √(2h/g).
    #[test]
    fn a_ball_bounces_on_ground_in_a_geometric_series() {
        let (e, h, g) = (0.5, 0.2, 9.81);
        let ball = Ball {
            table: STILL,
            gravity: g,
            restitution: e,
            start: [h, 0.0],
        };
        let (parts, impacts) = ball.motion("hit", 3.0);
        let first = (2.0 * h / g).sqrt();
        let mut expected = first;
        let mut bounce = 2.0 * e * first;
        for impact in impacts.iter().take(10) {
            assert!((impact.time - expected).abs() < 1e-12, "{impact:?}");
            expected += bounce;
            bounce *= e;
        }
        assert!(parts.at(2.9).abs() < 1e-15);
    }

    /// A table of 0.01 m and 100 rad/s: an independent integration with events to 1e-13 has
    /// y(1) = 0.0473017 and, of 0.001 m and 1000 rad/s, 0.1959406.
    #[test]
    fn a_ball_bounces_on_a_table_that_shakes() {
        for (amplitude, frequency, expected) in
            [(0.01, 100.0, 0.047_301_7), (0.001, 1000.0, 0.195_940_6)]
        {
            let ball = Ball {
                table: Sine {
                    amplitude,
                    frequency,
                    phase: 0.0,
                },
                gravity: 9.81,
                restitution: 0.5,
                start: [0.05, 0.0],
            };
            let (parts, _) = ball.motion("hit", 1.5);
            let off = (parts.at(1.0) - expected).abs();
            assert!(off < 1e-7, "{frequency}: {off}");
        }
    }

    /// Friction larger than the largest acceleration of the plate carries the block; without a
    /// plate that moves the block brakes as a parabola.
    #[test]
    fn a_block_rides_and_brakes() {
        let plate = Sine {
            amplitude: 0.1,
            frequency: 5.0,
            phase: 0.3,
        };
        let start = [0.0, plate.at(0.0)[1]];
        let rides = Block {
            plate,
            friction: [2.6, 2.6],
            load: 0.0,
            start,
        };
        let way = plate.at(0.7)[0] - plate.at(0.0)[0];
        assert!((rides.motion(1.0).at(0.7) - way).abs() < 1e-15);
        let brakes = Block {
            plate: STILL,
            friction: [2.0, 2.0],
            load: 0.0,
            start: [0.0, 1.0],
        };
        let parts = brakes.motion(1.0);
        assert!((parts.at(0.25) - (0.25 - 0.0625)).abs() < 1e-14);
        assert!((parts.at(0.9) - 0.25).abs() < 1e-14);
    }

    /// Two equal masses exchange their speeds.
    #[test]
    fn equal_masses_exchange_their_speeds() {
        let mass = |place, speed| Mass {
            mass: 2.0,
            place,
            speed,
        };
        let contact = |name: &str, between, touch| Contact {
            name: name.to_owned(),
            between,
            touch,
            restitution: 1.0,
        };
        let row = MassRow {
            masses: vec![mass(0.0, 1.0), mass(1.0, 0.0)],
            contacts: vec![
                contact("pair", [Some(0), Some(1)], 0.5),
                contact("wall", [Some(1), None], 1.25),
            ],
        };
        let (parts, impacts, until) = row.motion(1.2);
        assert!((until - 1.2).abs() < 1e-15);
        let times: Vec<f64> = impacts.iter().map(|impact| impact.time).collect();
        // 0.5 s to touch, 0.25 s to the wall, 0.25 s back.
        assert_eq!(times, [0.5, 0.75, 1.0]);
        // Some roundings of a place.
        for (place, truth) in places(&parts, 1.1).iter().zip([0.4, 1.0]) {
            assert!((place - truth).abs() < 1e-15, "{place} {truth}");
        }
    }
}
