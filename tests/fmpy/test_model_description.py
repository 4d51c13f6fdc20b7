"""The FMU as a file: its XML, its contents, and that exporting again gives the same bytes."""

import ctypes
import math
import re
import shutil
import subprocess
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest
from closed_form import CLOSED_FORMS
from fmpy.validation import validate_fmu
from harness import SHIPPED, export, mechanism_file, state_names
from lxml import etree

EVERY_FMU = [*SHIPPED, "turning_yoke", "two_link_arm", "triple_rocker"]

EXCHANGED = ["five_bar_free", "four_bar_chain", "triple_rocker"]
"""Mechanisms whose states in model exchange are coordinates that are exchanged."""

BODY_UNITS = {
    "x": "m", "y": "m", "phi": "rad",
    "vx": "m/s", "vy": "m/s", "omega": "rad/s",
    "ax": "m/s2", "ay": "m/s2", "alpha": "rad/s2",
}  # fmt: skip
WEIGHT_UNITS = {"mass": "kg", "center_x": "m", "center_y": "m", "inertia": "kg.m2"}
POINT_UNITS = {name: unit for name, unit in BODY_UNITS.items() if unit.startswith("m")}
COORDINATE_UNITS = {
    "m": {"position": "m", "velocity": "m/s", "acceleration": "m/s2"},
    "rad": {"position": "rad", "velocity": "rad/s", "acceleration": "rad/s2"},
}


def coordinate_units(table):
    return COORDINATE_UNITS["rad" if table["coordinate"] == "angle" else "m"]


def expected_variables(file):
    """Name, type, causality, variability and unit of every variable, from the mechanism file."""
    drivers = file.get("drivers", {})
    inputs = {name: table for name, table in drivers.items() if "motion" not in table}
    parameters = file.get("parameters", {})
    outputs = file.get("outputs", {})

    for name, table in inputs.items():
        for suffix, unit in coordinate_units(table).items():
            yield f"{name}.{suffix}", "Real", "input", "continuous", unit
    for name, table in file.get("forces", {}).items():
        if not force_has_size(table):
            for suffix, unit in force_units(table).items():
                yield f"{name}.{suffix}", "Real", "input", "continuous", unit

    for name, table in parameters.items():
        table = table if isinstance(table, dict) else {"value": table}
        causality = "parameter" if not uses(table["value"], parameters) else "calculatedParameter"
        variability = "tunable" if table.get("tunable") else "fixed"
        unit = None if table.get("unit") == "1" else table.get("unit")
        yield name, "Real", causality, variability, unit
    if inputs:
        yield "rates", "Enumeration", "parameter", "fixed", None
        yield "extrapolation", "Enumeration", "parameter", "fixed", None

    for body in outputs.get("bodies", file["bodies"]):
        for suffix, unit in BODY_UNITS.items():
            yield f"{body}.{suffix}", "Real", "output", "continuous", unit
    for marker in outputs.get("markers", []):
        for suffix, unit in POINT_UNITS.items():
            yield f"{marker}.{suffix}", "Real", "output", "continuous", unit
    measures = file.get("measures", {})
    computed = {name: table for name, table in measures.items() if "value" in table}
    measured = {name: table for name, table in measures.items() if name not in computed}
    measured |= {name: table for name, table in drivers.items() if "motion" in table}
    measured |= file.get("freedoms", {})
    for name, table in measured.items():
        for suffix, unit in coordinate_units(table).items():
            yield f"{name}.{suffix}", "Real", "output", "continuous", unit
    for name, table in computed.items():
        unit = None if table.get("unit") == "1" else table.get("unit")
        yield name, "Real", "output", "continuous", unit

    for name, unit in expected_forces(file):
        yield name, "Real", "output", "continuous", unit

    yield "solver.residual", "Real", "local", "continuous", None
    yield "solver.rcond", "Real", "local", "continuous", None
    yield "solver.iterations", "Integer", "local", "discrete", None
    yield "solver.substeps", "Integer", "local", "discrete", None
    yield "solver.proved", "Integer", "local", "discrete", None
    yield "time", "Real", "independent", "continuous", "s"
    for place in range(1, expected_indicators(file) + 1):
        yield f"event_indicator[{place}]", "Real", "local", "continuous", None
    if file["name"] in EXCHANGED:
        for place in range(1, 2 * len(file["freedoms"]), 2):
            for name in (f"state[{place}]", f"state[{place + 1}]", f"der(state[{place + 1}])"):
                yield name, "Real", "local", "continuous", None
    yield "solver.budget", "Real", "parameter", "tunable", None
    for name, table in file.get("inputs", {}).items():
        yield name, "Real", "input", "continuous", table.get("unit")
    for name in file.get("contacts", {}):
        yield f"{name}.clearance", "Real", "output", "continuous", "m"
        if file.get("freedoms"):
            yield f"{name}.touching", "Integer", "local", "discrete", None
    for name, body in file["bodies"].items():
        # No size of a shape with a density is tunable in the mechanisms that the tests have.
        if any("density" in body | shape for shape in body.get("shapes", {}).values()):
            for suffix, unit in WEIGHT_UNITS.items():
                yield f"{name}.{suffix}", "Real", "calculatedParameter", "fixed", unit


