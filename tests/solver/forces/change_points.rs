//! Forces and their derivatives at change points against closed forms along the motion.

use std::f64::consts::{FRAC_PI_2, PI, SQRT_2};
use std::sync::Arc;

use biela::kinematics::{Direction, Error, ForceParts, ForceQuantity, Path, Solution, Solver};
use biela::mechanism::{DriverId, Jet, Mechanism, ParameterId, Signal, Source};

/// Error of interpolated forces, in parts of the largest one: rounding of accelerations, some 1e-11,
/// over the distance of the places, 5e-3.
const LIMIT: f64 = 1e-8;
/// The same of their derivatives along the driver's value.
const LIMIT_OF_DERIVATIVES: f64 = 1e-5;
const G: f64 = 9.81;
const DRIVER: DriverId = DriverId(0);

/// Up-and-over garage door; P is the joint 1, the track the joint 2. The arm, half as long as the
/// door from its roller to P, hangs straight down where the roller is above it, at u = 0.
const GARAGE: &str = r#"
    format = 1
    name = "garage_door"
    ground.markers = { J = [0, 1.05], track = [0, 2.0] }
    bodies.door = { markers = { top = [0, 2.0], P = [0, 0.1] }, mass = 60, inertia = 20, center = [0, 1.0] }
    bodies.arm.markers = { J = [0, 1.05], P = [0, 0.1] }
    joints.J = { type = "revolute", markers = ["ground.J", "arm.J"] }
    joints.P = { type = "revolute", markers = ["arm.P", "door.P"] }
    joints.track = { type = "slot", markers = ["ground.track", "door.top"] }
    drivers.trolley = { coordinate = "x", markers = ["ground.track", "door.top"], MOTION }
"#;
/// Slopes of P's x and of the door's angle with u at u = 0, and a third of half the third derivative
/// of the angle: with the arm a, x = p of P fulfils u − p = √2 p (1 + p²/16a² + …), and the angle
/// sin φ = (p − u)/2a.
fn garage_slopes() -> [f64; 3] {
    let (a, k) = (0.95_f64, SQRT_2 - 1.0);
    let cubic = SQRT_2 * k.powi(4) / 32.0 - (k - 1.0).powi(3) / 48.0;
    [k, (k - 1.0) / (2.0 * a), -cubic / a.powi(3)]
}
/// Returns P.fy and track.fy at u = 0 by the moments about the roller, which is accelerated itself,
/// divided by u: `rate` is u̇, `spring` the limit of ü/u.
fn garage_forces(rate: f64, spring: f64) -> [f64; 2] {
    let [k, slope, cubic] = garage_slopes();
    let (mass, inertia, arm) = (60.0, 20.0 + 60.0, 1.9);
    let turn = 6.0 * cubic * rate * rate + slope * spring;
    let of_roller = mass * spring;
    let of_arm = ((1.0 - k) * mass * G / arm - inertia * turn - of_roller) / (1.0 + k);
    [of_arm, mass * (G + (slope * rate).powi(2)) - of_arm]
}

/// Parallelogram of the crank a = 0.1 and the coupler b = 0.4, whose mass is at its middle; B is the
/// joint 2.
const PARALLELOGRAM: &str = r#"
    format = 1
    name = "parallelogram"
    parameters = { g = { value = 9.81, unit = "m/s2" }, b = { value = 0.4, unit = "m" } }
    simulation.gravity = [0, "-g"]
    ground.markers = { O2 = [0, 0], O4 = [0.4, 0] }
    bodies.crank = { markers = { O2 = [0, 0], A = [0.1, 0] }, estimate = [0, 0, 1], mass = 2, inertia = 0.01, center = [0, 0.03] }
    bodies.coupler = { markers = { A = [0, 0], B = ["b", 0] }, estimate = [0.05, 0.08, 0], mass = 3, inertia = 0.05, center = [0.2, 0] }
    bodies.rocker = { markers = { O4 = [0, 0], B = [0.1, 0] }, estimate = [0.4, 0, 1] }
    joints.O2 = { type = "revolute", markers = ["ground.O2", "crank.O2"] }
    joints.A = { type = "revolute", markers = ["crank.A", "coupler.A"] }
    joints.B = { type = "revolute", markers = ["rocker.B", "coupler.B"] }
    joints.O4 = { type = "revolute", markers = ["ground.O4", "rocker.O4"] }
    drivers.turn = { coordinate = "angle", markers = ["ground.O2", "crank.O2"], MOTION }
