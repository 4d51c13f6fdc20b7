//! Units: SI units of values, units for showing them, and units as factors.

use crate::mechanism::diagnostic::code;
use crate::mechanism::expression::CONSTANTS;
use crate::mechanism::names::nearest;
use crate::mechanism::syntax;
use crate::mechanism::wording::quoted;
use crate::mechanism::{DisplayUnit, Expression, Unit};
use crate::unit::{UnitFault, UnitName, size_of_unit, symbols};

use super::context::Context;
use super::kind::{Item, Kind, schema, word_here};
use super::number::{NUMBER, Quantity};

/// SI unit of a value.
pub(super) struct SiUnit {
    /// Whether another key says how the value is shown.
    pub(super) has_display: bool,
}

/// SI unit of a value that is shown as it is.
pub(super) const SI_UNIT: SiUnit = SiUnit { has_display: false };

/// Unit for showing a value.
pub(super) struct ShownUnit;

/// Factor of the numbers of a table: a number, an expression, or the unit in which they are.
pub(super) struct Factor;

/// Words for units, in any case and as plurals too, with their symbols.
const WORDS: [(&str, &str); 22] = [
    ("-", "1"),
    ("meter", "m"),
    ("metre", "m"),
    ("gram", "g"),
    ("sec", "s"),
    ("second", "s"),
    ("minute", "min"),
    ("hour", "h"),
    ("degree", "deg"),
    ("°", "deg"),
    ("radian", "rad"),
    ("turn", "rev"),
    ("newton", "N"),
    ("joule", "J"),
    ("watt", "W"),
    ("pascal", "Pa"),
    ("volt", "V"),
    ("ampere", "A"),
    ("amp", "A"),
    ("Ω", "ohm"),
    ("liter", "l"),
    ("litre", "l"),
];

/// Most symbols of a unit that a message corrects.
const MOST_SLIPS: usize = 4;

/// Returns a unit without signs: `Nm` of `N.m`, `N*m` and `N m`.
fn letters(unit: &str) -> String {
    let signs = ['.', '*', '·', '^', ' '];
    unit.replace(signs, "").replace('²', "2").replace('³', "3")
}

/// Returns the symbol of a word for a unit.
fn symbol_of_word(word: &str) -> Option<String> {
    let word = word.to_lowercase();
    let singular = word.strip_suffix('s').filter(|word| word.len() > 1);
    let mut words = WORDS.iter();
    let known = words.find(|(known, _)| {
        let known = known.to_lowercase();
        known == word || singular == Some(&known)
    });
    known.map(|(_, symbol)| (*symbol).to_owned())
}

/// Returns the symbol of a word, of a symbol in the plural, of two symbols without a point, or of a slip.
fn symbol_of(word: &str) -> Option<String> {
    let is_symbol = |text: &str| size_of_unit(text).is_ok();
    let singular = word.strip_suffix('s');
    let singular = singular.filter(|singular| singular.len() > 2 && is_symbol(singular));
    let together = || {
        let places = word.char_indices().map(|(at, _)| at).skip(1);
        let mut splits = places.map(|at| word.split_at(at));
        let (first, rest) = splits.find(|(first, rest)| is_symbol(first) && is_symbol(rest))?;
        Some(format!("{first}.{rest}"))
    };
    let slip = || {
        let symbols = symbols();
        let symbols: Vec<&str> = symbols.iter().map(String::as_str).collect();
        nearest(word, &symbols).map(str::to_owned)
    };
    let of_word = symbol_of_word(word).or_else(|| singular.map(str::to_owned));
    of_word.or_else(together).or_else(slip)
}

/// Returns the unit that a text which is none may mean.
fn meant(text: &str) -> Option<String> {
    // `Nm`, `N*m`, `m/s²`, `kg m^2`: other signs between the same letters.
    let is_meant = |unit: &&Unit| letters(&unit.name).eq_ignore_ascii_case(&letters(text));
    if let Some(unit) = Unit::ALL.iter().find(is_meant) {
        return Some(unit.name.to_string());
    }
    let mut meant = text.trim().replace(['*', '·', ' '], ".").replace('^', "");
    meant = meant.replace('²', "2").replace('³', "3");
    for _ in 0..=MOST_SLIPS {
        let fault = match DisplayUnit::read(&meant) {
            Ok(_) => return Some(meant),
            Err(fault) => fault,
        };
        match fault {
            UnitFault::Ambiguous(brackets) => meant = brackets,
            UnitFault::Symbol(place) => {
                let symbol = symbol_of(&meant[place.clone()])?;
                meant.replace_range(place, &symbol);
            }
            UnitFault::Form => meant = symbol_of_word(&meant)?,
        }
    }
    None
}

