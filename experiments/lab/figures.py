"""Figures for a paper: matplotlib with one look, saved as PNG and PDF; colours belong to methods, as on the page."""

from collections.abc import Iterable
from contextlib import contextmanager
from pathlib import Path

import figuregen
import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np

from lab.sections import Download, Plot

mpl.use("Agg")  # importing figuregen has asked for LaTeX's

# Okabe and Ito's colours, which most colour-blind people can tell apart, and some more; black is the reference's.
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#7F3C8D", "#8C8C00", "#A05A2C", "#5F6B6D"]
MARKERS = ["o", "s", "^", "D", "v", "P", "X", "<", ">", "*"]
STYLE = {
    "figure.dpi": 150,
    "font.size": 8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.alpha": 0.25,
    "legend.frameon": False,
    "lines.linewidth": 1.2,
    "lines.markersize": 3.5,
    "pdf.fonttype": 42,
}


@contextmanager
def figure(folder: Path, name: str, size: tuple[float, float], rows: int = 1, columns: int = 1):
    """Yields (figure, axes as a 2-D array); saves NAME.png and NAME.pdf into `folder` at the end. `size`: inches."""
    with mpl.rc_context(STYLE):
        drawn, axes = plt.subplots(rows, columns, figsize=size, squeeze=False, layout="constrained")
        try:
            yield drawn, axes
            for suffix in ["png", "pdf"]:
                # No date in the file: the same data, the same bytes.
                drawn.savefig(folder / f"{name}.{suffix}", metadata={"CreationDate": None} if suffix == "pdf" else None)
        finally:
            plt.close(drawn)


def downloads(name: str, label: str) -> list[Download]:
    """The two files of a figure."""
    return [Download(f"{name}.png", f"{label} (PNG)"), Download(f"{name}.pdf", f"{label} (PDF)")]


def tikz_grid(folder: Path, name: str, titles: list[str], rows: list[list[np.ndarray]], width_cm: float) -> Download:
    """A grid of encoded pictures for LaTeX, by figuregen: NAME-tikz/NAME.tikz, and its PNGs beside it."""
    grid = figuregen.Grid(len(rows), len(titles))
    for i, row in enumerate(rows):
        for j, picture in enumerate(row):
            grid[i, j].set_image(figuregen.PNG(picture))
    grid.set_col_titles("top", titles)
    place = folder / f"{name}-tikz"
    place.mkdir(parents=True, exist_ok=True)
    figuregen.figure([[grid]], width_cm, str(place / f"{name}.tikz"), figuregen.TikzBackend())
    return Download(f"{place.name}/{name}.tikz", f"{name} for LaTeX (TikZ)")


def palette(methods: Iterable[str]) -> dict[str, dict]:
    """Colour and marker of each method, in the order in which they come first."""
    order = list(dict.fromkeys(methods))
    return {
        name: {"color": "#222222", "marker": "none"}
        if name in {"reference", "theory"}
        else {"color": COLOURS[i % len(COLOURS)], "marker": MARKERS[(i + i // len(COLOURS)) % len(MARKERS)]}
        for i, name in enumerate(order)
    }


def draw(axes, plot: Plot, looks: dict[str, dict] | None = None) -> None:
    """Draw a plot of the page on matplotlib's axes: lines with bands, or bars."""
    looks = looks or palette(series.method for series in plot.series)
    if plot.bars:
        _draw_bars(axes, plot, looks)
    else:
        for series in plot.series:
            _draw_series(axes, series, looks[series.method])
        axes.set_xscale("log" if plot.x.log else "linear")
    axes.set_yscale("log" if plot.y.log else "linear")
    axes.set_title(plot.title)
    axes.set_xlabel(plot.x.title)
    axes.set_ylabel(plot.y.title)


def _draw_series(axes, series, look: dict) -> None:
    x = np.array(series.x, dtype=float)
    y, low, high = (
        np.array([np.nan if one is None else one for one in column], dtype=float) if column is not None else None
        for column in (series.y, series.low, series.high)
    )
    style = {
        "line": {"marker": look["marker"], "linestyle": "-"},
        "dash": {"linestyle": "--", "linewidth": 1.0},
        "points": {"marker": look["marker"], "linestyle": "none"},
    }[series.style]
    axes.plot(x, y, color=look["color"], label=series.name, **style)
    if low is not None and high is not None:
        axes.fill_between(x, low, high, color=look["color"], alpha=0.15, linewidth=0)


def _draw_bars(axes, plot: Plot, looks: dict[str, dict]) -> None:
    names = list(dict.fromkeys(name for series in plot.series for name in series.x))
    places = np.arange(len(names))
    bottom = np.zeros(len(names))
    width = 0.8 if plot.bars == "stack" else 0.8 / len(plot.series)
    for i, series in enumerate(plot.series):
        value_of = dict(zip(series.x, series.y, strict=True))
        values = np.array([value_of.get(name) or 0.0 for name in names])
        offset = 0.0 if plot.bars == "stack" else (i - (len(plot.series) - 1) / 2) * width
        colour = looks[series.method]["color"]
        axes.bar(
            places + offset,
            values,
            width,
            bottom=bottom if plot.bars == "stack" else 0.0,
            color=colour,
            label=series.name,
        )
        bottom += values
    axes.set_xticks(places, [str(name) for name in names], rotation=30, ha="right")
    axes.grid(axis="x", visible=False)
