//! The query of a link, taken apart.

use percent_encoding::percent_decode_str;

use super::digits::{check, decimal, digit, integer};
use crate::exchange::draft::LengthUnit;
use crate::exchange::error::{Error, start_of};
use crate::exchange::others::Others;

pub(super) struct Query {
    pub(super) unit: LengthUnit,
    /// Index of the unit of forces.
    pub(super) force_unit: u64,
    /// Speed of the inputs, negative for clockwise \[rpm\].
    pub(super) rpm: f64,
    /// Whether the inputs turn clockwise.
    pub(super) is_clockwise: bool,
    /// Speed of driven sliders \[length/s\].
    pub(super) linear_speed: f64,
    pub(super) has_gravity: bool,
    pub(super) joints: Vec<Joint>,
    pub(super) links: Vec<Link>,
    pub(super) forces: Vec<Force>,
    /// Entries on the picture and on editing, and unknown ones.
    pub(super) others: Others,
}

pub(super) struct Joint {
    pub(super) id: String,
    pub(super) name: String,
    pub(super) at: [f64; 2],
    pub(super) angle: f64,
    pub(super) is_prismatic: bool,
    pub(super) is_input: bool,
    pub(super) is_grounded: bool,
    /// Whether all links on a pin are one, or a slider keeps what slides from turning.
    pub(super) is_welded: bool,
    pub(super) shows_curve: bool,
    /// Id of the link in which the slot is, and of the two joints that give its direction.
    pub(super) slot: Option<[String; 3]>,
    /// Its own speed, which goes before that of all inputs.
    pub(super) speed: Option<f64>,
}

pub(super) struct Link {
    /// Whether no other link has it as its part.
    pub(super) is_root: bool,
    /// Whether it is the block of a slider.
    pub(super) is_block: bool,
    pub(super) id: String,
    pub(super) name: String,
    pub(super) mass: f64,
    pub(super) inertia: f64,
    pub(super) center: [f64; 2],
    pub(super) joints: Vec<String>,
    /// Ids of the links that are its parts.
    pub(super) parts: Vec<String>,
}

pub(super) struct Force {
    pub(super) name: String,
    /// Id of the link on which it acts.
    pub(super) link: String,
    /// Whether it turns with the link.
    pub(super) is_local: bool,
    pub(super) is_outward: bool,
    /// Point at which it acts, and one in its direction.
    pub(super) line: [[f64; 2]; 2],
    pub(super) size: f64,
}

/// Returns the query of a link, or of a file with a link, if it may be one of PMKS+.
pub(super) fn query(text: &str) -> Option<String> {
    let line = text.lines().map(str::trim).find(|line| !line.is_empty())?;
    let query = line.split_once('?').map_or(line, |(_, query)| query);
    let query = query.split('#').next().unwrap_or_default();
    let query = percent_decode_str(query).decode_utf8().ok()?.into_owned();
    let settings: Vec<&str> = query.splitn(5, '.').collect();
    let is_digit = |byte: u8| byte == b',' || digit(byte).is_some();
    let are_settings = settings.len() == 5
        && settings[..4]
            .iter()
            .all(|part| !part.is_empty() && part.bytes().all(is_digit));
    are_settings.then_some(query)
}

/// Returns the error of a part that is not as it should be.
fn broken(part: &str) -> Error {
    Error::BrokenLink {
        part: format!("`{}`", start_of(part)),
    }
}

/// Flags of the settings, from the lowest bit.
const CLOCKWISE: u64 = 1;
const WITHOUT_GRAVITY: u64 = 1 << 8;

impl Query {
    pub(super) fn read(query: &str) -> Result<Self, Error> {
        let query = without_digest(query)?;
        let mut parts = query.split('.');
        let mut setting = || parts.next().unwrap_or_default();
        let [bools, decimals, integers, enums] = [setting(), setting(), setting(), setting()];
        let flags = bools.bytes().try_fold(0_u64, |flags, byte| {
            Some(flags.wrapping_mul(64) + digit(byte)?)
        });
        let flags = flags.ok_or_else(|| broken(bools))?;
        let is_clockwise = flags & CLOCKWISE != 0;
        let speed = integers.split(',').next().and_then(integer);
        let speed = speed.ok_or_else(|| broken(integers))?;
        let linear_speed = match decimals.split(',').nth(1) {
            None => 0.0,
            Some(speed) => decimal(speed).ok_or_else(|| broken(decimals))?,
        };
        let mut enums_of = enums.bytes().map(digit);
        let unit = enums_of.next().flatten().ok_or_else(|| broken(enums))?;
        let mut read = Self {
            unit: LengthUnit::of_pmks(unit).ok_or_else(|| broken(enums))?,
            force_unit: enums_of.nth(1).flatten().unwrap_or(1),
            rpm: if is_clockwise { -speed } else { speed },
            is_clockwise,
            linear_speed,
            has_gravity: flags & WITHOUT_GRAVITY == 0,
            joints: Vec::new(),
            links: Vec::new(),
            forces: Vec::new(),
            others: Others::default(),
        };
        read.others.see("view");
        read.others.see("colours");
        let mut ends = 0;
        // The object that is chosen, then marks.
        let mut tail = 0;
        for part in parts {
            match (ends, part) {
                (0..=2, "") => ends += 1,
                (0, part) => read.joints.push(Joint::read(part, &mut read.others)?),
                (1, part) => read.links.push(Link::read(part)?),
                (2, part) => read.forces.push(Force::read(part)?),
                (_, part) => {
                    match tail {
                        0 => {}
                        1 => read.marks(part),
                        _ => return Err(broken(part)),
                    }
                    tail += 1;
                }
            }
        }
        if ends < 2 {
            return Err(Error::BrokenLink {
                part: "its lists of joints and links do not end".to_owned(),
            });
        }
        Ok(read)
    }

