//! Remarks on what did not come over, or came over changed.

/// A remark on an imported mechanism, for the user and for a comment of its file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Note {
    /// A driver that the source does not have.
    #[error("the source has no motion: `{driver}` is a driver, an input")]
    DriverChosen {
        /// Name of the driver.
        driver: String,
    },
    /// A body without joints.
    #[error("`{name}` is left out: no joint holds it")]
    LooseBody {
        /// Name in the source.
        name: String,
    },
    /// Parts that became one body.
    #[error("`{other}` is one body with `{name}`: the source fixes them to each other")]
    Merged {
        /// Name of the body.
        name: String,
        /// Name of the part that it took up.
        other: String,
    },
    /// A part that became ground.
    #[error("`{name}` is part of ground: the source fixes it there")]
    Grounded {
        /// Name in the source.
        name: String,
    },
    /// A joint that the plane makes superfluous.
    #[error("joint `{joint}` (`{class}`) is left out: it holds nothing in the plane")]
    HoldsNothing {
        /// Name of the joint.
        joint: String,
        /// Its class in the source.
        class: String,
    },
    /// A motion that biela cannot write.
    #[error(
        "the motion of `{name}` is left out, its coordinate is an input: `{text}` has no counterpart"
    )]
    Motion {
        /// Name of the motion.
        name: String,
        /// Expression or class in the source.
        text: String,
    },
    /// A limit that biela cannot write.
    #[error("limit `{name}` is left out: {reason}")]
    Limit {
        /// Name of the limit.
        name: String,
        /// Reason.
        reason: &'static str,
    },
    /// Masses that stand for none.
    #[error("masses are left out: {reason}")]
    Masses {
        /// Reason.
        reason: &'static str,
    },
    /// Velocities at the start that nothing takes up.
    #[error("velocities at the start are left out: {reason}")]
    StartVelocities {
        /// Reason.
        reason: &'static str,
    },
    /// Coordinates that the forces move.
    #[error("the source moves `{names}` by forces: freedoms, from where they are drawn")]
    Free {
        /// Names of the freedoms.
        names: String,
    },
    /// A body that joints do not keep in the plane.
    #[error("`{name}` is held by ball joints only: it is taken as its projection on the plane")]
    Projected {
        /// Name in the source.
        name: String,
    },
    /// A rod that is inclined to the plane.
    #[error("rod `{name}` is inclined to the plane: its length there is {length}")]
    Inclined {
        /// Name of the joint.
        name: String,
        /// Length in the plane, in the file's unit.
        length: String,
    },
    /// An input that another program cannot leave open.
    #[error(
        "driver `{name}` is an input: it is held at its start there; --drive gives it a motion"
    )]
    Held {
        /// Name of the driver.
        name: String,
    },
    /// Units of masses.
    #[error("masses and inertias are taken as {unit}")]
    MassUnit {
        /// Names of both units.
        unit: &'static str,
    },
    /// The sense of an input's own speed.
    #[error("input `{name}` has its own speed: it was taken as counter-clockwise")]
    OwnSpeed {
        /// Name of the pin.
        name: String,
    },
    /// Parts of the file that are only seen, or that only its program needs.
    #[error("left out, as they do not change the mechanism: {what}")]
    Display {
        /// Kinds of what was seen.
        what: String,
    },
    /// A unit that was assumed.
    #[error("the source names no unit of length: taken as {unit}; --length names another")]
    Unit {
        /// Name of the unit.
        unit: &'static str,
    },
    /// Motion per step, not per second.
    #[error("the speed of `{name}` is one per step, not per second: its angle is an input")]
    PerStep {
        /// Name of the driver.
        name: String,
    },
    /// A motor between two bodies that move.
    #[error("input `{name}` moves itself: it turns the second of its links against the first")]
    MovingInput {
        /// Name of the pin.
        name: String,
    },
    /// A point that is put elsewhere.
    #[error("`{name}` is moved to where it can be: {reason}")]
    Moved {
        /// Name in the source.
        name: String,
        /// Reason.
        reason: &'static str,
    },
    /// Entries of the source whose meaning is not known.
    #[error("left out, as their meaning is not known: {what}")]
    UnknownKeys {
        /// Names of the entries.
        what: String,
    },
    /// Something that is not connected to a body.
    #[error("{kind} `{name}` is left out: {reason}")]
    LeftOut {
        /// Kind in the source.
        kind: &'static str,
        /// Name in the source.
        name: String,
        /// Reason.
        reason: &'static str,
    },
    /// Entities of a drawing without a meaning.
    #[error("{count} × {kind} left out: {reason}")]
    Entities {
        /// Number of them.
        count: usize,
        /// Kind of the entity.
        kind: String,
        /// Reason.
        reason: &'static str,
    },
    /// A contour that a drawing leaves out.
    #[error("layer `{layer}` is left out: the curve has a cusp there")]
    Cusp {
        /// Name of the layer.
        layer: String,
    },
}
