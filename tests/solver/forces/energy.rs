//! Energy, inertia and the derivatives of forces.

use biela::kinematics::{Direction, ForceQuantity, Solution};
use biela::mechanism::{DriverId, Jet, Load};

use crate::common::{assembled, parse, stems};
use crate::forces::loaded::{Loaded, loaded};

/// A spring of constant force along a distance c has the energy −f c, and pulls as it is told.
#[test]
fn a_constant_spring_has_a_potential() {
    let mechanism = parse(
        r#"
format = 1
name = "band"
[parameters]
pull = 20
[ground.markers]
O = [0, 0]
A = [0, 0.3]
[bodies.slider]
markers = { P = [0, 0] }
[joints]
guide = { type = "translational", markers = ["ground.O", "slider.P"] }
[drivers]
way = { coordinate = "x", markers = ["ground.O", "slider.P"], start = 0.4 }
[forces]
band = { coordinate = "distance", markers = ["ground.A", "slider.P"], value = "-pull", constant = true }
"#,
    );
    let (mut solver, _) = assembled(&mechanism);
    let mut solution = Solution::new(&solver);
    solution.seek_forces(&solver);
    solution.solve(&mut solver).expect("it is regular");
    // c = 0.5 m, whose change along the way is 0.8.
    let energy = solution.force(ForceQuantity::PotentialEnergy);
    assert!((energy - 10.0).abs() < 1e-14, "{energy}");
    let effort = solution.force(ForceQuantity::Effort(DriverId(0)));
    assert!((effort - 16.0).abs() < 1e-14, "{effort}");
}

/// d(T + V)/dt is the power of drivers and of all forces but springs; the derivatives in time are
/// those along the motion itself.
#[test]
fn power_becomes_energy() {
    for name in stems("mechanisms", "toml") {
        let Loaded {
            mut solver,
            rates,
            driver_rates,
            inputs,
            mut forces,
        } = Loaded::new(loaded(&name));
        let mechanism = std::sync::Arc::clone(solver.mechanism());
        let direction = Direction {
            drivers: driver_rates
                .iter()
                .map(|jet| Jet::new(jet.first(), [jet.second(), 0.0]))
                .collect(),
            time: 1.0,
            ..Direction::zero(&mechanism)
        };
        let motion = biela::kinematics::KnownMotion {
            rates: &rates,
            driver_rates: &driver_rates,
            inputs: &inputs,
        };
        let along = solver
            .force_sensitivity(motion, &direction, &mut forces)
            .expect("it is regular");
        let energies = [ForceQuantity::KineticEnergy, ForceQuantity::PotentialEnergy];
        let growth: f64 = energies
            .iter()
            .map(|e| along.change(*e).expect("it exists"))
            .sum();
        let powers = (0..mechanism.drivers.len())
            .map(|driver| forces.value(ForceQuantity::Power(DriverId(driver))));
        let mut power: f64 = powers.sum();
        let mut largest = growth.abs().max(power.abs());
        // Rates along which the forces work, as changes of their sizes would show them: those of
        // the potential energy of a spring of constant force.
        for (index, force) in mechanism.forces.iter().enumerate() {
            let size = [0, 1, 2].map(|k| forces.value(ForceQuantity::Applied(index, k)));
            let work = match &force.load {
                Load::Coordinate { coordinate, .. } | Load::Passive { coordinate, .. } => {
                    let law = force.load.law();
                    let [value, rate] = coordinate_of(&solver, &rates, coordinate);
                    let spring = law.and_then(|law| law.spring.as_ref());
                    let constant = law.filter(|law| law.is_constant);
                    let constant = constant.and_then(|law| law.value.as_ref());
                    let constant =
                        constant.map_or(0.0, |value| value.value(&solver.pose().parameters));
                    let elastic = spring.map_or(0.0, |spring| {
                        let parameters = &solver.pose().parameters;
                        let [stiffness, extension] =
                            spring.evaluate(&|p| parameters[p.index()], value);
                        stiffness * extension
                    });
                    (size[0] + elastic - constant) * rate
                }
                Load::Marker { marker, axes, .. } => {
                    let [x, y] = solver.marker(*marker, &rates);
                    let turn = |marker: biela::mechanism::MarkerId, q: &[f64]| {
                        let body = mechanism.markers[marker.index()].body;
                        body.map_or(0.0, |body| q[3 * body.index() + 2])
                    };
                    let theta = axes.map_or(0.0, |axes| {
                        let own = &mechanism.markers[axes.index()].angle;
                        let parameters = &solver.pose().parameters;
                        turn(axes, &solver.pose().q) + own.evaluate(&|p| parameters[p.index()], 0.0)
                    });
                    let (sin, cos) = theta.sin_cos();
                    let fx = cos * size[0] - sin * size[1];
                    let fy = sin * size[0] + cos * size[1];
                    fx * x.first() + fy * y.first() + size[2] * turn(*marker, rates.velocity())
                }
            };
            power += work;
            largest = largest.max(work.abs());
        }
        // The condition loses digits of rates, and once more of efforts.
        let limit = 1e-14 / solver.rcond() * largest * (1.0 + mechanism.bodies.len() as f64);
        assert!(
            (growth - power).abs() <= limit,
            "{name}: {growth} and {power}"
        );
    }
}