def expected_indicators(file):
    """The number of events that a host looks for: limits of freedoms, and two for each argument of a
    function with corners."""
    stops = file.get("stops", {}).values() if file.get("freedoms") else []
    limits = sum(side in stop for stop in stops for side in ("min", "max"))
    functions = file.get("functions", {})
    bent = [name for name, table in functions.items() if "table" in table and table.get("law") == "linear"]
    sizes = [str(table.get("value")) for table in file.get("forces", {}).values()]
    contacts = file.get("contacts", {}) if file.get("freedoms") else {}
    return limits + 2 * len(contacts) + 2 * sum(size.count(f"{name}(") for size in sizes for name in bent)


def expected_forces(file):
    """Names and units of the outputs of a mechanism with masses or forces whose reactions are
    all determinate."""
    forces = file.get("forces", {})
    if not forces and not any("mass" in body for body in file["bodies"].values()):
        return
    for name, table in file.get("drivers", {}).items():
        (effort,) = force_units(table).values()
        yield f"{name}.effort", effort
        yield f"{name}.power", "W"
        if "motion" not in table:
            yield f"{name}.inertia", "kg.m2" if table["coordinate"] == "angle" else "kg"
            yield f"{name}.bias", effort
    reactions = file.get("outputs", {}).get("reactions")
    for name, table in file.get("joints", {}).items():
        if reactions is not None and name not in reactions:
            continue
        if table["type"] == "coupling":
            yield from expected_of_coupling(name, table, file)
        else:
            for suffix in REACTIONS[table.get("follower", table["type"])].split():
                yield f"{name}.{suffix}", "N.m" if suffix == "torque" else "N"
    for name, table in file.get("constraints", {}).items():
        if reactions is None or name in reactions:
            (effort,) = force_units(table).values()
            yield f"{name}.effort", effort
    for name, table in forces.items():
        if force_has_size(table):
            for suffix, unit in force_units(table).items():
                yield f"{name}.{suffix}", unit
    for name, table in file.get("stops", {}).items() if file.get("freedoms") else ():
        (effort,) = force_units(table).values()
        yield f"{name}.effort", effort
    for name in file.get("contacts", {}) if file.get("freedoms") else ():
        yield f"{name}.effort", "N"
    for name, table in file.get("friction", {}).items():
        # Friction in a pin is a torque.
        of_pin = "joint" in table and file["joints"][table["joint"]]["type"] == "revolute"
        yield f"{name}.effort", "N.m" if of_pin else "N"
    yield "energy.kinetic", "J"
    yield "energy.potential", "J"


