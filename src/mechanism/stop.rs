//! Stops: where a coordinate may not go.

use super::{
    Coordinate, ElasticStop, Expression, Force, ForceLaw, Load, Number, ParameterId, PassiveCause,
    force,
};

/// Limits that a coordinate does not pass.
#[derive(Clone, Debug)]
pub struct Stop {
    /// Name, unique among all named things of the mechanism.
    pub name: String,
    /// Description in one line, empty if the file gives none.
    pub description: String,
    /// Coordinate that is limited.
    pub coordinate: Coordinate,
    /// Name of the measure or driver whose coordinate it is, `None` if the file gives the
    /// coordinate itself.
    pub of: Option<String>,
    /// Least value \[m or rad\]. There is one limit at least.
    pub min: Option<Expression>,
    /// Largest value \[m or rad\], above the least one.
    pub max: Option<Expression>,
    /// Behaviour at the limits.
    pub contact: StopContact,
}

/// Behaviour at a limit of a stop.
#[derive(Clone, Debug)]
pub enum StopContact {
    /// The coordinate does not go beyond. Where it is driven the motion ends; where forces move it,
    /// it bounces with this part of its velocity, from 0 to 1.
    Rigid {
        /// Coefficient of restitution, `None` for zero.
        restitution: Option<Expression>,
    },
    /// The coordinate goes beyond against a spring and a damper.
    Elastic {
        /// Stiffness \[N/m or N m/rad\].
        stiffness: Expression,
        /// Coefficient of the damper \[N s/m or N m s/rad\].
        damping: Option<Expression>,
    },
}

impl Stop {
    /// Returns whether the coordinate does not go beyond its limits.
    #[must_use]
    pub fn is_rigid(&self) -> bool {
        matches!(self.contact, StopContact::Rigid { .. })
    }

    /// Returns the coefficient of restitution, `None` for zero and for an elastic stop.
    #[must_use]
    pub fn restitution(&self) -> Option<&Expression> {
        match &self.contact {
            StopContact::Rigid { restitution } => restitution.as_ref(),
            StopContact::Elastic { .. } => None,
        }
    }

    /// Returns least and largest value \[m or rad\] for these parameters, infinite without a limit.
    /// Allocates nothing.
    #[must_use]
    pub fn limits<N: Number>(&self, parameter: &impl Fn(ParameterId) -> N) -> [N; 2] {
        force::limits([&self.min, &self.max], parameter)
    }

    /// Returns the word for the coordinate in messages.
    #[must_use]
    pub fn subject(&self) -> &str {
        self.of
            .as_deref()
            .unwrap_or_else(|| self.coordinate.kind.word())
    }

    /// Returns whether it exerts a force: a rigid stop does not where all is driven, as the motion ends there.
    pub(super) fn exerts(&self, has_freedoms: bool) -> bool {
        has_freedoms || !self.is_rigid()
    }

    /// Returns the force that the stop, which has this index, exerts along its coordinate or one of its
    /// elements: an elastic one by its law, a rigid one as the motion demands.
    pub(super) fn force(&self, index: usize, coordinate: Coordinate) -> Force {
        let load = match &self.contact {
            StopContact::Rigid { .. } => Load::Passive {
                coordinate,
                cause: PassiveCause::Stop(index),
            },
            StopContact::Elastic { stiffness, damping } => {
                let stop = ElasticStop {
                    limits: [self.min.clone(), self.max.clone()],
                    stiffness: stiffness.clone(),
                    damping: damping.clone(),
                };
                let stop = Some(Box::new(stop));
                Load::Coordinate {
                    coordinate,
                    law: Some(ForceLaw {
                        stop,
                        ..ForceLaw::default()
                    }),
                }
            }
        };
        Force {
            name: self.name.clone(),
            description: self.description.clone(),
            load,
        }
    }
}
