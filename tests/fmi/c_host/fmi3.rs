//! FMI 3.0 as a host in C sees it: `tests/host3.c`.

use std::f64::consts::PI;
use std::process::Command;

use set_up::runtime_library;

use crate::c_host::driver::Fmu;

/// The functions of the standard that go to an instance, and whether each is allowed (`x`): for
/// co-simulation in the states `instantiated`, `initializationMode`, `eventMode`, `stepMode`,
/// `intermediateUpdateMode` and `terminated` (FMI 3.0, 2.3 and 4.2), for model exchange in
/// `instantiated`, `initializationMode`, `eventMode`, `continuousTimeMode` and `terminated` (3.2).
const TABLE: &str = "
SetDebugLogging                  x x x x - x   x x x x x
EnterInitializationMode          x - - - - -   x - - - -
ExitInitializationMode           - x - - - -   - x - - -
EnterEventMode                   - - - x - -   - - - x -
Terminate                        - - x x - -   - - x x -
Reset                            x x x x - x   x x x x x
GetFloat32                       x x x x x x   x x x x x
GetFloat64                       x x x x x x   x x x x x
GetInt8                          x x x x - x   x x x x x
GetUInt8                         x x x x - x   x x x x x
GetInt16                         x x x x - x   x x x x x
GetUInt16                        x x x x - x   x x x x x
GetInt32                         x x x x - x   x x x x x
GetUInt32                        x x x x - x   x x x x x
GetInt64                         x x x x - x   x x x x x
GetUInt64                        x x x x - x   x x x x x
GetBoolean                       x x x x - x   x x x x x
GetString                        x x x x - x   x x x x x
GetBinary                        x x x x - x   x x x x x
GetClock                         - - x - - -   - - x - -
SetFloat32                       x x x x x -   x x x x -
SetFloat64                       x x x x x -   x x x x -
SetInt8                          x x x x - -   x x x - -
SetUInt8                         x x x x - -   x x x - -
SetInt16                         x x x x - -   x x x - -
SetUInt16                        x x x x - -   x x x - -
SetInt32                         x x x x - -   x x x - -
SetUInt32                        x x x x - -   x x x - -
SetInt64                         x x x x - -   x x x - -
SetUInt64                        x x x x - -   x x x - -
SetBoolean                       x x x x - -   x x x - -
SetString                        x x x x - -   x x x - -
SetBinary                        x x x x - -   x x x - -
SetClock                         - - x - - -   - - x - -
GetNumberOfVariableDependencies  x x x x - x   x x x x x
GetVariableDependencies          x x x x - x   x x x x x
GetFMUState                      x x x x - x   x x x x x
SetFMUState                      x x x x - x   x x x x x
FreeFMUState                     x x x x - x   x x x x x
SerializedFMUStateSize           x x x x - x   x x x x x
SerializeFMUState                x x x x - x   x x x x x
DeserializeFMUState              x x x x - x   x x x x x
GetDirectionalDerivative         - x x x - x   - x x x x
GetAdjointDerivative             - x x x - x   - x x x x
EnterConfigurationMode           - - - - - -   - - - - -
ExitConfigurationMode            - - - - - -   - - - - -
GetIntervalDecimal               - x x - - -   - x x - -
GetIntervalFraction              - x x - - -   - x x - -
GetShiftDecimal                  - x x - - -   - x x - -
GetShiftFraction                 - x x - - -   - x x - -
SetIntervalDecimal               - x x - - -   - x x - -
SetIntervalFraction              - x x - - -   - x x - -
SetShiftDecimal                  - x - - - -   - x - - -
SetShiftFraction                 - x - - - -   - x - - -
EvaluateDiscreteStates           - - x - - -   - - x - -
UpdateDiscreteStates             - - x - - -   - - x - -
EnterContinuousTimeMode          - - - - - -   - - x - -
CompletedIntegratorStep          - - - - - -   - - - x -
SetTime                          - - - - - -   - - - x -
SetContinuousStates              - - - - - -   - - - x -
GetContinuousStateDerivatives    - - - - - -   - x x x x
GetEventIndicators               - - - - - -   - x x x x
GetContinuousStates              - - - - - -   - x x x x
GetNominalsOfContinuousStates    - - - - - -   - x x x x
GetNumberOfEventIndicators       - - - - - -   x x x x x
GetNumberOfContinuousStates      - - - - - -   x x x x x
EnterStepMode                    - - x - - -   - - - - -
GetOutputDerivatives             - - - x x x   - - - - -
DoStep                           - - - x - -   - - - - -
ActivateModelPartition           - - - - - -   - - - - -
";

