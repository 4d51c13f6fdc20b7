"""One picture per mechanism: some poses drawn from the outputs, and the outputs against time."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")  # files only, no window

from matplotlib import pyplot as plt
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon, Rectangle

# Okabe and Ito's colours, told apart with every kind of colour vision.
BLUE, ORANGE, GREEN, PURPLE = "#0072B2", "#D55E00", "#009E73", "#CC79A7"
INK, GREY, PALE = "#222222", "#777777", "#cfcfcf"

Outputs = Mapping[str, np.ndarray]
Parameters = Mapping[str, float]


@dataclass(frozen=True)
class Pin:
    """A point of a body, in the body's own frame; `ground` is a body too."""

    body: str
    point: Callable[[Parameters], complex] = lambda parameters: 0j


@dataclass(frozen=True)
class Bar:
    """A body drawn as a bar between two pins, or as a triangle where there is a `tip`."""

    body: str
    start: Pin
    end: Pin
    color: str
    width: float = 5.0
    tip: Pin | None = None


@dataclass(frozen=True)
class Picture:
    """Drawing of a mechanism, and its outputs to plot."""

    title: str
    driver: str
    unit: str
    """Unit of the driver, as shown: ° or m."""
    bars: tuple[Bar, ...]
    """The lowest first."""
    pivots: tuple[Pin, ...]
    """Fixed to ground."""
    pins: tuple[Pin, ...]
    """Moving joints."""
    path: str
    """The body or marker whose path is drawn."""
    path_label: str
    poses: Callable[[np.ndarray], list[int]]
    """Which samples to draw, from the driver's values."""
    angles: tuple[str, ...]
    """Bodies whose angle is plotted."""
    lengths: dict[str, str]
    """Positions of points and measures to plot, with their colours."""
    block: str | None = None
    """A body drawn as a sliding block."""
    guide: Pin | None = None
    """A point of the block's guide, which runs parallel to x."""

    def color_of(self, body: str) -> str:
        return next(bar.color for bar in self.bars if bar.body == body)


def at_turns(count: int) -> Callable[[np.ndarray], list[int]]:
    """Samples at equal parts of a whole turn."""
    return lambda u: [
        int(np.argmin(np.abs(u - u[0] - 2 * np.pi * k / count))) for k in range(count)
    ]


