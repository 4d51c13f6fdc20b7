//! Units of quantities. All inside is SI; a unit serves the FMU's description and labels.

mod name;
mod written;

pub use name::UnitName;
pub use written::{UnitFault, size_of_unit, symbols};

/// A unit of the International System with its exponents of the base units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// Its symbol, as in `unit = "rad/s"`.
    pub name: UnitName,
    /// Its dimension.
    pub dimension: Dimension,
    /// The unit in which a host should show the values, if not this one.
    pub display: Option<DisplayUnit>,
}

/// Exponents of the base units, as FMI's `BaseUnit` has them: the angle counts as one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Dimension {
    /// Exponent of the kilogram.
    pub kg: i8,
    /// Exponent of the metre.
    pub m: i8,
    /// Exponent of the second.
    pub s: i8,
    /// Exponent of the radian.
    pub rad: i8,
    /// Exponent of the ampere.
    pub a: i8,
    /// Exponent of the kelvin.
    pub k: i8,
}

/// A unit for showing values to people: shown = factor × SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DisplayUnit {
    /// Its symbol, as in `display = "mm"`.
    pub name: UnitName,
    /// Factor from an SI value to the value shown.
    pub factor: f64,
    /// Its dimension.
    pub dimension: Dimension,
}

const fn dimension(kg: i8, m: i8, s: i8, rad: i8) -> Dimension {
    electric([kg, m, s, rad], 0)
}

const fn electric([kg, m, s, rad]: [i8; 4], a: i8) -> Dimension {
    Dimension {
        kg,
        m,
        s,
        rad,
        a,
        k: 0,
    }
}

const LENGTH: Dimension = Dimension::LENGTH;
const ANGLE: Dimension = Dimension::ANGLE;
const ANGULAR_VELOCITY: Dimension = Dimension::ANGULAR_VELOCITY;
const ANGULAR_ACCELERATION: Dimension = dimension(0, 0, -2, 1);
const MASS: Dimension = dimension(1, 0, 0, 0);

impl Dimension {
    /// Dimension of a plain number.
    pub const ONE: Self = dimension(0, 0, 0, 0);
    /// Dimension of a length.
    pub const LENGTH: Self = dimension(0, 1, 0, 0);
    /// Dimension of an angle.
    pub const ANGLE: Self = dimension(0, 0, 0, 1);
    /// Dimension of an angular velocity.
    pub const ANGULAR_VELOCITY: Self = dimension(0, 0, -1, 1);

    fn exponents(self) -> [i8; 6] {
        [self.kg, self.m, self.s, self.rad, self.a, self.k]
    }

    /// Returns the base units that it has, with their exponents.
    pub fn base_units(self) -> impl Iterator<Item = (&'static str, i8)> {
        let all = ["kg", "m", "s", "rad", "A", "K"]
            .into_iter()
            .zip(self.exponents());
        all.filter(|(_, exponent)| *exponent != 0)
    }

    fn of(exponents: [Option<i8>; 6]) -> Option<Self> {
        let [kg, m, s, rad, a, k] = exponents;
        Some(Self {
            k: k?,
            ..electric([kg?, m?, s?, rad?], a?)
        })
    }

    /// Returns a unit of this dimension, as a file writes it: `N`, `m3/s`, `kg/(s2.K)`.
    #[must_use]
    pub fn symbol(self) -> String {
        if let Some(unit) = Unit::ALL.iter().find(|unit| unit.dimension == self) {
            return unit.name.to_string();
        }
        let part = |is_above: bool| {
            let powers = self.base_units();
            let powers = powers.filter(|(_, power)| (*power > 0) == is_above);
            let powers = powers.map(|(name, power)| match power.unsigned_abs() {
                1 => name.to_owned(),
                power => format!("{name}{power}"),
            });
            powers.collect::<Vec<_>>()
        };
        let [above, below] = [true, false].map(part);
        let above = if above.is_empty() {
            "1".to_owned()
        } else {
            above.join(".")
        };
        match &below[..] {
            [] => above,
            [below] => format!("{above}/{below}"),
            below => format!("{above}/({})", below.join(".")),
        }
    }

    /// Returns the dimension of a product; `None` if an exponent is too large.
    #[must_use]
    pub fn times(self, other: Self) -> Option<Self> {
        let (a, b) = (self.exponents(), other.exponents());
        Self::of([0, 1, 2, 3, 4, 5].map(|k| a[k].checked_add(b[k])))
    }

    /// Returns the dimension of a power; `None` if an exponent is too large or no whole number.
    #[must_use]
    pub fn to_power(self, power: f64) -> Option<Self> {
        Self::of(self.exponents().map(|exponent| {
            let scaled = f64::from(exponent) * power;
            let is_whole = scaled.fract() == 0.0 && scaled.abs() <= f64::from(i8::MAX);
            is_whole.then_some(scaled as i8)
        }))
    }