"#;

/// Slider-crank with a rod as long as the crank, r = 0.2; the slider is a mass of 2 kg, A the
/// joint 1, the slide the joint 3.
const EQUAL: &str = r#"
    format = 1
    name = "equal_slider_crank"
    ground.markers = { O = [0, 0], slide = [0, 0] }
    bodies.crank = { markers = { O = [0, 0], A = [0.2, 0] }, estimate = [0, 0, 0.5] }
    bodies.rod = { markers = { A = [0, 0], B = [0.2, 0] }, estimate = [0.17, 0.1, -0.5] }
    bodies.slider = { markers = { B = [0, 0] }, estimate = [0.35, 0, 0], mass = 2, inertia = 0.1 }
    joints.O = { type = "revolute", markers = ["ground.O", "crank.O"] }
    joints.A = { type = "revolute", markers = ["crank.A", "rod.A"] }
    joints.B = { type = "revolute", markers = ["rod.B", "slider.B"] }
    joints.slide = { type = "translational", markers = ["ground.slide", "slider.B"] }
    drivers.turn = { coordinate = "angle", markers = ["ground.O", "crank.O"], MOTION }
"#;

/// A mechanism on its way, with its forces.
struct Run {
    solver: Solver,
    path: Path,
    solution: Solution,
}

impl Run {
    /// Assembles a mechanism whose driver has this motion or start.
    fn new(text: &str, motion: &str) -> Self {
        let text = text.replace("MOTION", motion);
        let source = Source::new("test.toml", text.as_str());
        let (mechanism, _) = Mechanism::parse(&source).expect("the file is right");
        let path = Path::new(&mechanism);
        let solver = Solver::assembled(Arc::new(mechanism), &path).expect("it closes");
        let mut solution = Solution::new(&solver);
        solution.seek_forces(&solver);
        Self {
            solver,
            path,
            solution,
        }
    }

    /// Follows the prescribed motion to a time.
    fn go_to(&mut self, time: f64) -> &mut Self {
        self.solver.pose().set_path(&mut self.path);
        self.path.duration = time - self.path.start;
        self.solver.track(&self.path).expect("it moves there");
        self.solution.follow_motions(&self.solver);
        self
    }

    /// Moves the input to a value, with these rates there.
    fn set_value(&mut self, value: f64, rates: [f64; 2]) -> &mut Self {
        self.solver.pose().set_path(&mut self.path);
        let now = self.solver.pose().drivers[0];
        self.path.driver_paths[0] = biela::kinematics::DriverPath::held(value, now);
        self.solver.track(&self.path).expect("it moves there");
        self.solution.driver_rates[0] = Jet::new(value, rates);
        self
    }

    fn solve(&mut self) -> Result<(), Error> {
        self.solution.solve(&mut self.solver)
    }

    fn reaction(&self, joint: usize) -> [f64; 2] {
        [0, 1].map(|c| self.solution.force(ForceQuantity::Reaction(joint, c)))
    }
}

#[track_caller]
fn assert_near(found: &[f64], expected: &[f64], tolerance: f64) {
    let largest = expected.iter().fold(1.0, |most: f64, v| most.max(v.abs()));
    for (found, expected) in found.iter().zip(expected) {
        let error = (found - expected).abs();
        assert!(
            error <= tolerance * largest,
            "{found}, not {expected}: {error:e}"
        );
    }
}