def expected_of_coupling(name, table, file):
    """Names and units of its effort and of those along the coordinates in its equation."""
    sections = ("drivers", "freedoms", "measures")
    known = {name: entry for section in sections for name, entry in file.get(section, {}).items()}
    named = dict.fromkeys(re.findall(r"[A-Za-z]\w*", table["equation"]))
    units = [(other, *force_units(known[other]).values()) for other in named if other in known]
    # One length makes both sides lengths.
    yield f"{name}.effort", "N" if "N" in dict(units).values() else "N.m"
    for other, unit in units:
        yield f"{name}.{other}.effort", unit


REACTIONS = {
    **dict.fromkeys(
        ["revolute", "slot", "link", "revolute_translational", "knife", "roller", "curve"], "fx fy"
    ),
    **dict.fromkeys(
        ["translational", "weld", "flat", "rack_and_pinion", "rolling"], "fx fy torque"
    ),
    "gear": "torque",
    "belt": "torque",
    "rope": "tension",
}
"""Components of the reaction of each type of joint, of a cam of each follower."""


def force_has_size(table):
    return not {"value", "torque", "stiffness", "damping"}.isdisjoint(table)


def force_units(table):
    if "marker" in table:
        return {"fx": "N", "fy": "N", "torque": "N.m"}
    return {"effort": "N.m" if table["coordinate"] == "angle" else "N"}


def uses(value, names):
    return isinstance(value, str) and not set(re.findall(r"[A-Za-z]\w*", value)).isdisjoint(names)


def unit_of(variable):
    """A variable's unit, whether it stands at the variable or at its type."""
    unit = variable.unit
    if unit is None and variable.declaredType is not None:
        unit = variable.declaredType.unit
    return unit


def display_unit_of(variable):
    display = variable.displayUnit
    if display is None and variable.declaredType is not None:
        display = variable.declaredType.displayUnit
    return display


# ---------------------------------------------------------------------------------------------
# Validity


@pytest.mark.parametrize("name", EVERY_FMU)
def test_fmpy_finds_no_problem(fmu, name):
    assert validate_fmu(str(fmu(name).path)) == []


@pytest.mark.parametrize("name", EVERY_FMU)
def test_valid_against_the_schema(fmu, name):
    folder = Path(fmpy.__file__).parent / "schema" / "fmi2"
    schema = etree.XMLSchema(etree.parse(folder / "fmi2ModelDescription.xsd"))
    document = etree.parse(fmu(name).folder / "modelDescription.xml")
    assert schema.validate(document), schema.error_log


# ---------------------------------------------------------------------------------------------
# Variables


@pytest.mark.parametrize("name", EVERY_FMU)
def test_variables(fmu, mechanism_data, name):
    found = []
    for v in fmu(name).description.modelVariables:
        # A quantity without dimension may say so (unit 1) or say nothing; the solver's own
        # numbers are scaled.
        unit = None if unit_of(v) == "1" or v.name.startswith("solver.") else unit_of(v)
        found.append((v.name, v.type, v.causality, v.variability, unit))
    assert found == list(expected_variables(mechanism_data(name)))


@pytest.mark.parametrize("name", EVERY_FMU)
def test_value_references_are_indices(fmu, fmu3, name):
    """Hosts that take one for the other find the same variable."""
    for exported in (fmu(name), fmu3(name)):
        references = [v.valueReference for v in exported.description.modelVariables]
        assert references == list(range(1, len(references) + 1))


@pytest.mark.parametrize("name", SHIPPED)
def test_no_variable_of_fmi_2_looks_like_a_state(fmu, fmu3, name):
    """Some hosts count the variables that are derivatives of others as states."""
    states = set(state_names(fmu(name).description))
    derivatives = [v.derivative for v in fmu(name).description.modelVariables]
    assert {v.name for v in derivatives if v is not None} == states
    rates = [v.name for v in fmu3(name).description.modelVariables if v.derivative is not None]
    assert any(rate.endswith(".omega") for rate in rates)


