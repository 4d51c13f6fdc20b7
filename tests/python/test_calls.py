"""Calls with random arguments of right and wrong shapes: what comes out is a result or an exception that
tells what was wrong, never a panic."""

from __future__ import annotations

import warnings

import biela
import numpy as np
import pytest
from shipped import MECHANISMS

TOLD = (biela.Error, TypeError, ValueError)
"""Exceptions that a wrong argument may raise."""
DEFECT = "defect in biela"
ROUNDS = 4
"""Calls of each function per mechanism: 280 of each over all mechanisms."""
WORDS = ["", "nobody", "time", "1 +", "2*t", "sin(10*t)", "1/0", "log(t - 5)", "120*mm", "3*furlong", "1e999"]
ODD = [None, np.nan, np.inf, -1, 0, 1.5, True, "x", b"x", [], {}, (), object(), [[1, 2], [3]], 10**400]


def chosen(rng, among):
    """Returns one of these, whatever their types."""
    return among[rng.integers(len(among))]


def numbers(rng, count):
    """Returns numbers, mostly of this count, mostly good ones."""
    count = chosen(rng, [count, count, count, 0, 1, count + 1])
    values = rng.normal(0, chosen(rng, [0.01, 1, 100]), count)
    if count and rng.random() < 0.1:
        values[rng.integers(count)] = chosen(rng, [np.nan, np.inf, 1e300])
    return chosen(rng, [values, values, values.tolist(), values.astype(complex), values.reshape(1, -1)])


def some(rng, names, least=0):
    """Returns some of these names, now and then a wrong one."""
    names = list(names)
    found = [str(name) for name in rng.choice(names, rng.integers(least, 4))] if names else []
    if rng.random() < 0.1:
        found.append(chosen(rng, WORDS))
    return found


class Arguments:
    """Random arguments for the functions of a mechanism."""

    def __init__(self, rng, mechanism):
        self.rng, self.mechanism = rng, mechanism
        owners = {variable.rpartition(".")[0] for variable in mechanism.variables} - {""}
        self.variable_names = [*mechanism.variables, *owners]
        self.starts = [f"{name}.{rate}" for name in mechanism.freedoms for rate in ("position", "velocity")]
        self.moved = [*mechanism.drivers, *mechanism.freedoms, *mechanism.inputs]
        self.count = int(rng.integers(1, 6))

    def or_odd(self, value):
        """Returns the value, or now and then something that no argument may be."""
        return chosen(self.rng, ODD) if self.rng.random() < 0.05 else value

    def variables(self):
        known = some(self.rng, self.variable_names)
        return self.or_odd(chosen(self.rng, [None, known, known, known[:1], "".join(known[:1])]))

    def times(self):
        even = np.linspace(0, self.rng.uniform(0, 0.05), self.count)
        return self.or_odd(chosen(self.rng, [None, even, even, even, -even, even[::-1], numbers(self.rng, 3)]))

    def motion(self):
        series = numbers(self.rng, self.count)
        pair = (series, numbers(self.rng, self.count))
        return self.or_odd(chosen(self.rng, [chosen(self.rng, WORDS), series, series, pair, (*pair, 0.0), 0.3]))

    def drive(self):
        return self.or_odd({name: self.motion() for name in some(self.rng, self.moved)})

    def start(self):
        return self.or_odd({name: self.or_odd(self.rng.normal()) for name in some(self.rng, self.moved)})

    def value(self, name):
        parameter = self.mechanism.parameters.get(name)
        near = parameter.value * self.rng.uniform(0.98, 1.02) if parameter else 0.1
        return self.or_odd(chosen(self.rng, [near, near, near, chosen(self.rng, WORDS)]))

    def settable(self):
        return some(self.rng, [*self.mechanism.parameters, *self.starts])

    def parameters(self):
        return self.or_odd({name: self.value(name) for name in self.settable()})

    def swept(self):
        shape = chosen(self.rng, [(), (2,), (2, 3), (0,), (3,)])
        value = lambda name: self.or_odd(np.full(shape, self.value(name)))
        return self.or_odd({name: value(name) for name in self.settable()})

    def gradient(self):
        known = self.settable()
        return self.or_odd(chosen(self.rng, [(), known, known, "all", "".join(known[:1])]))

    def poses(self):
        sizes = [3, 3, 3, 2, 4, 0]
        bodies = self.mechanism.bodies[: chosen(self.rng, [None, -1])]
        return {body: self.or_odd(self.rng.normal(size=chosen(self.rng, sizes))) for body in bodies}

    def flag(self):
        return bool(self.rng.integers(2))


