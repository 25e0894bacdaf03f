"""Error against time, for each scene, method and backend: slopes, times to levels, the price of further halvings."""

import csv
from itertools import groupby
from pathlib import Path

import numpy as np
from accuracy.measured import NEAR, Curve, all_curves, all_runs, parts_of, plan_of_curves, who_columns
from accuracy.panels import panels
from lab.figures import downloads, palette
from lab.runs import Run
from lab.sections import Axis, Column, Download, Plot, Section, Series, Table, Verdict
from lab.statistics import CONFIDENCE, misses_by_chance
from lab.store import Store
from lab.target import Plan

FORMULA = "relMSE = mean (I-R)^2 / (R^2 + 0.01)"


def runs(plan: Plan) -> list[Run]:
    """A run for each scene, method, backend and seed."""
    return all_runs(plan_of_curves(plan))


def report(plan: Plan, store: Store, folder: Path) -> Section:
    """Read the runs; write figures and data."""
    curves = all_curves(plan, store)
    section = Section(plan.name, plan["title"], plan.experiment)
    section.text = _text(plan)
    groups = [(key, list(of)) for key, of in groupby(sorted(curves, key=_group), key=_group)]
    section.plots = [plot for key, of in groups if (plot := _error_plot(plan, key, of))]
    prices = [plot for key, of in groups if (plot := _price_plot(key, of))]
    section.tables = [_slope_table(plan, curves), _time_table(plan, curves), _price_table(curves)]
    section.tables += [_parts_table(plan, store, curves)]
    section.verdicts = [_unbiased_verdict(plan, curves), _progressive_verdict(plan, curves)]
    looks = palette(series.method for plot in section.plots for series in plot.series)
    panels(folder, "curves", section.plots, looks=looks)
    panels(folder, "prices", prices, looks=looks)
    section.plots += prices
    _write_csv(folder / "curves.csv", curves)
    section.downloads = [
        *downloads("curves", "Error against time"),
        *downloads("prices", "Price of halvings"),
        Download("curves.csv", "Every look at every run (CSV)"),
    ]
    return section


def _text(plan: Plan) -> list[str]:
    low, high = plan["quantiles"]
    return [
        f"{FORMULA}, against rendering time without set-up. A line is the median of {plan['seeds']} seeds, its band "
        f"their quantiles {low:g} and {high:g}; each seed is interpolated between its own looks on logarithmic axes, "
        "never beyond them. The dashed line of the reference is its own error, where that is known: a curve that comes "
        f"within {NEAR:g} times of it says more of the reference than of the method: such points are excluded from "
        "slopes; the reference's error is subtracted from the rest.",
        f"Slopes are fitted to each seed from 1/{plan['tail']:g} of its time on; the interval is Student's over seeds "
        f"({CONFIDENCE:.0%}). A level that a seed does not reach is later than its end, and never guessed.",
    ]


def _group(curve: Curve) -> tuple[str, str, str]:
    """Curves of one plot: a scene, a backend, and integrators or the structures of one."""
    return curve.case.structure_of, curve.case.backend, curve.case.scene.name


def _title(curve: Curve, key: tuple[str, str, str]) -> str:
    of = f", structures of {key[0]}" if key[0] else ""
    return f"{curve.case.scene.title}, {curve.case.backend}{of}"


def _id(kind: str, key: tuple[str, str, str]) -> str:
    return "-".join(word for word in (kind, key[2], key[1], key[0]) if word)


def _error_plot(plan: Plan, key: tuple, curves: list[Curve]) -> Plot | None:
    drawn = [curve for curve in curves if len(curve.grid)]
    if not drawn:
        return None
    series = [_error_series(plan, curve) for curve in drawn]
    ends = [drawn[0].grid[0], max(curve.grid[-1] for curve in drawn)]
    first = min(curve.grid[0] for curve in drawn)
    if drawn[0].floor:
        floor = drawn[0].floor
        series.append(Series("the reference's own error", "reference", [first, ends[1]], [floor, floor], style="dash"))
    unbiased = [curve for curve in drawn if curve.theory().unbiased]
    if unbiased:
        end, error = unbiased[0].grid[-1], unbiased[0].median[-1]
        start = max(unbiased[0].grid[0], end / plan["tail"])
        series.append(Series("slope -1", "theory", [start, end], [error * end / start, error], style="dash"))
    axes = Axis("rendering time [s]", True), Axis("relMSE", True)
    left_out = [curve.case.method.label for curve in curves if not len(curve.grid)]
    caption = f"Too few looks in the time for a curve: {', '.join(left_out)}." if left_out else ""
    return Plot(_id("curves", key), _title(drawn[0], key), *axes, series, caption=caption)