/// Reads a unit, which may have to be one of SI; reports a text that is none.
fn read<'a>(
    context: &mut Context<'a>,
    item: &Item<'_, 'a>,
    (noun, is_si): (&str, bool),
) -> Option<DisplayUnit> {
    let text = context.text(item.value)?;
    let fault = match DisplayUnit::read(text) {
        Ok(unit) => return Some(unit),
        Err(fault) => fault,
    };
    let (message, help) = match fault {
        UnitFault::Ambiguous(brackets) => (
            format!("the {noun} {} is ambiguous", quoted(text)),
            Some(format!(
                "a product below the line has brackets: `{brackets}`"
            )),
        ),
        _ => {
            let help = meant(text).map(|meant| match DisplayUnit::read(&meant) {
                Ok(unit) if is_si && unit.as_si().is_none() => in_si(unit),
                _ if letters(&meant) == letters(text) => word_here(&meant),
                _ => format!("did you mean `{meant}`?"),
            });
            let usual = || {
                "a unit is made of symbols such as `mm`, `kN`, `bar`, by `.`, `/`, exponents and \
                 brackets: `kN.m`, `l/min`, `m/s2`"
                    .to_owned()
            };
            let message = format!("no {noun} {}", quoted(text));
            (message, Some(help.unwrap_or_else(usual)))
        }
    };
    context.error(code::UNKNOWN_UNIT, item.span(), message).help = help;
    None
}

fn in_si(unit: DisplayUnit) -> String {
    format!("values are SI: give it in `{}`", unit.dimension.symbol())
}

/// Returns the JSON Schema of a unit, with those that editors propose.
fn schema_of(names: &[UnitName]) -> serde_json::Value {
    let names: Vec<&str> = names.iter().map(|name| &**name).collect();
    serde_json::json!({ "anyOf": [{ "enum": names }, { "type": "string" }] })
}

impl<'a> Kind<'a> for SiUnit {
    type Value = Unit;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<Unit> {
        let unit = read(context, item, ("unit", true))?;
        if let Some(si) = unit.as_si() {
            return Some(si);
        }
        let (name, si) = (unit.name, unit.dimension.symbol());
        // The author of `value = 50, unit = "mm"` means millimetres.
        let value = item.fields.table.get("value");
        let number = value.filter(|value| syntax::number(value.get_ref()).is_some());
        let number = number.and_then(|value| context.source.text().get(value.span()));
        let constant = name.split('/').next();
        let constant = constant.filter(|name| CONSTANTS.iter().any(|(known, _)| known == name));
        let value = match (number, constant) {
            (Some(number), Some(constant)) => format!("value = \"{number}*{constant}\", "),
            _ => String::new(),
        };
        let help = if self.has_display {
            format!("values are SI: `{value}unit = \"{si}\", display = \"{name}\"`")
        } else {
            in_si(unit)
        };
        let message = format!("`{name}` is not an SI unit");
        context
            .error(code::UNKNOWN_UNIT, item.span(), message)
            .suggest(help);
        None
    }

    fn schema(&self) -> serde_json::Value {
        schema_of(&Unit::ALL.map(|unit| unit.name))
    }
}

impl<'a> Kind<'a> for ShownUnit {
    type Value = DisplayUnit;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<DisplayUnit> {
        read(context, item, ("display unit", false))
    }

    fn schema(&self) -> serde_json::Value {
        schema_of(&DisplayUnit::ALL.map(|unit| unit.name))
    }
}

impl<'a> Kind<'a> for Factor {
    type Value = Quantity;

    fn read(&self, context: &mut Context<'a>, item: &Item<'_, 'a>) -> Option<Quantity> {
        let text = item.value.get_ref().as_str().unwrap_or_default();
        let mut words = text.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_'));
        let is_known = |word: &str| {
            let is_number = !word.starts_with(|c: char| c.is_ascii_alphabetic());
            let is_constant = CONSTANTS.iter().any(|(constant, _)| *constant == word);
            is_number || is_constant || context.parameters.get(word).is_some()
        };
        // Constants and parameters come first: a parameter may be called `bar`.
        if words.all(is_known) {
            return NUMBER.read(context, item);
        }
        if let Ok(size) = size_of_unit(text) {
            return Some(Quantity {
                expression: Expression::constant(size),
                value: Some(size),
                dimension: None,
                span: item.span(),
            });
        }
        let is_plain = text
            .chars()
            .all(|c| c.is_alphanumeric() || "./%".contains(c));
        match meant(text).filter(|_| is_plain && context.parameters.near(text, &[]).is_none()) {
            Some(_) => {
                read(context, item, ("unit", false));
                None
            }
            None => NUMBER.read(context, item),
        }
    }

    schema! { NUMBER.schema() }
}
