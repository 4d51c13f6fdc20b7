//! Relative coordinates.

use super::wording::fixed_apart;
use super::{
    Driver, DriverId, DriverSource, FeatureRun, MarkerId, Mechanism, Order, ShapeId, Unit,
};

/// Scalar measured from one marker to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Coordinate {
    /// Quantity measured.
    pub kind: CoordinateKind,
    /// Marker i, measured from.
    pub from: MarkerId,
    /// Marker j, measured to.
    pub to: MarkerId,
    /// Marker k on whose axes `x` and `y` are measured; marker i unless the file gives another.
    /// Without meaning for `angle`, `distance` and `clearance`.
    pub axes: MarkerId,
}

impl Coordinate {
    /// Returns its markers; a marker may come twice.
    #[must_use]
    pub fn markers(&self) -> [MarkerId; 3] {
        [self.from, self.to, self.axes]
    }

    /// Returns the two shapes of a clearance.
    #[must_use]
    pub fn shapes(&self) -> Option<[ShapeId; 2]> {
        match self.kind {
            CoordinateKind::Clearance(shapes, _) => Some(shapes),
            _ => None,
        }
    }

    /// Returns its value \[m or rad\] where the markers are at these places: x, y \[m\] and angle
    /// \[rad\] in the global frame.
    pub fn between(&self, place: impl Fn(MarkerId) -> [f64; 3]) -> f64 {
        let [from, to, axes] = [self.from, self.to, self.axes].map(place);
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let (sin, cos) = axes[2].sin_cos();
        match self.kind {
            CoordinateKind::Angle => to[2] - from[2],
            CoordinateKind::X => cos * dx + sin * dy,
            CoordinateKind::Y => cos * dy - sin * dx,
            CoordinateKind::Distance => dx.hypot(dy),
            CoordinateKind::Clearance(..) => unreachable!("no freedom is a clearance"),
        }
    }

    /// Returns what it measures, as descriptions of variables say it.
    #[must_use]
    pub fn describe(&self, mechanism: &Mechanism) -> String {
        let [from, to, axes] = [self.from, self.to, self.axes].map(|id| mechanism.marker_path(id));
        let on_axes = if axes == from {
            String::new()
        } else {
            format!(" on the axes of `{axes}`")
        };
        match self.kind {
            CoordinateKind::Angle => format!("the angle from `{from}` to `{to}`"),
            CoordinateKind::X => format!("x from `{from}` to `{to}`{on_axes}"),
            CoordinateKind::Y => format!("y from `{from}` to `{to}`{on_axes}"),
            CoordinateKind::Distance => format!("the distance from `{from}` to `{to}`"),
            CoordinateKind::Clearance(shapes, _) => {
                let [a, b] = shapes.map(|id| mechanism.shape_path(id));
                format!("the clearance of `{a}` and `{b}`")
            }
        }
    }
}

impl Mechanism {
    /// Returns whether some of the drivers are freedoms.
    #[must_use]
    pub fn has_freedoms(&self) -> bool {
        self.drivers.iter().any(Driver::is_free)
    }

    /// Returns value and velocity of each freedom at the start, which a run may set, by the names of
    /// their variables.
    #[must_use]
    pub fn starts_of_freedoms(&self) -> Vec<(String, DriverId, Order)> {
        let drivers = self.drivers.iter().enumerate();
        let freedoms = drivers.filter(|(_, driver)| driver.is_free());
        let starts = freedoms.flat_map(|(index, driver)| {
            [("position", Order::Position), ("velocity", Order::Velocity)]
                .map(|(rate, order)| (format!("{}.{rate}", driver.name), DriverId(index), order))
        });
        starts.collect()
    }

    /// Sets value or velocity of a freedom at the start \[SI\].
    pub fn set_start(&mut self, freedom: DriverId, order: Order, to: f64) {
        let source = &mut self.drivers[freedom.index()].source;
        if let DriverSource::Free {
            start, velocity, ..
        } = source
        {
            match order {
                Order::Position => *start = to,
                Order::Velocity | Order::Acceleration => *velocity = to,
            }
        }
    }

    /// Lets freedoms without a start begin at the values that the estimates give.
    pub(super) fn start_at_estimates(&mut self) {
        let parameters = self.default_parameters();
        let starts: Vec<_> = self
            .drivers
            .iter()
            .map(|driver| self.estimated(driver.coordinate, &parameters))
            .collect();
        for (driver, estimated) in self.drivers.iter_mut().zip(starts) {
            if let DriverSource::Free { start, .. } = &mut driver.source
                && start.is_nan()
            {
                *start = estimated;
            }
        }
    }