def _error_series(plan: Plan, curve: Curve) -> Series:
    low, median, high = curve.quantiles([plan["quantiles"][0], 0.5, plan["quantiles"][1]])
    passes = np.median([np.interp(curve.grid, curve.times(seed), curve.passes(seed)) for seed in curve.seeds], axis=0)
    hover = [f"{curve.settings()}; about {count:.0f} passes" for count in passes]
    keys = [curve.keys for _ in curve.grid]
    columns = [column.tolist() for column in (curve.grid, median, low, high)]
    return Series(curve.case.method.label, curve.case.method.name, *columns, hover, keys)


def _price_plot(key: tuple, curves: list[Curve]) -> Plot | None:
    series = []
    for curve in curves:
        found = curve.halvings()
        if not found:
            continue
        x, y = [one.error / 2 for one in found], [one.ratio for one in found]
        hover = [f"{curve.settings()}; from {one.error:.3g} to half of it in {one.seconds:.3g} s more" for one in found]
        series.append(
            Series(curve.case.method.label, curve.case.method.name, x, y, hover=hover, runs=[curve.keys] * len(x))
        )
    if not series:
        return None
    places = [x for one in series for x in one.x]
    ends = [min(places) / 1.2, max(places) * 1.2]
    series.append(Series("1/time: twice", "theory", ends, [2.0, 2.0], style="dash"))
    title = f"Halvings: {_title(curves[0], key)}"
    axes = Axis("relMSE that was reached", True), Axis("time over time before")
    return Plot(_id("prices", key), title, *axes, series)


def _slope_table(plan: Plan, curves: list[Curve]) -> Table:
    columns = [
        *who_columns(),
        Column("passes", "passes"),
        Column("final", "relMSE at the end"),
        Column("floor", "reference's own relMSE"),
        Column("time", "slope against time"),
        Column("by_passes", "slope against passes"),
        Column("theory", "theory, whole image"),
        Column("note", "note"),
    ]
    rows = []
    for curve in curves:
        row = _row(curve) | {"floor": curve.floor if curve.floor is not None else "not known", "note": _note(curve)}
        if curve.entries:
            theory = curve.theory()
            told = f"{theory.low:.2f}" if theory.unbiased else f"{theory.low:.2f} to {theory.high:.2f}: {theory.why}"
            row |= {
                "passes": int(np.median([one["passes"] for one in curve.statistics])),
                "final": curve.final(),
                "time": curve.slope(plan["tail"]).text(),
                "by_passes": curve.slope(plan["tail"], "passes").text(),
                "theory": told,
            }
        rows.append(row)
    caption = f"Slope [{CONFIDENCE:.0%} interval over seeds], from 1/{plan['tail']:g} of the time on."
    return Table("slopes", "Slopes", columns, rows, caption)


def _note(curve: Curve) -> str:
    notes = [f"{len(curve.failed)} of {len(curve.keys)} runs failed: {curve.failed[0]}"] if curve.failed else []
    if curve.near_reference():
        notes.append("the end is near the reference's own error")
    return "; ".join(notes)


def _time_table(plan: Plan, curves: list[Curve]) -> Table:
    columns = [*who_columns(), *(Column(f"level_{i}", f"{level:.0e}", "s") for i, level in enumerate(plan["levels"]))]
    rows = []
    for curve in curves:
        times = {f"level_{i}": curve.time_to(level) for i, level in enumerate(plan["levels"])}
        rows.append(_row(curve) | {key: time.text() if time else "no run" for key, time in times.items()})
    caption = "Median over seeds of when the error first came down to a level (and quantiles). `> T`: not reached by T."
    return Table("times", "Time to reach a relMSE", columns, rows, caption)