    /// Returns whether quantities of two dimensions can be added. An arc, radius times angle, is a
    /// length: radians count only where nothing else does.
    #[must_use]
    pub fn agrees_with(self, other: Self) -> bool {
        let without_angle = |dimension: Self| Self {
            rad: 0,
            ..dimension
        };
        without_angle(self) == without_angle(other) || self == Self::ONE || other == Self::ONE
    }
}

impl Unit {
    /// `1`: a plain number.
    pub const ONE: Self = Self::new("1", dimension(0, 0, 0, 0));
    /// `m`.
    pub const METRE: Self = Self::new("m", LENGTH);
    /// `rad`, shown in degrees unless the file says otherwise.
    pub const RADIAN: Self = Self::new("rad", ANGLE).shown_in(DisplayUnit::DEGREE);
    /// `s`.
    pub const SECOND: Self = Self::new("s", dimension(0, 0, 1, 0));
    /// `kg`.
    pub const KILOGRAM: Self = Self::new("kg", MASS);
    /// `N`.
    pub const NEWTON: Self = Self::new("N", dimension(1, 1, -2, 0));
    /// `N.m`.
    pub const NEWTON_METRE: Self = Self::new("N.m", dimension(1, 2, -2, 0));
    /// `J`.
    pub const JOULE: Self = Self::new("J", dimension(1, 2, -2, 0));
    /// `W`.
    pub const WATT: Self = Self::new("W", dimension(1, 2, -3, 0));
    /// `m/s`.
    pub const METRE_PER_SECOND: Self = Self::new("m/s", dimension(0, 1, -1, 0));
    /// `m/s2`.
    pub const METRE_PER_SECOND_SQUARED: Self = Self::new("m/s2", dimension(0, 1, -2, 0));
    /// `rad/s`, shown in degrees per second unless the file says otherwise.
    pub const RADIAN_PER_SECOND: Self =
        Self::new("rad/s", ANGULAR_VELOCITY).shown_in(DisplayUnit::DEGREE_PER_SECOND);
    /// `rad/s2`, shown in degrees per second squared unless the file says otherwise.
    pub const RADIAN_PER_SECOND_SQUARED: Self =
        Self::new("rad/s2", ANGULAR_ACCELERATION).shown_in(DisplayUnit::DEGREE_PER_SECOND_SQUARED);
    /// `kg.m2`.
    pub const KILOGRAM_METRE_SQUARED: Self = Self::new("kg.m2", dimension(1, 2, 0, 0));
    /// `1/s`.
    pub const PER_SECOND: Self = Self::new("1/s", dimension(0, 0, -1, 0));
    /// `N/m`: stiffness of a spring.
    pub const NEWTON_PER_METRE: Self = Self::new("N/m", dimension(1, 0, -2, 0));
    /// `N.m/rad`: stiffness of a torsion spring.
    pub const NEWTON_METRE_PER_RADIAN: Self = Self::new("N.m/rad", dimension(1, 2, -2, -1));
    /// `N.s/m`: coefficient of a damper.
    pub const NEWTON_SECOND_PER_METRE: Self = Self::new("N.s/m", dimension(1, 0, -1, 0));
    /// `N.m.s/rad`: coefficient of a torsion damper.
    pub const NEWTON_METRE_SECOND_PER_RADIAN: Self =
        Self::new("N.m.s/rad", dimension(1, 2, -1, -1));
    /// `Pa`.
    pub const PASCAL: Self = Self::new("Pa", dimension(1, -1, -2, 0));
    /// `Hz`.
    pub const HERTZ: Self = Self::new("Hz", dimension(0, 0, -1, 0));
    /// `A`.
    pub const AMPERE: Self = Self::new("A", electric([0; 4], 1));
    /// `V`.
    pub const VOLT: Self = Self::new("V", electric([1, 2, -3, 0], -1));
    /// `ohm`.
    pub const OHM: Self = Self::new("ohm", electric([1, 2, -3, 0], -2));
    /// `K`.
    pub const KELVIN: Self = Self::new(
        "K",
        Dimension {
            k: 1,
            ..Dimension::ONE
        },
    );
    /// `N.m/A`: constant of a motor.
    pub const NEWTON_METRE_PER_AMPERE: Self = Self::new("N.m/A", electric([1, 2, -2, 0], -1));
    /// `V.s/rad`: the same.
    pub const VOLT_SECOND_PER_RADIAN: Self = Self::new("V.s/rad", electric([1, 2, -2, -1], -1));