@pytest.mark.parametrize("name", EVERY_FMU)
def test_initial_and_start(fmu, mechanism_data, name):
    states = state_names(fmu(name).description)
    assert len(states) == fmu(name).description.numberOfContinuousStates
    freedoms = mechanism_data(name).get("freedoms", {})
    started = [f"{freedom}.{rate}" for freedom in freedoms for rate in ("position", "velocity")]
    if name in EXCHANGED:
        assert states == [f"state[{place + 1}]" for place in range(len(started))]
    else:
        assert states == started
    for v in fmu(name).description.modelVariables:
        if v.causality in ("input", "parameter") or v.name in started:
            assert v.start is not None, v.name
            assert v.initial == "exact", v.name
        else:
            assert v.start is None, v.name
            if v.causality != "independent":
                assert v.initial == "calculated", v.name


@pytest.mark.parametrize("name", sorted(CLOSED_FORMS))
def test_start_values(fmu, name):
    """The file's numbers arrive in full: equal when read back, not merely close."""
    form = CLOSED_FORMS[name]
    variables = fmu(name).variables
    for parameter in form.parameter_names():
        assert float(variables[parameter].start) == getattr(form(), parameter)
    # 60*deg may be rounded once more or less than numpy's radians().
    position = float(variables[f"{form.driver}.position"].start)
    assert position == pytest.approx(form.start, rel=2 * np.finfo(float).eps)
    assert float(variables[f"{form.driver}.velocity"].start) == 0
    assert float(variables[f"{form.driver}.acceleration"].start) == 0


@pytest.mark.parametrize("name", SHIPPED)
def test_choices(fmu, name):
    variables = fmu(name).variables
    if not any(name.endswith(".position") for name in fmu(name).names("input")):
        assert not {"rates", "extrapolation"} & set(variables)
        return
    for parameter, choices in (
        ("rates", ["auto", "inputs", "estimated"]),
        ("extrapolation", ["hold", "taylor"]),
    ):
        items = variables[parameter].declaredType.items
        assert [(item.name, int(item.value)) for item in items] == [
            (choice, number) for number, choice in enumerate(choices, start=1)
        ]
        assert all(item.description for item in items)
        assert int(variables[parameter].start) == 1


def test_limits_and_descriptions(fmu):
    variables = fmu("four_bar").variables
    assert float(variables["crank_length"].min) == 0.001
    assert variables["crank_length"].max is None
    assert variables["crank_length"].description == "between the crank's pins"
    described = variables["transmission.position"].description
    assert "transmission angle, from the coupler to the rocker" in described
    radius = fmu("turning_yoke").variables["radius"]
    assert (float(radius.min), float(radius.max)) == (0.001, 1.0)
    assert float(radius.start) == pytest.approx(0.03, rel=1e-15)


@pytest.mark.parametrize("name", EVERY_FMU)
def test_every_variable_is_described(fmu, name):
    """Except time, and parameters, whose description is the author's to give."""
    for v in fmu(name).description.modelVariables:
        if v.causality in ("input", "output", "local"):
            assert v.description, v.name


def test_units_and_display_units(fmu):
    description = fmu("four_bar").description
    units = {unit.name: unit for unit in description.unitDefinitions}
    exponents = {
        "m": {"m": 1}, "rad": {"rad": 1}, "s": {"s": 1},
        "m/s": {"m": 1, "s": -1}, "rad/s": {"rad": 1, "s": -1},
        "m/s2": {"m": 1, "s": -2}, "rad/s2": {"rad": 1, "s": -2},
    }  # fmt: skip
    for name, expected in exponents.items():
        base = units[name].baseUnit
        found = {k: getattr(base, k) for k in ("kg", "m", "s", "A", "K", "mol", "cd", "rad")}
        assert {k: v for k, v in found.items() if v} == expected, name
        assert (base.factor, base.offset) == (1.0, 0.0)
    # A display value is the factor times the value in the unit itself.
    displayed = {d.name: d.factor for d in units["rad"].displayUnits}
    assert displayed["deg"] == pytest.approx(180 / math.pi, rel=1e-15)
    assert {d.name: d.factor for d in units["m"].displayUnits}["mm"] == pytest.approx(1000)

    variables = fmu("four_bar").variables
    assert display_unit_of(variables["crank_length"]) == "mm"
    for angle in ("crank_angle.position", "rocker.phi", "transmission.position"):
        assert display_unit_of(variables[angle]) == "deg"
    assert display_unit_of(fmu("turning_yoke").variables["speed"]) == "rpm"


