//! Shipped mechanisms with masses, springs, dampers and loads, in motion.

use std::sync::Arc;

use biela::kinematics::{DriverPath, ForceParts, Forces, KnownMotion, Path, Rates, Solver};
use biela::mechanism::{
    Coordinate, CoordinateKind, DriverSource, Expression, Force, ForceLaw, Jet, Load, MarkerId,
    Mechanism, Spring,
};

use crate::common::shipped;

/// A mechanism in motion with all its forces.
pub(crate) struct Loaded {
    pub(crate) solver: Solver,
    pub(crate) rates: Rates,
    pub(crate) driver_rates: Vec<Jet>,
    pub(crate) inputs: Vec<f64>,
    pub(crate) forces: Forces,
}

/// Numbers between 0 and 1 that are not special, in a fixed order.
pub(crate) fn spread(index: usize) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    (GOLDEN * (index + 1) as f64).fract()
}

/// Returns a shipped mechanism in which every body has a mass off its origin, and on which forces
/// of every kind act.
pub(crate) fn loaded(name: &str) -> Mechanism {
    let mut mechanism = Mechanism::clone(&shipped(name));
    let number = Expression::constant;
    for (index, body) in mechanism.bodies.iter_mut().enumerate() {
        body.mass = Some(number(0.5 + spread(index)));
        body.inertia = Some(number(0.02 * spread(index + 7)));
        body.center = Some([13, 29].map(|shift| number(0.1 * spread(index + shift) - 0.03)));
    }
    mechanism.simulation.gravity = [number(0.7), number(-9.81)];
    let on_ground = mechanism.markers.iter().position(|m| m.body.is_none());
    let moving = mechanism.markers.iter().position(|m| m.body.is_some());
    let last = mechanism.markers.len() - 1;
    let (Some(ground), Some(first)) = (on_ground, moving) else {
        return mechanism;
    };
    let [ground, first, last] = [ground, first, last].map(MarkerId);
    let mut add = |load| {
        let name = format!("load_{}", mechanism.forces.len());
        let description = String::new();
        mechanism.forces.push(Force {
            name,
            description,
            load,
        });
    };
    let along = |kind, axes| Coordinate {
        kind,
        from: ground,
        to: last,
        axes,
    };
    add(Load::Coordinate {
        coordinate: along(CoordinateKind::X, first),
        law: Some(ForceLaw {
            spring: Some(Spring {
                stiffness: number(120.0),
                free: number(0.05),
            }),
            damping: Some(number(3.0)),
            ..ForceLaw::default()
        }),
    });
    add(Load::Coordinate {
        coordinate: along(CoordinateKind::Angle, ground),
        law: Some(ForceLaw {
            value: Some(number(1.7)),
            is_constant: true,
            damping: Some(number(0.4)),
            ..ForceLaw::default()
        }),
    });
    add(Load::Coordinate {
        coordinate: along(CoordinateKind::Y, ground),
        law: None,
    });
    add(Load::Marker {
        marker: last,
        axes: Some(first),
        law: Some([11.0, -4.0, 0.9].map(number)),
    });
    add(Load::Marker {
        marker: first,
        axes: None,
        law: None,
    });
    mechanism
}

impl Loaded {
    /// Moves a mechanism a little from its start and gives its drivers rates.
    pub(crate) fn new(mechanism: Mechanism) -> Self {
        let mut solver = Solver::new(Arc::new(mechanism)).expect("the drivers match");
        let start = Path::new(solver.mechanism());
        solver.assemble(&start).expect("it assembles");
        let mut path = start;
        path.duration = 0.317;
        for driver_path in &mut path.driver_paths {
            if let DriverPath::Input { position, .. } = *driver_path {
                *driver_path = DriverPath::held(position + 0.003, position);
            }
        }
        solver.track(&path).expect("the way is free");
        let mechanism = Arc::clone(solver.mechanism());
        let drivers = mechanism.drivers.iter().enumerate();
        let driver_rates = drivers.map(|(index, driver)| match driver.source {
            DriverSource::Input { .. } | DriverSource::Free { .. } => {
                Jet::new(0.0, [0.7 + spread(index), -1.4 + spread(index + 3)])
            }
            DriverSource::Motion(_) => {
                solver.motion(biela::mechanism::DriverId(index), solver.pose().time)
            }
        });
        let driver_rates = driver_rates.collect();
        let inputs = (0..solver.forces().loads())
            .map(|k| 5.0 * spread(k) - 2.0)
            .collect();
        Self::solved(solver, driver_rates, inputs)
    }

    /// Solves rates and forces at the solver's pose.
    pub(crate) fn solved(solver: Solver, driver_rates: Vec<Jet>, inputs: Vec<f64>) -> Self {
        let mut loaded = Self {
            rates: Rates::new(solver.pose().q.len()),
            forces: solver.forces(),
            solver,
            driver_rates,
            inputs,
        };
        loaded.solve();
        loaded
    }

    /// Solves rates and forces for the rates of the drivers.
    pub(crate) fn solve(&mut self) {
        let Self {
            solver,
            rates,
            driver_rates,
            inputs,
            forces,
        } = self;
        let of = |driver: biela::mechanism::DriverId| driver_rates[driver.index()];
        solver.solve_rates(of, rates).expect("it is regular");
        let motion = KnownMotion {
            rates,
            driver_rates,
            inputs,
        };
        solver
            .solve_forces(motion, ForceParts::ALL, forces)
            .expect("forces have values");
    }
}
