"""The figures of this experiment: the page's plots as panels, with ticks that stay readable over few decades."""

from pathlib import Path

import numpy as np
from lab.figures import draw, figure, palette
from lab.sections import Plot
from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter, NullLocator

MANY = 7  # lines beyond which a legend lies beside its panel
FEW = 1.6  # decades below which 2 and 5 are labelled, too


def panels(folder: Path, name: str, plots: list[Plot], columns: int = 2, looks=None, falling: bool = False) -> None:
    """Draw plots side by side into NAME.png and NAME.pdf; `looks` of series' methods, of all plots at once by default.

    `falling`: x from large to small.
    """
    lines = max(1, -(-len(plots) // columns))
    looks = looks or palette(series.method for plot in plots for series in plot.series)
    with figure(folder, name, (7.2, (2.7 if columns == 2 else 2.1) * lines), lines, columns) as (_, axes):
        for place, plot in zip(axes.flat, plots, strict=False):
            draw(place, plot, looks)
            # Narrow panels have no room for a long title in one line.
            title = plot.title if columns == 2 else plot.title.replace(": ", ":\n")
            place.set_title(title, fontsize=8 if columns == 2 else 6.5)
            # Where the ends lie is known only after everything has been drawn.
            for axis, log in ((place.xaxis, plot.x.log), (place.yaxis, plot.y.log)):
                if log:
                    _tick(axis)
            if falling:
                place.invert_xaxis()
            outside = {"loc": "upper left", "bbox_to_anchor": (1.0, 1.0)} if len(plot.series) > MANY else {}
            place.legend(fontsize=5, **outside)
        for place in axes.flat[len(plots) :]:
            place.set_visible(False)


def _tick(axis) -> None:
    low, high = axis.get_view_interval()
    if not 0.0 < low < high:
        return
    first, last = int(np.floor(np.log10(low))), int(np.ceil(np.log10(high)))
    decades = range(first, last + 1)
    axis.set_minor_locator(NullLocator())
    axis.set_minor_formatter(NullFormatter())
    span = np.log10(high / low)
    steps = [1.0] if span > FEW else [1.0, 2.0, 5.0] if span > FEW / 3 else [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0]
    every = max(1, (last - first) // 5)
    axis.set_major_locator(FixedLocator([step * 10.0**n for n in decades for step in steps if n % every == 0]))
    axis.set_major_formatter(FuncFormatter(_label))


def _label(value: float, _place=None) -> str:
    if 1e-3 <= value < 1e4:
        return f"{value:.4g}"
    exponent = int(np.floor(np.log10(value) + 1e-9))
    mantissa = value / 10.0**exponent
    return f"$10^{{{exponent}}}$" if abs(mantissa - 1) < 1e-6 else f"${mantissa:.0f}\\times10^{{{exponent}}}$"