def test_forces_and_energies_have_quantities_and_magnitudes(fmu):
    """The weight of both masses of the motor's slider-crank, to one digit, and that times its size."""
    description = fmu("slider_crank_motor")
    root = etree.parse(description.folder / "modelDescription.xml")
    element = lambda name: root.find(f".//ScalarVariable[@name='{name}']/Real")
    quantity = lambda name: root.find(
        f".//SimpleType[@name='{element(name).get('declaredType')}']/Real"
    ).get("quantity")
    assert quantity("motor.effort") == "Torque" and quantity("pump.effort") == "Force"
    assert quantity("energy.kinetic") == "Energy"
    size = float(element("crank.x").get("nominal"))
    force, torque, energy = (float(element(f"{name}").get("nominal")) for name in
                             ("pump.effort", "motor.effort", "energy.kinetic"))
    assert torque == energy and torque == pytest.approx(force * size, rel=0.6)


@pytest.mark.parametrize("name", ["servo_arm"])
def test_event_indicators_are_described_by_what_they_watch(fmu, name):
    variables = fmu(name).description.modelVariables
    watched = [v.description for v in variables if v.name.startswith("event_indicator")]
    assert len(set(watched)) == len(watched) > 0
    assert all(re.match(r"`\w+`: (gap|speed|force|argument) ", text) for text in watched)


# ---------------------------------------------------------------------------------------------
# Model structure


def expected_input_dependencies(name, initial=False):
    """Which inputs each output depends on, from how the closed form reacts.

    What moves with the driver depends on all three inputs: estimated rates on positions,
    extrapolated positions on rates. At the start nothing is extrapolated: a position depends on
    `.position`, its velocity on `.velocity` as well, its acceleration on all three. What does not
    move depends on no input, and neither do its rates.
    """
    form = CLOSED_FORMS[name]
    here, there = form().motion(form.start), form().motion(form.start + 0.01)
    order_of = {"x": 0, "y": 0, "phi": 0, "position": 0}
    order_of |= {"vx": 1, "vy": 1, "omega": 1, "velocity": 1}
    position_of = {
        "vx": "x", "ax": "x", "vy": "y", "ay": "y", "omega": "phi", "alpha": "phi",
        "velocity": "position", "acceleration": "position",
    }  # fmt: skip
    inputs = [f"{form.driver}.{suffix}" for suffix in ("position", "velocity", "acceleration")]
    expected = {}
    for output in here:
        owner, _, suffix = output.rpartition(".")
        position = f"{owner}.{position_of.get(suffix, suffix)}"
        moves = here[position].item() != there[position].item()
        count = order_of.get(suffix, 2) + 1 if initial else 3
        expected[output] = set(inputs[:count]) if moves else set()
    return expected


def dependencies(unknowns):
    """Dependencies by name; none listed at all would mean a dependence on everything."""
    assert all(unknown.dependencies is not None for unknown in unknowns)
    return {u.variable.name: {v.name for v in u.dependencies} for u in unknowns}


@pytest.mark.parametrize("name", sorted(CLOSED_FORMS))
def test_outputs_depend_exactly_on_what_moves_them(fmu, name):
    assert dependencies(fmu(name).description.outputs) == expected_input_dependencies(name)