    /// The units that have names here, in the order of the format's documentation; a file may name any
    /// product and quotient of SI units.
    pub const ALL: [Self; 27] = [
        Self::ONE,
        Self::METRE,
        Self::RADIAN,
        Self::SECOND,
        Self::KILOGRAM,
        Self::NEWTON,
        Self::NEWTON_METRE,
        Self::JOULE,
        Self::WATT,
        Self::METRE_PER_SECOND,
        Self::METRE_PER_SECOND_SQUARED,
        Self::RADIAN_PER_SECOND,
        Self::RADIAN_PER_SECOND_SQUARED,
        Self::KILOGRAM_METRE_SQUARED,
        Self::PER_SECOND,
        Self::NEWTON_PER_METRE,
        Self::NEWTON_METRE_PER_RADIAN,
        Self::NEWTON_SECOND_PER_METRE,
        Self::NEWTON_METRE_SECOND_PER_RADIAN,
        Self::PASCAL,
        Self::HERTZ,
        Self::AMPERE,
        Self::VOLT,
        Self::OHM,
        Self::NEWTON_METRE_PER_AMPERE,
        Self::VOLT_SECOND_PER_RADIAN,
        Self::KELVIN,
    ];

    /// Returns the unit as it stands behind a number: a blank and its symbol, nothing for a plain
    /// number.
    #[must_use]
    pub fn suffix(self) -> String {
        if self == Self::ONE {
            String::new()
        } else {
            format!(" {}", self.name)
        }
    }

    const fn new(name: &'static str, dimension: Dimension) -> Self {
        Self {
            name: UnitName::new(name),
            dimension,
            display: None,
        }
    }

    /// Returns the name of the unit in which values are shown.
    #[must_use]
    pub fn display_name(self) -> UnitName {
        self.display.map_or(self.name, |display| display.name)
    }

    /// Returns the factor from an SI value to the value shown.
    #[must_use]
    pub fn display_factor(self) -> f64 {
        self.display.map_or(1.0, |display| display.factor)
    }

    /// Returns the unit with its values shown in `display`, which must be of the same dimension.
    #[must_use]
    pub const fn shown_in(self, display: DisplayUnit) -> Self {
        Self {
            display: Some(display),
            ..self
        }
    }

    /// Returns the SI unit that is written like this; `None` for another unit, and for what is none.
    #[must_use]
    pub fn by_name(name: &str) -> Option<Self> {
        let known = Self::ALL.into_iter().find(|unit| unit.name == name);
        known.or_else(|| DisplayUnit::read(name).ok()?.as_si())
    }

    /// Returns the display units of the same dimension.
    pub fn display_units(self) -> impl Iterator<Item = DisplayUnit> {
        DisplayUnit::ALL
            .into_iter()
            .filter(move |display| display.dimension == self.dimension)
    }
}

impl DisplayUnit {
    /// The metre.
    pub const METRE: Self = Self {
        name: UnitName::new("m"),
        factor: 1.0,
        dimension: LENGTH,
    };

    /// `mm`.
    pub const MILLIMETRE: Self = Self::new("mm", 1e3, LENGTH);
    /// `cm`.
    pub const CENTIMETRE: Self = Self::new("cm", 1e2, LENGTH);
    /// `deg`.
    pub const DEGREE: Self = Self::new("deg", DEGREES_PER_RADIAN, ANGLE);
    /// `deg/s`.
    pub const DEGREE_PER_SECOND: Self = Self::new("deg/s", DEGREES_PER_RADIAN, ANGULAR_VELOCITY);
    /// `deg/s2`.
    pub const DEGREE_PER_SECOND_SQUARED: Self =
        Self::new("deg/s2", DEGREES_PER_RADIAN, ANGULAR_ACCELERATION);
    /// `rpm`: turns per minute.
    pub const TURN_PER_MINUTE: Self =
        Self::new("rpm", 30.0 / std::f64::consts::PI, ANGULAR_VELOCITY);
    /// `g`.
    pub const GRAM: Self = Self::new("g", 1e3, MASS);

    /// The units that messages propose, in the order of the format's documentation; a file may name any
    /// product and quotient of symbols.
    pub const ALL: [Self; 7] = [
        Self::MILLIMETRE,
        Self::CENTIMETRE,
        Self::DEGREE,
        Self::DEGREE_PER_SECOND,
        Self::DEGREE_PER_SECOND_SQUARED,
        Self::TURN_PER_MINUTE,
        Self::GRAM,
    ];

    const fn new(name: &'static str, factor: f64, dimension: Dimension) -> Self {
        Self {
            name: UnitName::new(name),
            factor,
            dimension,
        }
    }

    /// Returns it as an SI unit, if it is one.
    #[must_use]
    pub fn as_si(self) -> Option<Unit> {
        let known = || Unit::ALL.into_iter().find(|unit| unit.name == self.name);
        let is_si = self.factor.to_bits() == 1.0_f64.to_bits();
        is_si.then(|| {
            known().unwrap_or(Unit {
                name: self.name,
                dimension: self.dimension,
                display: None,
            })
        })
    }
}

