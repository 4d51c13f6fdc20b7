//! The query of a link, taken apart.

use percent_encoding::percent_decode_str;

use super::digits::{check, decimal, digit, integer};
use crate::exchange::draft::LengthUnit;
use crate::exchange::error::{Error, start_of};

pub(super) struct Query {
    pub(super) unit: LengthUnit,
    /// Speed of the inputs, negative for clockwise \[rpm\].
    pub(super) rpm: f64,
    pub(super) joints: Vec<Joint>,
    pub(super) links: Vec<Link>,
    pub(super) forces: usize,
    pub(super) has_masses: bool,
}

pub(super) struct Joint {
    pub(super) id: String,
    pub(super) name: String,
    pub(super) at: [f64; 2],
    pub(super) angle: f64,
    pub(super) is_prismatic: bool,
    pub(super) is_input: bool,
    pub(super) is_grounded: bool,
    pub(super) shows_curve: bool,
}

pub(super) struct Link {
    /// Whether no other link has it as its part.
    pub(super) is_root: bool,
    /// Whether it is the block of a slider.
    pub(super) is_block: bool,
    pub(super) name: String,
    pub(super) joints: Vec<String>,
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

impl Query {
    pub(super) fn read(query: &str) -> Result<Self, Error> {
        let mut parts = query.split('.');
        let mut setting = || parts.next().unwrap_or_default();
        let [bools, _decimals, integers, enums] = [setting(), setting(), setting(), setting()];
        // The first flag is the lowest bit.
        let clockwise = bools.bytes().next_back().and_then(digit);
        let clockwise = clockwise.ok_or_else(|| broken(bools))? & 1 == 1;
        let speed = integers.split(',').next().and_then(integer);
        let speed = speed.ok_or_else(|| broken(integers))?;
        let unit = enums.bytes().next().and_then(digit);
        let unit = LengthUnit::of_pmks(unit.ok_or_else(|| broken(enums))?);
        let mut read = Self {
            unit,
            rpm: if clockwise { -speed } else { speed },
            joints: Vec::new(),
            links: Vec::new(),
            forces: 0,
            has_masses: false,
        };
        let mut ends = 0;
        let mut tail = None;
        for part in parts {
            if tail.is_some() {
                return Err(broken(part));
            }
            match (ends, part) {
                (0..=2, "") => ends += 1,
                (0, part) => read.joints.push(Joint::read(part)?),
                (1, part) => {
                    let link = Link::read(part)?;
                    read.has_masses = true;
                    read.links.push(link);
                }
                (2, _) => read.forces += 1,
                (_, part) => tail = Some(part),
            }
        }
        if ends < 2 {
            return Err(Error::BrokenLink {
                part: "its lists of joints and links do not end".to_owned(),
            });
        }
        // Former links have no check character.
        if let Some(tail) = tail.filter(|tail| !tail.is_empty()) {
            let (content, last) = query.split_at(query.len() - last_length(tail));
            if !last.starts_with(check(content)) {
                return Err(Error::BrokenLink {
                    part: "its check character does not fit its length".to_owned(),
                });
            }
        }
        Ok(read)
    }
}

/// Returns the length of the last character of a text.
fn last_length(text: &str) -> usize {
    text.chars().next_back().map_or(0, char::len_utf8)
}

impl Joint {
    fn read(part: &str) -> Result<Self, Error> {
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
        Ok(Self {
            id: id.to_owned(),
            name: name.to_owned(),
            at: [x, y],
            angle,
            is_prismatic: has(0),
            is_input: has(1),
            is_grounded: has(2),
            shows_curve: has(4),
        })
    }
}

impl Link {
    fn read(part: &str) -> Result<Self, Error> {
        let wrong = || broken(part);
        let (kinds, rest) = part.split_at_checked(2).ok_or_else(wrong)?;
        let (is_root, is_block) = match kinds {
            "YR" => (true, false),
            "YP" => (true, true),
            "NR" => (false, false),
            "NP" => (false, true),
            _ => return Err(wrong()),
        };
        // Id, name, mass, inertia, centre and colour come before the joints.
        const BEFORE: usize = 7;
        let tokens: Vec<&str> = rest.split(',').collect();
        let joints = tokens.get(BEFORE..).ok_or_else(wrong)?;
        let joints = joints.iter().take_while(|id| !id.is_empty());
        let name = if tokens[1].is_empty() {
            tokens[0]
        } else {
            tokens[1]
        };
        Ok(Self {
            is_root,
            is_block,
            name: name.to_owned(),
            joints: joints.map(|id| (*id).to_owned()).collect(),
        })
    }
}