def calls(a, folder):
    """Returns a call of each public function, by its name, with arguments of its own."""
    own = a.mechanism
    driver = lambda: a.or_odd(chosen(a.rng, [*a.moved, "nobody"]))
    target = lambda: biela.Target(
        a.or_odd({name: numbers(a.rng, a.count) for name in some(a.rng, own.variables, 1)}),
        a.drive(),
        chosen(a.rng, [None, None, driver()]),
    )
    return {
        "run": lambda: own.run(
            a.times(), a.drive(), a.parameters(), a.variables(), a.gradient(),
            chosen(a.rng, ["keep", "raise", "never"]), a.drive(),
        ),
        "film": lambda: own.run(a.times(), a.drive(), stop="keep").to_html(a.flag()),
        "sweep": lambda: own.sweep(a.swept(), a.times(), a.drive(), a.variables(), False, a.drive()),
        "range": lambda: own.range(
            driver(), a.start(), a.parameters(), a.or_odd((None, chosen(a.rng, [1.0, "1"]))), a.or_odd(None)
        ),
        "modes": lambda: own.modes(a.start(), a.parameters()),
        "balance": lambda: own.balance(a.start(), a.parameters(), a.flag()),
        "linearize": lambda: own.linearize(a.start(), a.parameters(), a.variables(), a.flag()),
        "draw": lambda: own.draw(
            a.start(), a.parameters(), poses=a.or_odd(2), driver=chosen(a.rng, [None, driver()]),
            width=a.or_odd(100), forces=a.flag(), between=a.or_odd((0.1, None)),
            path=a.or_odd(folder / f"x.{chosen(a.rng, ['png', 'svg', 'dxf', 'x'])}"),
        ),
        "convert": lambda: own.convert(
            a.or_odd(chosen(a.rng, ["pmks", "asmt"])), a.or_odd(folder / "x"), a.start(), a.parameters()
        ),
        "report": lambda: own.report(a.or_odd(folder / "x.html"), a.start(), a.parameters()),
        "page": lambda: own.page(a.or_odd(folder / "x.html"), a.or_odd(None), a.or_odd(None), a.or_odd("x")),
        "model_description": lambda: own.model_description(a.or_odd(2)),
        "new": lambda: biela.new(a.or_odd("x"), a.or_odd("four_bar"), a.or_odd(folder)),
        "import_mechanism": lambda: biela.import_mechanism(a.or_odd(folder / "x"), a.or_odd(None), a.or_odd("m")),
        "platforms": lambda: biela.platforms(a.or_odd(folder)),
        "changed": lambda: own.changed(a.parameters(), a.start()),
        "posed": lambda: own.posed(a.or_odd(biela.Mode(a.poses(), 1.0))),
        "check": lambda: own.check(),
        "export": lambda: own.export(folder / "x.fmu", a.or_odd(["none"]), a.or_odd(folder), a.or_odd(3)),
        "tolerance": lambda: biela.tolerance(
            own, a.times(), a.drive(), a.or_odd({name: a.value(name) for name in a.settable()}),
            a.parameters(), a.variables(), samples=a.or_odd(2),
        ),
        "fit": lambda: biela.fit(
            own, a.or_odd([target()]), a.settable(), starts=1, variations=0,
            bounds=a.or_odd({name: (0.05, 0.1) for name in a.settable()}),
        ),
        "loads": lambda: biela.loads(a.or_odd(own.text[: a.rng.integers(len(own.text))])),
        "library": lambda: biela.library(a.or_odd("four_bar")),
        "load": lambda: biela.load(a.or_odd(folder / "none.toml")),
    }  # fmt: skip


@pytest.mark.parametrize("place", range(len(MECHANISMS)), ids=[path.stem for path in MECHANISMS])
def test_random_arguments_never_panic(place, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    mechanism = biela.load(MECHANISMS[place])
    rng = np.random.default_rng(place)
    ended = 0
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for number in range(ROUNDS):
            a = Arguments(rng, mechanism)
            for name, call in calls(a, tmp_path).items():
                state = rng.bit_generator.state["state"]["state"]
                try:
                    call()
                    ended += 1
                except TOLD as error:
                    assert DEFECT not in str(error), (name, number, state)
                except BaseException as error:
                    raise AssertionError(f"{name}, round {number}: {error!r}") from error
    assert ended > 0, "all calls were refused: the arguments are worthless"


def test_a_gradient_without_a_variable_of_a_force(mechanism):
    """The rotor of a motor whose torque is open: θ = M t²/(2 J), ∂θ/∂J = −M t²/(2 J²)."""
    rotor = biela.loads(
        "format = 1\nname = 'rotor'\nparameters = { J = 0.5 }\n[ground.markers]\nO = [0, 0]\n[bodies.rotor]\n"
        "mass = 1\ninertia = 'J'\nmarkers = { O = [0, 0] }\n[joints]\n"
        "O = { type = 'revolute', markers = ['ground.O', 'rotor.O'] }\n[freedoms]\n"
        "turn = { coordinate = 'angle', markers = ['ground.O', 'rotor.O'], start = 0 }\n[forces]\n"
        "motor = { coordinate = 'angle', markers = ['ground.O', 'rotor.O'] }\n"
    )
    t = np.linspace(0, 1, 5)
    result = rotor.run(t=t, inputs={"motor.effort": 0.0 * t + 2}, variables=["rotor.phi"], gradient=["J"])
    # The tolerance of the motion is 1e-8 or less.
    np.testing.assert_allclose(result["rotor.phi"], 2 * t**2, atol=1e-7)
    np.testing.assert_allclose(result.gradient["rotor.phi", "J"], -4 * t**2, atol=1e-7)


@pytest.mark.parametrize("size", [0, 2, 4])
def test_a_pose_of_another_length_is_refused(four_bar, size):
    poses = {**four_bar.check().poses, "coupler": np.zeros(size)}
    with pytest.raises(biela.UsageError, match="posed: expected three finite numbers as `coupler`"):
        four_bar.posed(biela.Mode(poses, 1.0))
    del poses["coupler"]
    with pytest.raises(biela.UsageError, match="posed: the mode has no pose of body `coupler`"):
        four_bar.posed(biela.Mode(poses, 1.0))


def test_a_defect_is_an_error_that_asks_for_a_report(capfd):
    from biela import _biela

    message = r"defect in biela: a test \(.*lib.rs:\d+:\d+\); please report it with the mechanism file"
    with pytest.raises(biela.Error, match=message):
        _biela.defect()
    assert capfd.readouterr().err == ""