def test_what_is_pinned_depends_on_nothing(fmu):
    """The same, said outright for the four-bar."""
    found = dependencies(fmu("four_bar").description.outputs)
    position, velocity, acceleration = (
        f"crank_angle.{suffix}" for suffix in ("position", "velocity", "acceleration")
    )
    # The crank's pin is its literal origin on ground's; the rocker's stands at a fixed point.
    for pinned in ("crank", "rocker"):
        for suffix in ("x", "y", "vx", "vy", "ax", "ay"):
            assert found[f"{pinned}.{suffix}"] == set()
    for moved in ("coupler.x", "rocker.phi", "coupler.P.vy", "transmission.acceleration"):
        assert found[moved] == {position, velocity, acceleration}
    initial = dependencies(fmu("four_bar").description.initialUnknowns)
    assert initial["crank.phi"] == {position}


@pytest.mark.parametrize("name", sorted(CLOSED_FORMS))
def test_initial_unknowns(fmu, name):
    """At the start parameters count too: every one that changes an output is listed for it.

    More may be listed (the equations of a loop know all its lengths although some cancel), but
    none for an output that nothing changes.
    """
    form = CLOSED_FORMS[name]
    found = dependencies(fmu(name).description.initialUnknowns)
    inputs = expected_input_dependencies(name, initial=True)
    assert set(found) == set(inputs)

    at = (form.start, 0.7, 0.9)
    base = form().motion(*at)
    for output, expected in inputs.items():
        reacts = set()
        for parameter in form.parameter_names():
            changed = form(**{parameter: getattr(form(), parameter) * 1.001}).motion(*at)
            # Far above the rounding of the closed form, far below a real influence of 1e-3.
            if abs(changed[output].item() - base[output].item()) > 1e-9:
                reacts.add(parameter)
        listed = found[output] - {"rates", "extrapolation", "time"}
        driver_part = {v for v in listed if v.startswith(f"{form.driver}.")}
        assert driver_part == expected, output
        assert reacts <= listed - driver_part, output
        if not expected and not reacts:
            assert not listed, output


def test_the_fixed_pivot_depends_on_its_parameter(fmu):
    found = dependencies(fmu("four_bar").description.initialUnknowns)
    assert found["rocker.x"] == {"base"}
    assert found["rocker.y"] == found["crank.x"] == set()


def test_two_drivers_are_told_apart(fmu):
    """The elbow turns with the shoulder but stands at a place that only the shoulder moves."""
    found = dependencies(fmu("two_link_arm").description.outputs)
    shoulder, elbow = (
        {f"{driver}.{suffix}" for suffix in COORDINATE_UNITS["rad"]}
        for driver in ("shoulder", "elbow")
    )
    assert found["upper.phi"] == found["upper.omega"] == found["fore.x"] == shoulder
    assert found["fore.phi"] == found["tool.T.x"] == found["tool.alpha"] == shoulder | elbow


def test_derived_parameters_are_initial_unknowns(fmu):
    found = dependencies(fmu("turning_yoke").description.initialUnknowns)
    assert found["diameter"] == {"radius"}
    assert not any("." in name for names in found.values() for name in names), "no input exists"


# ---------------------------------------------------------------------------------------------
# Attributes