    /// Reads the last section: marks for editing, each with a letter.
    fn marks(&mut self, part: &str) {
        for mark in part.split(',').filter(|mark| !mark.is_empty()) {
            match mark.as_bytes()[0] {
                b'J' | b'L' | b'F' => self.others.see("locks"),
                b'H' => self.others.see("held lengths and angles"),
                b'C' => self.others.see("anchors of centres of mass"),
                b'S' => self.others.see("synthesis"),
                b'K' => self.others.see("colours"),
                _ => self.others.miss("mark", mark),
            }
        }
    }
}

/// Returns a query without what proves it: a check character, which former links do not have, or what
/// is behind a `*`, of which nothing is known.
fn without_digest(query: &str) -> Result<&str, Error> {
    if let Some((content, digest)) = query.rsplit_once('*')
        && digest.bytes().all(|byte| digit(byte).is_some())
    {
        return Ok(content);
    }
    // Former links end with their lists.
    let Some(last) = query.chars().next_back().filter(|last| *last != '.') else {
        return Ok(query);
    };
    let content = &query[..query.len() - last.len_utf8()];
    if last != check(content) {
        return Err(Error::BrokenLink {
            part: "its check character does not fit its length".to_owned(),
        });
    }
    Ok(content)
}

impl Joint {
    fn read(part: &str, others: &mut Others) -> Result<Self, Error> {
        let wrong = || broken(part);
        let first = part.chars().next().ok_or_else(wrong)?;
        let flags = u8::try_from(first).ok().and_then(digit).ok_or_else(wrong)?;
        let mut tokens = part[first.len_utf8()..].split(',');
        let mut token = || tokens.next().ok_or_else(wrong);
        let (id, name) = (token()?, token()?);
        let mut number = || decimal(token()?).ok_or_else(wrong);
        let (x, y, angle) = (number()?, number()?, number()?);
        let name = if name.is_empty() { id } else { name };
        let has = |bit: u32| flags >> bit & 1 == 1;
        let mut further = || tokens.next().unwrap_or_default();
        let slot = [further(), further(), further()];
        let slot = match slot.iter().filter(|id| !id.is_empty()).count() {
            0 => None,
            3 => Some(slot.map(str::to_owned)),
            _ => return Err(wrong()),
        };
        let speed = match further() {
            "" => None,
            speed => Some(decimal(speed).ok_or_else(wrong)?),
        };
        if tokens.any(|token| !matches!(token, "" | "0")) {
            others.miss("further fields of joint", id);
        }
        Ok(Self {
            id: id.to_owned(),
            name: name.to_owned(),
            at: [x, y],
            angle,
            is_prismatic: has(0),
            is_input: has(1),
            is_grounded: has(2),
            is_welded: has(3),
            shows_curve: has(4),
            slot,
            speed: speed.filter(|speed| *speed != 0.0),
        })
    }
}

impl Link {
    fn read(part: &str) -> Result<Self, Error> {
        let wrong = || broken(part);
        let (kinds, rest) = part.split_at_checked(2).ok_or_else(wrong)?;
        // Letters are bars, digits discs; they differ in what the author chose of masses.
        let (is_root, is_block) = match kinds.as_bytes() {
            [b'Y' | b'A' | b'M' | b'G' | b'0'..=b'3', kind] => (true, kind),
            [b'N' | b'a' | b'm' | b'g' | b'4'..=b'7', kind] => (false, kind),
            _ => return Err(wrong()),
        };
        let is_block = match is_block {
            b'R' => false,
            b'P' => true,
            _ => return Err(wrong()),
        };
        let tokens: Vec<&str> = rest.split(',').collect();
        let [id, name, mass, inertia, x, y, _colour, joints @ ..] = &tokens[..] else {
            return Err(wrong());
        };
        let number = |text: &str| decimal(text).ok_or_else(wrong);
        let mut lists = joints.split(|id| id.is_empty());
        let mut list = || -> Vec<String> {
            let ids = lists.next().unwrap_or_default();
            ids.iter().map(|id| (*id).to_owned()).collect()
        };
        let name = if name.is_empty() { id } else { name };
        Ok(Self {
            is_root,
            is_block,
            id: (*id).to_owned(),
            name: (*name).to_owned(),
            mass: number(mass)?,
            inertia: number(inertia)?,
            center: [number(x)?, number(y)?],
            joints: list(),
            parts: list(),
        })
    }
}

impl Force {
    fn read(part: &str) -> Result<Self, Error> {
        let wrong = || broken(part);
        let first = part.chars().next().ok_or_else(wrong)?;
        let flags = u8::try_from(first).ok().and_then(digit).ok_or_else(wrong)?;
        let tokens: Vec<&str> = part[first.len_utf8()..].split(',').collect();
        let [id, link, name, x, y, to_x, to_y, size] = tokens[..] else {
            return Err(wrong());
        };
        let number = |text: &str| decimal(text).ok_or_else(wrong);
        Ok(Self {
            name: if name.is_empty() { id } else { name }.to_owned(),
            link: link.to_owned(),
            is_local: flags & 1 == 1,
            is_outward: flags & 2 == 2,
            line: [[number(x)?, number(y)?], [number(to_x)?, number(to_y)?]],
            size: number(size)?,
        })
    }
}