/// Value and rate of a coordinate, from points and angles.
fn coordinate_of(
    solver: &biela::kinematics::Solver,
    rates: &biela::kinematics::Rates,
    coordinate: &biela::mechanism::Coordinate,
) -> [f64; 2] {
    use biela::mechanism::{Coordinate, CoordinateKind};
    let Coordinate {
        kind,
        from,
        to,
        axes,
    } = *coordinate;
    let mechanism = solver.mechanism();
    let angle = |marker: biela::mechanism::MarkerId| {
        let marker = &mechanism.markers[marker.index()];
        let parameters = &solver.pose().parameters;
        let own = marker.angle.evaluate(&|p| parameters[p.index()], 0.0);
        let body = marker.body.map(|body| 3 * body.index() + 2);
        let of = |list: &[f64]| body.map_or(0.0, |k| list[k]);
        [of(&solver.pose().q) + own, of(rates.velocity())]
    };
    if kind == CoordinateKind::Angle {
        let ([a, a_rate], [b, b_rate]) = (angle(from), angle(to));
        return [b - a, b_rate - a_rate];
    }
    let (i, j) = (solver.marker(from, rates), solver.marker(to, rates));
    let [x, y] = [0, 1].map(|k| j[k] - i[k]);
    let [theta, omega] = angle(axes);
    let (sin, cos) = theta.sin_cos();
    let along = [
        cos * x.value + sin * y.value,
        cos * x.first() + sin * y.first(),
    ];
    let across = [
        cos * y.value - sin * x.value,
        cos * y.first() - sin * x.first(),
    ];
    match kind {
        CoordinateKind::X => [along[0], along[1] + omega * across[0]],
        CoordinateKind::Y => [across[0], across[1] - omega * along[0]],
        _ => {
            let distance = x.value.hypot(y.value);
            let rate = (x.value * x.first() + y.value * y.first()) / distance;
            [distance, rate]
        }
    }
}

/// By virtual power the effort is (∂q/∂u)ᵀ w, by equilibrium the λ of the driver's row; the
/// derivative by an acceleration is the inertia, and the bias is free of it.
#[test]
fn the_derivative_of_an_effort_by_an_acceleration_is_the_inertia() {
    for name in stems("mechanisms", "toml") {
        let mut loaded = Loaded::new(loaded(&name));
        let mechanism = std::sync::Arc::clone(loaded.solver.mechanism());
        let rcond = loaded.solver.rcond();
        for (index, driver) in mechanism.drivers.iter().enumerate() {
            // The bias is told for inputs alone.
            if driver.motion().is_some() || driver.is_free() {
                continue;
            }
            let mut direction = Direction::zero(&mechanism);
            direction.drivers[index].derivatives[1] = 1.0;
            let Loaded {
                solver,
                rates,
                driver_rates,
                inputs: now,
                forces,
            } = &mut loaded;
            let motion = biela::kinematics::KnownMotion {
                rates,
                driver_rates,
                inputs: now,
            };
            let along = solver
                .force_sensitivity(motion, &direction, forces)
                .expect("it is regular");
            let driver = DriverId(index);
            let inertia = forces.value(ForceQuantity::Inertia(driver));
            let limit = 1e-13 / rcond * inertia;
            let by = along
                .change(ForceQuantity::Effort(driver))
                .expect("it exists");
            assert!(inertia > 0.0, "{name}");
            assert!((by - inertia).abs() <= limit, "{name}: {by} and {inertia}");
            let by = along
                .change(ForceQuantity::Bias(driver))
                .expect("it exists");
            assert!(by.abs() <= limit, "{name}: the bias changes by {by}");
        }
    }
}