const DEGREES_PER_RADIAN: f64 = 180.0 / std::f64::consts::PI;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_unit_is_found_by_its_name() {
        for unit in Unit::ALL {
            assert_eq!(Unit::by_name(&unit.name), Some(unit));
        }
        for unit in DisplayUnit::ALL {
            assert_eq!(DisplayUnit::read(&unit.name), Ok(unit));
        }
        assert_eq!(Unit::by_name("mm"), None);
    }

    #[test]
    fn units_are_products_and_quotients_of_symbols() {
        for (text, symbol, size) in [
            ("kN", "N", 1e3),
            ("kN.m", "N.m", 1e3),
            ("bar", "Pa", 1e5),
            ("mbar", "Pa", 1e2),
            ("l/min", "m3/s", 1e-3 / 60.0),
            ("m3/s", "m3/s", 1.0),
            ("m3.s-1", "m3/s", 1.0),
            ("g.mm2", "kg.m2", 1e-9),
            ("kW.h", "N.m", 3.6e6),
            ("N/mm2", "Pa", 1e6),
            ("W/(m2.K)", "kg/(s3.K)", 1.0),
            ("m/s/s", "m/s2", 1.0),
            ("(m/s)2", "m2/s2", 1.0),
            ("1/min", "1/s", 1.0 / 60.0),
            ("deg/rev", "1", 1.0 / 360.0),
            ("daN", "N", 10.0),
            ("µm", "m", 1e-6),
            ("C", "s.A", 1.0),
            ("V.s/m2", "kg/(s2.A)", 1.0),
            ("%", "1", 0.01),
            // A pound per square inch is 6894.757 293 168 Pa.
            ("lbf/inch2", "Pa", 6_894.757_293_168_361),
        ] {
            let unit = DisplayUnit::read(text).expect(text);
            assert_eq!(unit.dimension.symbol(), symbol, "{text}");
            let found = size_of_unit(text).expect(text);
            assert!((found / size - 1.0).abs() <= 4.0 * f64::EPSILON, "{text}");
            assert!((found * unit.factor - 1.0).abs() <= 2.0 * f64::EPSILON);
            let is_si = size.to_bits() == 1.0_f64.to_bits();
            assert_eq!(Unit::by_name(text).is_some(), is_si, "{text}");
        }
    }

    #[test]
    fn a_symbol_of_a_dimension_is_read_again() {
        for text in ["W/(m2.K)", "V.s/m2", "1/(s.rad)", "A2.s4/kg", "N.m.s/rad"] {
            let unit = DisplayUnit::read(text).expect(text);
            let again = Unit::by_name(&unit.dimension.symbol()).expect(text);
            assert_eq!(again.dimension, unit.dimension, "{text}");
        }
    }

    #[test]
    fn what_is_no_unit_is_told() {
        let fault = |text: &str| DisplayUnit::read(text).expect_err(text);
        assert_eq!(fault("N.mx/s"), UnitFault::Symbol(2..4));
        assert_eq!(fault("kh"), UnitFault::Symbol(0..2));
        for (text, brackets) in [
            ("W/m2.K", "W/(m2.K)"),
            ("J/kg.K.s", "J/(kg.K.s)"),
            ("m/s/m.s", "m/s/(m.s)"),
        ] {
            assert_eq!(fault(text), UnitFault::Ambiguous(brackets.to_owned()));
            assert!(DisplayUnit::read(brackets).is_ok());
        }
        let long = "m.".repeat(40);
        for text in [
            "", " ", "m ", "m^2", "m²", "m.", ".m", "m//s", "(m", "m)", "2", "10/s", "m-", "m999",
            &long,
        ] {
            assert_eq!(fault(text), UnitFault::Form, "{text}");
        }
    }

    #[test]
    fn display_units_have_the_dimension_of_their_unit() {
        for unit in Unit::ALL {
            if let Some(display) = unit.display {
                assert_eq!(display.dimension, unit.dimension, "{}", unit.name);
            }
        }
        let names: Vec<UnitName> = Unit::RADIAN_PER_SECOND
            .display_units()
            .map(|unit| unit.name)
            .collect();
        assert_eq!(names, ["deg/s", "rpm"]);
        assert_eq!(Unit::PER_SECOND.display_units().count(), 0);
    }

    #[test]
    fn factors_bring_si_to_the_display_unit() {
        let turn_per_second = std::f64::consts::TAU;
        assert!((DisplayUnit::TURN_PER_MINUTE.factor * turn_per_second - 60.0).abs() < 1e-13);
        assert!((DisplayUnit::DEGREE.factor * std::f64::consts::PI - 180.0).abs() < 1e-13);
    }
}