@pytest.mark.parametrize("name", EVERY_FMU)
def test_capabilities(fmu, mechanism_data, name):
    root = etree.parse(fmu(name).folder / "modelDescription.xml").getroot()
    assert root.get("fmiVersion") == "2.0"
    assert root.get("variableNamingConvention") == "structured"
    assert int(root.get("numberOfEventIndicators", 0)) == expected_indicators(mechanism_data(name))

    served = dict(root.find("ModelExchange").attrib)
    assert served.pop("modelIdentifier") == root.get("modelName") == name
    assert {flag for flag, value in served.items() if value != "false"} == {
        "canNotUseMemoryManagementFunctions",
        "canGetAndSetFMUstate",
        "canSerializeFMUstate",
        "providesDirectionalDerivative",
    }
    assert served["completedIntegratorStepNotNeeded"] == "false"
    derivatives = root.find("ModelStructure").iterfind("Derivatives/Unknown")
    assert len(list(derivatives)) == 2 * len(mechanism_data(name).get("freedoms", {}))

    served = dict(root.find("CoSimulation").attrib)
    assert served.pop("modelIdentifier") == root.get("modelName") == name
    assert served.pop("maxOutputDerivativeOrder") == "2"
    assert {flag for flag, value in served.items() if value != "false"} == {
        "canHandleVariableCommunicationStepSize",
        "canInterpolateInputs",
        "canNotUseMemoryManagementFunctions",
        "canGetAndSetFMUstate",
        "canSerializeFMUstate",
        "providesDirectionalDerivative",
    }


def test_default_experiment(fmu):
    experiment = fmu("turning_yoke").description.defaultExperiment
    assert float(experiment.startTime) == 1.0
    assert float(experiment.stopTime) == 3.0
    assert float(experiment.stepSize) == 0.02
    assert float(experiment.tolerance) == 1e-5
    experiment = fmu("two_link_arm").description.defaultExperiment
    assert (float(experiment.startTime), float(experiment.stopTime)) == (0.0, 1.0)
    assert float(experiment.stepSize) == 1 / 500


def test_the_files_own_attributes(fmu):
    description = fmu("turning_yoke").description
    assert description.author == "Ada & Grace"
    assert description.version == "1.2"
    assert description.description == "Scotch yoke that turns by itself"
    assert description.license is None
    assert description.generationTool.startswith("biela")
    # A text beyond ASCII survives the XML.
    assert "Crank–rocker" in fmu("four_bar").description.description
    assert "cuadrilátero" in fmu("four_bar").description.description


# ---------------------------------------------------------------------------------------------
# The archive


@pytest.mark.parametrize("name", SHIPPED)
def test_archive(fmu, name):
    with zipfile.ZipFile(fmu(name).path) as archive:
        names = archive.namelist()
        assert archive.testzip() is None
    assert len(set(names)) == len(names)
    files = [name for name in names if not name.endswith("/")]
    assert "modelDescription.xml" in files
    assert any(file.startswith("resources/") for file in files)
    library = fmu(name).library.relative_to(fmu(name).folder).as_posix()
    assert library in files
    folders = {Path(file).parts[0] for file in files if "/" in file}
    assert folders == {"binaries", "resources", "documentation"}
    assert "documentation/index.html" in files
    picture = (fmu(name).folder / "model.png").read_bytes()
    assert picture.startswith(b"\x89PNG")


FMI2_FUNCTIONS = {
    f"fmi2{name}"
    for name in """
    GetTypesPlatform GetVersion SetDebugLogging Instantiate FreeInstance SetupExperiment
    EnterInitializationMode ExitInitializationMode Terminate Reset
    GetReal GetInteger GetBoolean GetString SetReal SetInteger SetBoolean SetString
    GetFMUstate SetFMUstate FreeFMUstate SerializedFMUstateSize SerializeFMUstate
    DeSerializeFMUstate GetDirectionalDerivative
    EnterEventMode NewDiscreteStates EnterContinuousTimeMode CompletedIntegratorStep SetTime
    SetContinuousStates GetDerivatives GetEventIndicators GetContinuousStates
    GetNominalsOfContinuousStates
    SetRealInputDerivatives GetRealOutputDerivatives DoStep CancelStep
    GetStatus GetRealStatus GetIntegerStatus GetBooleanStatus GetStringStatus
    """.split()
}