#[test]
fn a_garage_door_bears_the_limit_where_its_arm_hangs_straight_down() {
    let mut run = Run::new(GARAGE, r#"motion = "0.05 - 0.05*t""#);
    let expected = garage_forces(-0.05, 0.0);
    // Even functions of u: the forces change by some (u/a)² of the weight.
    for u in [1e-5, 1e-7, 1e-12, 1e-16, 0.0, -1e-9, -1e-6] {
        run.go_to(1.0 - u / 0.05).solve().expect("there is a limit");
        let found = [run.reaction(1)[1], run.reaction(2)[1]];
        assert_near(&found, &expected, LIMIT);
        // Along the track both forces of the arm and of the driver are odd.
        let effort = run.solution.force(ForceQuantity::Effort(DRIVER));
        assert!(
            effort.abs() < 60.0 * G * 2.0 * u.abs() + 1e-6,
            "{effort} at {u}"
        );
    }
}

/// At u = 0 the acceleration is zero, its third derivative is not: it takes part in the limit.
#[test]
fn the_limit_is_that_of_the_motion_in_time() {
    let mut run = Run::new(GARAGE, r#"motion = "0.05*cos(2*t)""#);
    run.go_to(PI / 4.0).solve().expect("there is a limit");
    let found = [run.reaction(1)[1], run.reaction(2)[1]];
    assert_near(&found, &garage_forces(-0.1, -4.0), LIMIT);
}

/// A third derivative that the host does not tell takes part in the limit; at rest there is none.
#[test]
fn a_limit_that_depends_on_what_inputs_do_not_tell_is_refused() {
    let mut run = Run::new(GARAGE, "start = 0.05");
    let refused = run
        .set_value(0.0, [-0.05, 0.0])
        .solve()
        .expect_err("it is not known");
    let Error::ChangePoint { driver, value, .. } = &refused else {
        panic!("{refused}");
    };
    assert_eq!((&**driver, &**value), ("trolley", "0.000000000 m"));
    run.set_value(0.0, [0.0, 0.0])
        .solve()
        .expect("it is at rest");
    let found = [run.reaction(1)[1], run.reaction(2)[1]];
    assert_near(&found, &garage_forces(0.0, 0.0), LIMIT);
    // Next to the point the forces are those of these rates.
    run.set_value(1e-5, [-0.05, 0.0])
        .solve()
        .expect("it is regular");
    let found = [run.reaction(1)[1], run.reaction(2)[1]];
    assert_near(&found, &garage_forces(-0.05, 0.0), LIMIT);
}

/// The massless rocker pulls along its length: with a coupler that only translates its force is
/// m (g + ÿ) / (2 sin φ), ÿ = a (φ̈ cos φ − φ̇² sin φ). The torque is that of the weights.
#[test]
fn a_parallelogram_has_efforts_when_flat_and_refuses_reactions_that_grow_without_bound() {
    let mut run = Run::new(PARALLELOGRAM, r#"motion = "1 + 2*t""#);
    let (a, rate) = (0.1, 2.0);
    for off in [-2e-3, -1e-6, 1e-4, 3e-3, 1e-2] {
        run.go_to((PI + off - 1.0) / rate)
            .solve()
            .expect("it is regular");
        let phi = run.solver.pose().drivers[0];
        let force = 3.0 * (G - a * rate * rate * phi.sin()) / (2.0 * phi.sin());
        // A rounding of φ changes the force by eps/δ of it.
        let tolerance = LIMIT + 8.0 * f64::EPSILON / off.abs();
        assert_near(
            &run.reaction(2),
            &[force * phi.cos(), force * phi.sin()],
            tolerance,
        );
    }
    let mut run = Run::new(PARALLELOGRAM, r#"motion = "1 + 2*t""#);
    let refused = run
        .go_to((PI - 1.0) / rate)
        .solve()
        .expect_err("they are infinite");
    assert!(matches!(refused, Error::ChangePoint { .. }), "{refused}");
    let efforts = ForceParts {
        efforts: true,
        reactions: false,
    };
    let Run {
        solver, solution, ..
    } = &mut run;
    solution
        .solve_forces(solver, efforts)
        .expect("efforts have limits");
    let effort = solution.force(ForceQuantity::Effort(DRIVER));
    assert_near(&[effort], &[-3.0 * G * a], 1e-12);
}

/// Without gravity the force of the rocker is centripetal, −m a φ̇²/2.
#[test]
fn a_parallelogram_without_weight_has_reactions_when_flat() {
    let text = PARALLELOGRAM.replace("value = 9.81", "value = 0");
    let mut run = Run::new(&text, r#"motion = "1 + 2*t""#);
    for off in [-1e-3, -1e-8, 0.0, 1e-12, 1e-5, 4e-3] {
        run.go_to((PI + off - 1.0) / 2.0)
            .solve()
            .expect("they are bounded");
        let phi = run.solver.pose().drivers[0];
        let force = -0.5 * 3.0 * 0.1 * 4.0;
        assert_near(
            &run.reaction(2),
            &[force * phi.cos(), force * phi.sin()],
            LIMIT,
        );
    }
}

/// The slider goes on where its pin meets that of the crank: x = 2 r cos θ. The rod pushes with
/// M ẍ / cos θ = −2 r M θ̇², the slide bears the weight and the rod.
#[test]
fn a_slider_crank_with_equal_links_has_reactions_where_its_pins_meet() {
    let mut run = Run::new(EQUAL, r#"motion = "0.5 + 3*t""#);
    let (r, mass, rate) = (0.2, 2.0, 3.0);
    for off in [-3e-3, -1e-7, -1e-13, 0.0, 1e-10, 2e-4] {
        run.go_to((FRAC_PI_2 + off - 0.5) / rate)
            .solve()
            .expect("they are bounded");
        let theta = run.solver.pose().drivers[0];
        let (sin, cos) = theta.sin_cos();
        let rod = -2.0 * r * mass * rate * rate;
        // Along the rod from A to B, (cos θ, −sin θ); on the slider from the slide.
        let slide = mass * G + rod * sin;
        assert_near(&run.reaction(2), &[rod * cos, -rod * sin], LIMIT);
        assert_near(&run.reaction(3), &[0.0, slide], LIMIT);
        let effort = run.solution.force(ForceQuantity::Effort(DRIVER));
        assert_near(&[effort], &[-2.0 * r * rod * sin * cos], 1e-10);
    }
}

/// The torque m₁ g (c cos φ − d sin φ) + m₃ g a cos φ + I φ̈ has derivatives by the angle and by g.
/// The reactions have none, and by the coupler's length the flat pose itself has none.
#[test]
fn derivatives_at_a_change_point_are_limits_or_refused() {
    let mut run = Run::new(PARALLELOGRAM, r#"motion = "1 + 2*t + 0*t^3""#);
    let a = 0.1;
    for off in [-4e-3, -1e-8, 0.0, 1e-13, 1e-4] {
        run.go_to((PI + off - 1.0) / 2.0);
        let rates = run.solution.solve_rates(&mut run.solver);
        rates.expect("there are rates");
        let phi = run.solver.pose().drivers[0];
        let mechanism = run.solver.mechanism().clone();
        let mut direction = Direction::zero(&mechanism);
        direction.time = 1.0;
        let changes = run.solution.force_changes(&mut run.solver, &direction);
        let changes = changes.expect("efforts change").expect("forces are sought");
        let of_effort = changes
            .change(ForceQuantity::Effort(DRIVER))
            .expect("it has a limit");
        let torque = -2.0 * G * 0.03 * phi.cos() - 3.0 * G * a * phi.sin();
        assert_near(&[of_effort], &[2.0 * torque], LIMIT_OF_DERIVATIVES);
        let of_pin = changes.change(ForceQuantity::Reaction(2, 0));
        if off.abs() < 1e-7 {
            assert!(
                matches!(of_pin, Err(Error::ChangePoint { .. })),
                "{of_pin:?}"
            );
        }
        let by_gravity = Direction::by_parameter(&mechanism, ParameterId(0));
        let changes = run.solution.force_changes(&mut run.solver, &by_gravity);
        let changes = changes.expect("efforts change").expect("forces are sought");
        let of_effort = changes
            .change(ForceQuantity::Effort(DRIVER))
            .expect("it has a limit");
        let lever = -2.0 * 0.03 * phi.sin() + 3.0 * a * phi.cos();
        assert_near(&[of_effort], &[lever], LIMIT_OF_DERIVATIVES);

        let rocker = Signal::Body(mechanism.body_id("rocker").expect("it has one"), 2);
        let Solution {
            rates,
            driver_rates,
            ..
        } = &run.solution;
        let along = run.solver.sensitivity(rates, driver_rates, &direction);
        let along = along.expect("there are derivatives").signal(rocker);
        assert_near(
            &[along.value, along.first(), along.second()],
            &[2.0, 0.0, 0.0],
            LIMIT_OF_DERIVATIVES,
        );
        let by_length = Direction::by_parameter(&mechanism, ParameterId(1));
        let along = run.solver.sensitivity(rates, driver_rates, &by_length);
        let along = along.expect("other derivatives may exist");
        let change = along.signal(rocker).value;
        if off.abs() < 1e-7 {
            assert!(change.is_nan() && matches!(along.fault(), Error::ChangePoint { .. }));
        } else {
            // Along the coupler the rocker's pin moves by −a sin φ per radian.
            let exact = -1.0 / (a * phi.sin());
            assert!(
                (change.abs() - exact.abs()).abs() < 1e-6 * exact.abs(),
                "{change}, {exact}"
            );
        }
    }
}