def _price_table(curves: list[Curve]) -> Table:
    columns = [
        *who_columns(),
        Column("halvings", "halvings"),
        Column("error", "last: from relMSE"),
        Column("seconds", "took", "s"),
        Column("ratio", "time over time before"),
        Column("first", "first: time over time before"),
    ]
    rows = []
    for curve in curves:
        found = curve.halvings()
        row = _row(curve) | {"halvings": len(found)}
        if found:
            last = found[-1]
            row |= {"error": last.error, "seconds": last.seconds, "ratio": last.ratio, "first": found[0].ratio}
        rows.append(row)
    caption = "Along the median curve, counted back from its end. Independent samples need twice the time."
    return Table("prices", "Price of a further halving", columns, rows, caption)


def _parts_table(plan: Plan, store: Store, curves: list[Curve]) -> Table:
    columns = [*who_columns(), Column("final", "relMSE"), Column("variance", "variance"), Column("bias", "bias^2")]
    columns += [Column("floor", "the reference's own error")]
    rows = []
    for curve in curves:
        parts = parts_of(plan, store, curve.case, curve.floor)
        if parts:
            row = _row(curve) | {
                "final": curve.final(),
                "floor": curve.floor if curve.floor is not None else "not known",
            }
            rows.append(row | {"variance": parts.variance, "bias": parts.bias_squared})
    caption = (
        f"At the end of the time, whole image, weighted as relMSE is: variance over {plan['seeds']} seeds, and the "
        "squared distance of their mean from the reference less the mean's own variance and the reference's own error, "
        "which is part of bias^2 where it is not known. Noise may bring bias^2 below 0, and rare bright paths that no "
        "seed has met yet count as bias."
    )
    return Table("parts", "Bias and variance at the end", columns, rows, caption)


def _row(curve: Curve) -> dict:
    case = curve.case
    return {"scene": case.scene.title, "backend": case.backend, "method": case.method.label, "runs": curve.keys}


def _unbiased_verdict(plan: Plan, curves: list[Curve]) -> Verdict:
    claim = "The relMSE of an unbiased estimator falls as 1/samples: slope -1."
    found = [
        (curve, curve.slope(plan["tail"], "passes")) for curve in curves if curve.entries and curve.theory().unbiased
    ]
    return _verdict(claim, [(curve, slope, slope.holds(-1.0)) for curve, slope in found if np.isfinite(slope.low)])


def _progressive_verdict(plan: Plan, curves: list[Curve]) -> Verdict:
    claim = (
        "The relMSE of progressive photon mapping falls more slowly: no faster than the noise of eye paths (-1), "
        "no slower than the bias at edges, -(1-a)/2."
    )
    found = []
    for curve in curves:
        if not curve.entries:
            continue
        theory, slope = curve.theory(), curve.slope(plan["tail"], "passes")
        if not theory.unbiased and theory.high < 0.0 and np.isfinite(slope.low):
            found.append((curve, slope, slope.meets(theory.low, theory.high)))
    return _verdict(claim, found)


def _verdict(claim: str, found: list[tuple]) -> Verdict:
    """`found`: curve, slope, whether it agrees. As many may disagree as do by chance where all are right."""
    if not found:
        return Verdict(claim, "Too few looks for a slope.", "not tested")
    missed = [f"{one[0].case.scene.title}, {one[0].case.backend}, {one[0].case.method.label}: {one[1].text()}"
              for one in found if not one[2]]  # fmt: skip
    allowed = misses_by_chance(len(found))
    agree = len(found) - len(missed)
    holds = "yes" if len(missed) <= allowed else "partly" if agree >= len(missed) else "no"
    values = [slope.value for _, slope, _ in found]
    measured = (
        f"{agree} of {len(found)} slopes against passes agree within their {CONFIDENCE:.0%} intervals (chance alone "
        f"lets up to {allowed} miss); they lie between {min(values):.2f} and {max(values):.2f}."
    )
    keys = [key for curve, _, _ in found for key in curve.keys]
    return Verdict(claim, measured, holds, "; ".join(missed), "Kaplanyan and Dachsbacher 2013", keys)


def _write_csv(path: Path, curves: list[Curve]) -> None:
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        words = ["relmse", "relmse_trimmed", "mse", "estimated_error"]
        writer.writerow(["scene", "backend", "method", "run", "wall_s", "passes", *words, "reference_relmse"])
        for curve in curves:
            who = [curve.case.scene.name, curve.case.backend, curve.case.method.name]
            for key, entries in zip(curve.made, curve.entries, strict=True):
                for one in entries:
                    told = [one.told.get(word) for word in words]
                    writer.writerow([*who, key, one.wall_s, one.passes, *told, curve.floor])