def test_exported_symbols(fmu):
    """Every function of fmi2Functions.h and of fmi3Functions.h, which has 75, and nothing else."""
    assert len(FMI2_FUNCTIONS) == 44
    library = fmu("four_bar").library
    loaded = ctypes.CDLL(str(library))
    assert [name for name in sorted(FMI2_FUNCTIONS) if not hasattr(loaded, name)] == []

    if shutil.which("nm") is None or library.suffix != ".so":
        pytest.skip("all 44 are there; listing what else is exported takes nm and an ELF library")
    listed = subprocess.run(
        ["nm", "-D", "--defined-only", str(library)], capture_output=True, text=True, check=True
    )
    symbols = {line.split()[-1].partition("@")[0] for line in listed.stdout.splitlines()}
    assert symbols >= FMI2_FUNCTIONS
    others = symbols - FMI2_FUNCTIONS
    assert len(others) == 75 and all(name.startswith("fmi3") for name in others), others


def test_version_and_platform(slave):
    instance = slave("four_bar")
    assert instance.fmi.getVersion() == "2.0"
    assert instance.fmi.getTypesPlatform() == "default"


# ---------------------------------------------------------------------------------------------
# Exporting again


@pytest.fixture(autouse=True)
def no_epoch(monkeypatch):
    """A date in the environment of whoever runs the tests is none of theirs."""
    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)


@pytest.mark.parametrize("name", SHIPPED)
def test_same_file_same_bytes(tmp_path, name):
    """Exported twice, the second time from a copy elsewhere and from another folder."""
    first = export(mechanism_file(name), tmp_path / "first.fmu")
    elsewhere = tmp_path / "else where"
    elsewhere.mkdir()
    copy = shutil.copy(mechanism_file(name), elsewhere / "copy of it.toml")
    for table in mechanism_file(name).parent.glob("*.csv"):
        shutil.copy(table, elsewhere)
    second = export(copy, elsewhere / "second.fmu", cwd=elsewhere)
    assert first.read_bytes() == second.read_bytes()

    with zipfile.ZipFile(first) as archive:
        # No entry carries the time of the export: the zip format begins in 1980.
        assert len({entry.date_time for entry in archive.infolist()}) == 1
        assert archive.infolist()[0].date_time[0] < 2020
    assert fmpy.read_model_description(str(first)).generationDateAndTime is None


def test_date_from_source_date_epoch(tmp_path, monkeypatch):
    undated = export(mechanism_file("pendulum"), tmp_path / "undated.fmu")
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    dated = export(mechanism_file("pendulum"), tmp_path / "dated.fmu")
    again = export(mechanism_file("pendulum"), tmp_path / "again.fmu")
    description = fmpy.read_model_description(str(dated))
    assert description.generationDateAndTime == "2023-11-14T22:13:20Z"
    assert dated.read_bytes() == again.read_bytes()
    assert description.guid == fmpy.read_model_description(str(undated)).guid
    assert validate_fmu(str(dated)) == []


def test_guid_follows_the_mechanism_not_the_layout(tmp_path):
    """Comments and layout leave the GUID alone; any value or name changes it."""
    text = mechanism_file("four_bar").read_text(encoding="utf-8")

    def guid(name, changed):
        path = tmp_path / f"{name}.toml"
        path.write_text(changed, encoding="utf-8")
        return fmpy.read_model_description(str(export(path, path.with_suffix(".fmu")))).guid

    original = guid("original", text)
    assert guid("comment", "# another comment\n" + text.replace("   ", " ")) == original
    changes = {
        "value": ("value = 0.25", "value = 0.26"),
        "start": ('start = "60*deg"', 'start = "61*deg"'),
        "estimate": ('[0, 0, "60*deg"]', '[0, 0, "59*deg"]'),
        "marker": ('"coupler_length/2", 0.05', '"coupler_length/2", 0.06'),
        "limit": ("min = 0.001", "min = 0.002"),
        "step": ("step = 0.01", "step = 0.02"),
        "name": ("transmission =", "transmissions ="),
    }
    guids = {original}
    for name, (old, new) in changes.items():
        assert old in text, f"the file no longer says {old}"
        guids.add(guid(name, text.replace(old, new)))
    assert len(guids) == len(changes) + 1
