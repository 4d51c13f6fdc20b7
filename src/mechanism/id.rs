//! Typed indices: a body cannot be mistaken for a marker.

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(pub usize);

        impl $name {
            /// The position in the mechanism's list.
            #[must_use]
            pub fn index(self) -> usize {
                self.0
            }
        }
    };
}

id!(
    /// A moving body: index into [`Mechanism::bodies`](super::Mechanism::bodies). Ground has none.
    BodyId
);
id!(
    /// A marker, on a body or on ground: index into [`Mechanism::markers`](super::Mechanism::markers).
    MarkerId
);
id!(
    /// A driver: index into [`Mechanism::drivers`](super::Mechanism::drivers).
    DriverId
);
id!(
    /// A parameter: index into [`Mechanism::parameters`](super::Mechanism::parameters).
    ParameterId
);