/// The columns, as the host names them.
const COLUMNS: [&str; 11] = [
    "CS instantiated",
    "CS initializationMode",
    "CS eventMode",
    "CS stepMode",
    "CS intermediateUpdateMode",
    "CS terminated",
    "ME instantiated",
    "ME initializationMode",
    "ME eventMode",
    "ME continuousTimeMode",
    "ME terminated",
];

/// Runs a scenario; returns its lines.
fn run(fmu: &Fmu, scenario: &[&str]) -> Vec<String> {
    let done = Command::new(env!("BIELA_C_HOST3"))
        .arg(runtime_library())
        .args([fmu.guid.as_str(), fmu.path()])
        .args(scenario)
        .output()
        .expect("the host starts");
    let text = |bytes| String::from_utf8(bytes).expect("the host writes UTF-8");
    let (out, err) = (text(done.stdout), text(done.stderr));
    assert!(done.status.success() && err.is_empty(), "{out}{err}");
    out.lines().map(str::to_owned).collect()
}

/// Returns the numbers in each line.
fn numbers(lines: &[String]) -> Vec<Vec<f64>> {
    let number = |field: &str| field.parse().expect("the host prints numbers");
    let lines = lines.iter();
    lines
        .map(|line| line.split(' ').map(number).collect())
        .collect()
}

#[test]
fn states_of_fmi_3_allow_their_calls_and_others_end_the_simulation() {
    let lines = run(&Fmu::of("pendulum"), &["states"]);
    let rows = TABLE.lines().filter(|line| !line.is_empty());
    let rows: Vec<Vec<&str>> = rows.map(|row| row.split_whitespace().collect()).collect();
    for (column, name) in COLUMNS.iter().enumerate() {
        let found = lines
            .iter()
            .find_map(|line| line.strip_prefix(&format!("{name}:")));
        let found: Vec<_> = found
            .expect("the host went there")
            .split_whitespace()
            .collect();
        let allowed = rows.iter().filter(|row| row[column + 1] == "x");
        let mut expected: Vec<_> = allowed.map(|row| row[0]).collect();
        let mut found = found;
        expected.sort_unstable();
        found.sort_unstable();
        assert_eq!(found, expected, "{name}");
    }
    assert_eq!(lines.len(), COLUMNS.len());
}

/// Values set in event mode can be read there, and hold over the step.
#[test]
fn outputs_follow_the_inputs_in_event_mode() {
    let fmu = Fmu::of("pendulum");
    let lines = run(&fmu, &["events", &fmu.vr("rod.phi")]);
    for (n, values) in numbers(&lines).iter().enumerate() {
        let expected = 0.4 + 0.05 * n as f64 - PI / 2.0;
        for value in values {
            assert!((value - expected).abs() < 1e-15, "{values:?}");
        }
    }
}

/// The host sets position and rates of 0.25 + sin 2t at each point: no lag.
#[test]
fn intermediate_update_has_no_lag() {
    let fmu = Fmu::of("pendulum");
    let outputs = ["rod.phi", "rod.omega", "rod.alpha"].map(|name| fmu.vr(name));
    let lines = run(
        &fmu,
        &["intermediate", &outputs[0], &outputs[1], &outputs[2]],
    );
    assert_eq!(lines.len(), 16);
    for values in numbers(&lines) {
        let [time, phi, omega, alpha] = values[..] else {
            panic!("four numbers: {values:?}")
        };
        let (sin, cos) = (2.0 * time).sin_cos();
        let errors = [
            phi - (0.25 + sin - PI / 2.0),
            omega - 2.0 * cos,
            alpha + 4.0 * sin,
        ];
        for error in errors {
            assert!(error.abs() < 1e-14, "{errors:?} at {time}");
        }
    }
}

/// The cylinder extends at 0.1 m/s and reaches 0.65 m, base and arm in a line, at 0.5 s.
#[test]
fn a_step_returns_early_at_the_dead_point() {
    let fmu = Fmu::of("tlv");
    for (events, expected) in [("0", vec![[0.0, 1.0]]), ("1", vec![[1.0, 0.0], [1.0, 1.0]])] {
        let lines = run(
            &fmu,
            &["early", events, &fmu.vr("extrapolation"), "0.6", "0.1"],
        );
        let found = numbers(&lines);
        assert_eq!(found.len(), expected.len(), "{lines:?}");
        for (found, expected) in found.iter().zip(expected) {
            // A rounding error of 1.1e-16 of lengths of up to 0.65 m shifts the dead point by as much
            // in the cylinder's length, not by its square root as in the pose: by 1.1e-15 s at
            // 0.1 m/s. Eight of them, for the sums and products of the closure.
            assert!((found[0] - 0.5).abs() < 9e-15, "{lines:?}");
            assert_eq!(found[1..], expected);
        }
    }
}