def on_the_way(count: int) -> Callable[[np.ndarray], list[int]]:
    """Samples at equal distances between one end of an oscillation and the other."""

    def choose(u: np.ndarray) -> list[int]:
        out = u[: len(u) // 2 + 1]
        return [int(np.argmin(np.abs(out - v))) for v in np.linspace(out[0], out[-1], count)]

    return choose


def triangle(title: str, driver: str, unit: str, **rest) -> Picture:
    """The triangle of variable side: the barrel is drawn over the rod that slides in it."""
    barrel, pin = Pin("barrel"), Pin("arm", lambda p: p["arm_length"])
    return Picture(
        title,
        driver,
        unit,
        bars=(
            Bar("rod", Pin("rod"), barrel, ORANGE, width=2.5),
            Bar("barrel", barrel, Pin("barrel", lambda p: 0.15), GREEN, width=9),
            Bar("arm", Pin("arm"), pin, BLUE),
        ),
        pivots=(Pin("ground"), Pin("ground", lambda p: p["base"])),
        pins=(pin,),
        path="rod",
        path_label="path of the rod's pin",
        **rest,
    )


PICTURES: dict[str, Picture] = {
    "pendulum": Picture(
        "Pendulum",
        "swing_angle",
        "°",
        bars=(
            Bar(
                "rod",
                Pin("rod", lambda p: -p["length"] / 2),
                Pin("rod", lambda p: p["length"] / 2),
                BLUE,
            ),
        ),
        pivots=(Pin("ground"),),
        pins=(Pin("rod", lambda p: p["length"] / 2),),
        path="rod.P",
        path_label="path of rod.P",
        poses=on_the_way(5),
        angles=("rod",),
        lengths={"rod.P.x": PURPLE, "rod.P.y": INK},
    ),
    "slider_crank": Picture(
        "Slider–crank",
        "crank_angle",
        "°",
        bars=(
            Bar("crank", Pin("crank"), Pin("crank", lambda p: p["crank_length"]), BLUE),
            Bar(
                "connecting_rod",
                Pin("connecting_rod", lambda p: -p["rod_length"] / 2),
                Pin("connecting_rod", lambda p: p["rod_length"] / 2),
                ORANGE,
            ),
        ),
        pivots=(Pin("ground"),),
        pins=(Pin("crank", lambda p: p["crank_length"]), Pin("slider")),
        path="connecting_rod",
        path_label="path of the rod's middle",
        poses=at_turns(6),
        angles=("connecting_rod",),
        lengths={"slider.x": GREEN, "connecting_rod.y": PURPLE},
        block="slider",
        guide=Pin("ground", lambda p: p["offset"] * 1j),
    ),
    "four_bar": Picture(
        "Four-bar linkage",
        "crank_angle",
        "°",
        bars=(
            Bar(
                "coupler",
                Pin("coupler"),
                Pin("coupler", lambda p: p["coupler_length"]),
                ORANGE,
                tip=Pin("coupler", lambda p: p["coupler_length"] / 2 + 0.05j),
            ),
            Bar("rocker", Pin("rocker"), Pin("rocker", lambda p: p["rocker_length"]), GREEN),
            Bar("crank", Pin("crank"), Pin("crank", lambda p: p["crank_length"]), BLUE),
        ),
        pivots=(Pin("ground"), Pin("ground", lambda p: p["base"])),
        pins=(Pin("coupler"), Pin("coupler", lambda p: p["coupler_length"])),
        path="coupler.P",
        path_label="path of coupler.P",
        poses=at_turns(6),
        angles=("coupler", "rocker"),
        lengths={"coupler.P.x": PURPLE, "coupler.P.y": INK},
    ),
    "tlv": triangle(
        "Variable-side triangle, driven by its length",
        "side_length",
        "m",
        poses=on_the_way(5),
        angles=("arm", "barrel"),
        lengths={"rod.x": PURPLE, "rod.y": INK},
    ),
    "tlv_crank": triangle(
        "Variable-side triangle, driven by its arm",
        "arm_angle",
        "°",
        poses=at_turns(6),
        angles=("barrel",),
        lengths={"side_length.position": ORANGE, "rod.x": PURPLE},
    ),
}

RATES_OF = {
    "x": ("x", "vx", "ax"),
    "y": ("y", "vy", "ay"),
    "phi": ("phi", "omega", "alpha"),
    "position": ("position", "velocity", "acceleration"),
}


def draw(
    name: str, outputs: Outputs, expected: Outputs, parameters: Parameters, path: Path
) -> None:
    """Writes the picture of mechanism `name`.

    `outputs` are the FMU's, `time` and the driver's inputs among them; `expected` holds the same
    outputs from the closed form, shown as dots.
    """
    picture = PICTURES[name]
    with plt.rc_context(STYLE):
        figure = plt.figure(figsize=(14, 7.6), layout="constrained")
        left, right = figure.subfigures(1, 2, width_ratios=(1, 1.25), wspace=0.03)
        figure.suptitle(f"{picture.title}  ·  {name}.fmu in FMPy", fontsize=14, fontweight="bold")

        mechanism, driver = left.subplots(2, 1, height_ratios=(3.6, 1))
        draw_poses(mechanism, picture, outputs, parameters)
        draw_driver(driver, picture, outputs)
        draw_curves(right.subplots(3, 2, sharex=True), picture, outputs, expected)
        figure.savefig(path, dpi=110)
        plt.close(figure)


STYLE = {
    "font.size": 9.5,
    "axes.edgecolor": GREY,
    "axes.grid": True,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlesize": 10,
    "grid.color": "#e6e6e6",
    "legend.frameon": False,
    "lines.linewidth": 1.8,
}


def place(outputs: Outputs, parameters: Parameters, sample: int, pin: Pin) -> complex:
    """Returns the place of a pin at a sample, from the outputs of its body."""
    point = complex(pin.point(parameters))
    if pin.body == "ground":
        return point
    x, y, phi = (outputs[f"{pin.body}.{suffix}"][sample] for suffix in ("x", "y", "phi"))
    return complex(x, y) + point * np.exp(1j * phi)


def draw_poses(axes, picture: Picture, outputs: Outputs, parameters: Parameters) -> None:
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
    axes.grid(False)

    track = outputs[f"{picture.path}.x"], outputs[f"{picture.path}.y"]
    axes.plot(*track, color=PURPLE, linewidth=1.3, zorder=18)
    if picture.guide is not None:
        height = place(outputs, parameters, 0, picture.guide).imag
        axes.axhline(height, color=PALE, linewidth=1.2, zorder=0)

    samples = picture.poses(outputs[f"{picture.driver}.position"])
    # The first pose last, on top and in full colour.
    for rank, sample in reversed(list(enumerate(samples))):
        draw_pose(axes, picture, outputs, parameters, sample, in_front=rank == 0)
    first = samples[0]
    axes.plot(track[0][first], track[1][first], "o", color=PURPLE, markersize=6, zorder=25)
    for pivot in picture.pivots:
        at = place(outputs, parameters, first, pivot)
        axes.plot(at.real, at.imag, marker=6, markersize=13, color=INK, zorder=2)
        axes.plot(
            at.real, at.imag, "o", color=INK, markerfacecolor="white", markersize=6, zorder=24
        )

    handles = [
        Line2D([], [], color=bar.color, linewidth=4, label=bar.body.replace("_", " "))
        for bar in picture.bars
    ]
    if picture.block is not None:
        handles.append(
            Line2D([], [], color=GREEN, marker="s", markersize=9, linestyle="", label=picture.block)
        )
    handles.append(
        Line2D([], [], color=PURPLE, linewidth=1.3, marker="o", label=picture.path_label)
    )
    axes.margins(0.06)
    legend_above(axes, handles)


def draw_pose(
    axes, picture: Picture, outputs: Outputs, parameters: Parameters, sample: int, in_front: bool
) -> None:
    alpha, level = (1.0, 20) if in_front else (0.22, 10)
    for bar in picture.bars:
        ends = [place(outputs, parameters, sample, pin) for pin in (bar.start, bar.end)]
        if bar.tip is not None:
            corners = [*ends, place(outputs, parameters, sample, bar.tip)]
            axes.add_patch(
                Polygon(
                    [(corner.real, corner.imag) for corner in corners],
                    facecolor=bar.color,
                    edgecolor=bar.color,
                    linewidth=1.5,
                    alpha=0.3 * alpha,
                    zorder=level,
                    joinstyle="round",
                )
            )
        axes.plot(
            np.real(ends),
            np.imag(ends),
            color=bar.color,
            alpha=alpha,
            linewidth=bar.width,
            solid_capstyle="round",
            zorder=level + 1,
        )
    if picture.block is not None:
        center = place(outputs, parameters, sample, Pin(picture.block))
        width = 0.25 * np.ptp(outputs[f"{picture.block}.x"])
        axes.add_patch(
            Rectangle(
                (center.real - width / 2, center.imag - width / 4),
                width,
                width / 2,
                facecolor=GREEN,
                alpha=alpha,
                zorder=level,
            )
        )
    pins = [place(outputs, parameters, sample, pin) for pin in picture.pins]
    axes.plot(
        np.real(pins),
        np.imag(pins),
        "o",
        color=INK,
        markerfacecolor="white",
        markersize=4.5,
        alpha=max(alpha, 0.35),
        zorder=level + 2,
    )


def draw_driver(axes, picture: Picture, outputs: Outputs) -> None:
    value = outputs[f"{picture.driver}.position"]
    if picture.unit == "°":
        value = np.degrees(value)
        axes.yaxis.set_major_locator(plt.MaxNLocator(4, steps=[1, 3, 4.5, 6, 9, 10]))
    else:
        axes.yaxis.set_major_locator(plt.MaxNLocator(4))
    axes.plot(outputs["time"], value, color=INK)
    axes.set_title(f"input {picture.driver}.position [{picture.unit}]", loc="left")
    axes.set_xlabel("time [s]")
    axes.margins(x=0)


def draw_curves(panels, picture: Picture, outputs: Outputs, expected: Outputs) -> None:
    """Angles in the left column, points and lengths in the right, with their rates below."""
    angles = {f"{body}.phi": picture.color_of(body) for body in picture.angles}
    columns = (
        (angles, ("angle [°]", "angular velocity [rad/s]", "angular acceleration [rad/s²]")),
        (picture.lengths, ("position [m]", "velocity [m/s]", "acceleration [m/s²]")),
    )
    time = outputs["time"]
    dots = slice(None, None, max(len(time) // 24, 1))
    for column, (curves, titles) in enumerate(columns):
        handles = []
        for name, color in curves.items():
            owner, _, suffix = name.rpartition(".")
            for row, rate in enumerate(RATES_OF[suffix]):
                scale = np.degrees(1) if rate == "phi" else 1.0
                found, exact = (values[f"{owner}.{rate}"] * scale for values in (outputs, expected))
                panels[row, column].plot(time, found, color=color)
                panels[row, column].plot(time[dots], exact[dots], color=color, **DOTS)
            handles.append(Line2D([], [], color=color, label=name))
        handles.append(Line2D([], [], color=GREY, label="closed form", **DOTS))
        legend_above(panels[0, column], handles)
        for axes, title in zip(panels[:, column], titles, strict=True):
            axes.set_ylabel(title)
            axes.margins(x=0.01)
        panels[2, column].set_xlabel("time [s]")
    panels[0, 0].figure.align_ylabels(panels)


DOTS = {
    "marker": "o",
    "linestyle": "",
    "markersize": 3.6,
    "markerfacecolor": "white",
    "markeredgewidth": 1.1,
}


def legend_above(axes, handles) -> None:
    axes.legend(
        handles=handles,
        loc="lower center",
        bbox_to_anchor=(0.5, 1.0),
        ncols=len(handles),
        handlelength=1.6,
        columnspacing=1.2,
        handletextpad=0.6,
    )
