//! Typed indices of bodies, markers, shapes, drivers and parameters.

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(pub usize);

        impl $name {
            /// Returns the position in the mechanism's list.
            #[must_use]
            pub fn index(self) -> usize {
                self.0
            }
        }
    };
}

id!(
    /// Moving body: index into [`Mechanism::bodies`](super::Mechanism::bodies). Ground has none.
    BodyId
);
id!(
    /// Marker on a body or on ground: index into [`Mechanism::markers`](super::Mechanism::markers).
    MarkerId
);
id!(
    /// Driver: index into [`Mechanism::drivers`](super::Mechanism::drivers).
    DriverId
);
id!(
    /// Shape of a body or of ground: index into [`Mechanism::shapes`](super::Mechanism::shapes).
    ShapeId
);
id!(
    /// Parameter: index into [`Mechanism::parameters`](super::Mechanism::parameters).
    ParameterId
);
