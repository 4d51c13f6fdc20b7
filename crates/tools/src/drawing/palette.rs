//! Colours on white that people with any colour vision can tell apart.

/// An opaque colour: red, green, blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Colour(pub [u8; 3]);

impl Colour {
    /// Dark lines: joints, labels of points.
    pub const INK: Self = Self([0x22, 0x22, 0x22]);
    /// Ground, with its hatching.
    pub const GROUND: Self = Self([0x55, 0x55, 0x55]);
    /// Paper.
    pub const WHITE: Self = Self([0xff, 0xff, 0xff]);
    /// Drivers: the vermillion of the palette of Okabe and Ito, which no body has.
    pub const DRIVER: Self = Self([0xd5, 0x5e, 0x00]);

    /// Forces that joints exert: a purple that no body has.
    pub const REACTION: Self = Self([0x6a, 0x3d, 0x9a]);

    /// Returns the colour of a body by its index in the mechanism: the palette of Okabe and Ito
    /// (2008) without vermillion and black, its yellow darkened for white paper, and a slate.
    #[must_use]
    pub fn of_body(index: usize) -> Self {
        const BODIES: [Colour; 7] = [
            Colour([0x00, 0x72, 0xb2]),
            Colour([0xe6, 0x9f, 0x00]),
            Colour([0x00, 0x9e, 0x73]),
            Colour([0xcc, 0x79, 0xa7]),
            Colour([0x56, 0xb4, 0xe9]),
            Colour([0x44, 0x54, 0x6a]),
            Colour([0xb5, 0xa3, 0x00]),
        ];
        BODIES[index % BODIES.len()]
    }

    /// Returns the colour mixed with white: the whole colour for 1, white for 0.
    #[must_use]
    pub fn tint(self, part: f64) -> Self {
        self.mix(Self::WHITE, part)
    }

    /// Returns the colour mixed with black: the whole colour for 1, black for 0.
    #[must_use]
    pub fn shade(self, part: f64) -> Self {
        self.mix(Self([0; 3]), part)
    }

    fn mix(self, other: Self, part: f64) -> Self {
        let mut mixed = self.0;
        for (channel, other) in mixed.iter_mut().zip(other.0) {
            let value = f64::from(*channel) * part + f64::from(other) * (1.0 - part);
            *channel = value.round() as u8;
        }
        Self(mixed)
    }

    /// Returns the colour as `#rrggbb`.
    #[must_use]
    pub fn hex(self) -> String {
        let [red, green, blue] = self.0;
        format!("#{red:02x}{green:02x}{blue:02x}")
    }
}