    /// Returns the value of a coordinate where all bodies are at their estimates.
    fn estimated(&self, coordinate: Coordinate, parameters: &[f64]) -> f64 {
        let place = |id: MarkerId| {
            let marker = &self.markers[id.index()];
            let [x, y] = marker.position.each_ref().map(|e| e.value(parameters));
            let angle = marker.angle.value(parameters);
            let Some(body) = marker.body else {
                return [x, y, angle];
            };
            let estimate = &self.bodies[body.index()].estimate;
            let [x0, y0, phi] = estimate.each_ref().map(|e| e.value(parameters));
            let (sin, cos) = phi.sin_cos();
            [x0 + cos * x - sin * y, y0 + sin * x + cos * y, phi + angle]
        };
        coordinate.between(place)
    }
}

/// Relative coordinates. theta is a marker's direction, P its point, u and n the x- and
/// y-axis of marker k.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CoordinateKind {
    /// `theta_j − theta_i` \[rad\], counting turns.
    Angle,
    /// `u_k · (P_j − P_i)` \[m\].
    X,
    /// `n_k · (P_j − P_i)` \[m\].
    Y,
    /// `‖P_j − P_i‖` \[m\].
    Distance,
    /// Least distance of the outlines of two shapes, as far as runs of their features make them \[m\]. The
    /// markers are the first ones of both.
    Clearance([ShapeId; 2], [FeatureRun; 2]),
}

impl CoordinateKind {
    /// Units of a length and of its first and second time derivatives.
    pub const LENGTHS: [Unit; 3] = [
        Unit::METRE,
        Unit::METRE_PER_SECOND,
        Unit::METRE_PER_SECOND_SQUARED,
    ];
    /// Units of an angle and of its first and second time derivatives.
    pub const ANGLES: [Unit; 3] = [
        Unit::RADIAN,
        Unit::RADIAN_PER_SECOND,
        Unit::RADIAN_PER_SECOND_SQUARED,
    ];

    /// Returns its word in the file.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Angle => "angle",
            Self::X => "x",
            Self::Y => "y",
            Self::Distance => "distance",
            Self::Clearance(..) => "clearance",
        }
    }

    /// Returns the units of its values and of their first and second time derivatives.
    #[must_use]
    pub fn units(self) -> [Unit; 3] {
        if self.is_angle() {
            Self::ANGLES
        } else {
            Self::LENGTHS
        }
    }

    /// Returns whether the coordinate is measured on the axes of a marker.
    #[must_use]
    pub fn has_axes(self) -> bool {
        match self {
            Self::X | Self::Y => true,
            Self::Angle | Self::Distance | Self::Clearance(..) => false,
        }
    }

    /// Returns whether its values are angles; they are lengths otherwise.
    #[must_use]
    pub fn is_angle(self) -> bool {
        match self {
            Self::Angle => true,
            Self::X | Self::Y | Self::Distance | Self::Clearance(..) => false,
        }
    }

    /// Returns the unit of its values.
    #[must_use]
    pub fn unit(self) -> Unit {
        self.units()[0]
    }

    /// Returns the unit of a generalized force conjugate to it.
    #[must_use]
    pub fn effort_unit(self) -> Unit {
        if self.is_angle() {
            Unit::NEWTON_METRE
        } else {
            Unit::NEWTON
        }
    }

    /// Returns the word for a generalized force conjugate to it.
    #[must_use]
    pub fn effort_word(self) -> &'static str {
        if self.is_angle() { "torque" } else { "force" }
    }

    /// Returns the unit of the inertia that a driver feels.
    #[must_use]
    pub fn inertia_unit(self) -> Unit {
        if self.is_angle() {
            Unit::KILOGRAM_METRE_SQUARED
        } else {
            Unit::KILOGRAM
        }
    }

    /// Returns a value as text with its unit.
    #[must_use]
    pub fn show(self, value: f64) -> String {
        let [text, _] = self.show_apart(value, value);
        text
    }

    /// Returns two values as text with their unit, with as many digits as tell them apart.
    #[must_use]
    pub fn show_apart(self, a: f64, b: f64) -> [String; 2] {
        let [a_si, b_si] = fixed_apart(a, b, 9);
        if self.is_angle() {
            let [a, b] = fixed_apart(a.to_degrees(), b.to_degrees(), 6);
            [
                format!("{a_si} rad ({a} deg)"),
                format!("{b_si} rad ({b} deg)"),
            ]
        } else {
            [format!("{a_si} m"), format!("{b_si} m")]
        }
    }
}
