"""Which method to pick for which scene and accuracy: the first to come down to each relMSE, of the runs of `curves`."""

import csv
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import numpy as np
from accuracy.measured import Curve, all_curves, all_runs, plan_of_curves
from accuracy.paired import paired_table
from accuracy.panels import panels
from lab.figures import downloads
from lab.runs import Run
from lab.sections import Axis, Column, Download, Plot, Section, Series, Table
from lab.statistics import EARLIER, LATER, TimeOfSeeds
from lab.store import Store
from lab.target import Plan

BETWEEN = 4  # levels of a decade in the plots


@dataclass(frozen=True)
class Contender:
    """A curve and when it came down to a level."""

    curve: Curve
    time: TimeOfSeeds

    @property
    def reached(self) -> bool:
        """Whether its median did."""
        return self.time.median.censored != LATER

    @property
    def name(self) -> str:
        """The method's."""
        return self.curve.case.method.label


def runs(plan: Plan) -> list[Run]:
    """Those of `curves`."""
    return all_runs(plan_of_curves(plan))


def report(plan: Plan, store: Store, folder: Path) -> Section:
    """Read the runs; write figures and data."""
    of = plan_of_curves(plan)
    curves = [curve for curve in all_curves(of, store) if curve.entries]
    levels = of["levels"]
    section = Section(plan.name, plan["title"], plan.experiment)
    section.text = [
        f"For each scene and backend the method whose median over {of['seeds']} seeds came down to a relMSE first. A "
        "runner-up whose spread overlaps the first one's, or that was below the level at its first look, is named as a "
        "tie: more seeds may turn them round. Times are rendering times, so they hold for this machine and these "
        "picture sizes; what no method reached in the time that it had is left open.",
    ]
    groups = [list(one) for _, one in groupby(sorted(curves, key=_place), key=_place)]
    section.answer = _answer(groups, levels)
    section.tables = [_table(groups, levels), paired_table(groups)]
    section.plots = [plot for group in groups if (plot := _plot(group, levels))]
    panels(folder, "summary", section.plots, falling=True)
    _write_csv(folder / "summary.csv", groups, levels)
    section.downloads = [*downloads("summary", "Time to reach"), Download("summary.csv", "Time to each level (CSV)")]
    return section


def _place(curve: Curve) -> tuple[str, str]:
    return curve.case.backend, curve.case.scene.name


def contenders(curves: list[Curve], level: float) -> list[Contender]:
    """The curves by the median time in which they came down to a level; those that did not come last."""
    found = [Contender(curve, curve.time_to(level)) for curve in curves]
    return sorted(found, key=lambda one: (not one.reached, one.time.median.time))


def ties(ordered: list[Contender]) -> list[Contender]:
    """Those behind the first whose spread overlaps its spread."""
    latest = ordered[0].time.high.time
    return [one for one in ordered[1:] if one.reached and _earliest(one.time) <= latest]


def _earliest(time: TimeOfSeeds) -> float:
    """The lower end of a spread: 0 where a level was reached before the first look."""
    return 0.0 if time.low.censored == EARLIER else time.low.time


def _table(groups: list[list[Curve]], levels: list[float]) -> Table:
    columns = [Column("scene", "scene"), Column("backend", "backend"), Column("level", "relMSE", digits=1)]
    columns += [Column("method", "pick"), Column("time", "in", "s"), Column("ties", "ties")]
    columns += [Column("next", "next"), Column("left", "not reached by")]
    rows = []
    for group in groups:
        for level in levels:
            ordered = contenders(group, level)
            case = group[0].case
            row = {"scene": case.scene.title, "backend": case.backend, "level": f"{level:.0e}"}
            row |= {"left": ", ".join(one.name for one in ordered if not one.reached)}
            row["runs"] = [key for curve in group for key in curve.keys]
            rows.append(row | _pick(ordered))
    caption = (
        "In brackets: the spread over seeds, or the time where a median is a bound. `< T`: below it at its first look."
    )
    return Table("summary", "Which method to pick", columns, rows, caption)


def _answer(groups: list[list[Curve]], levels: list[float]) -> Table:
    """The picks alone, a row for a scene."""
    columns = [Column("scene", "scene"), Column("backend", "backend")]
    columns += [Column(f"level_{i}", f"relMSE {level:g}") for i, level in enumerate(levels)]
    rows = []
    for group in groups:
        case = group[0].case
        row = {"scene": case.scene.title, "backend": case.backend, "runs": [key for one in group for key in one.keys]}
        rows.append(row | {f"level_{i}": _short_pick(contenders(group, level)) for i, level in enumerate(levels)})
    caption = "The first to come down to it, and in how many seconds; `=`: others that are as good, as seeds tell."
    return Table("answer", "Which method for which scene and accuracy", columns, rows, caption)


def _short_pick(ordered: list[Contender]) -> str:
    if not ordered[0].reached:
        longest = max(one.curve.case.time_s for one in ordered)
        return f"none within {longest:g}\N{NO-BREAK SPACE}s"
    names = " = ".join(one.name for one in [ordered[0], *ties(ordered)])
    return f"{names}: {ordered[0].time.median.text()}\N{NO-BREAK SPACE}s"


def _pick(ordered: list[Contender]) -> dict:
    """The first, its ties, and the next that is no tie."""
    if not ordered[0].reached:
        longest = max(one.curve.case.time_s for one in ordered)
        return {"method": "none", "time": f"> {longest:g}", "ties": "", "next": "", "left": "all"}
    tied = ties(ordered)
    rest = [one for one in ordered[1:] if one.reached and one not in tied]
    return {
        "method": ordered[0].name,
        "time": ordered[0].time.text(),
        "ties": "; ".join(f"{one.name} {one.time.median.text()}" for one in tied),
        "next": f"{rest[0].name} {rest[0].time.median.text()}" if rest else "",
    }


def _plot(curves: list[Curve], levels: list[float]) -> Plot | None:
    top, bottom = np.log10(max(levels)), np.log10(min(levels))
    fine = np.logspace(top, bottom, round((top - bottom) * BETWEEN) + 1)
    series = []
    for curve in curves:
        found = [(level, curve.time_to(level)) for level in fine]
        exact = [(level, time) for level, time in found if not time.median.censored]
        if not exact:
            continue
        x = [float(level) for level, _ in exact]
        y = [time.median.time for _, time in exact]
        low, high = [time.low.time for _, time in exact], [_top(time) for _, time in exact]
        hover = [f"{curve.settings()}; {time.reached} of {time.count} seeds reached it" for _, time in exact]
        keys = [curve.keys] * len(x)
        series.append(Series(curve.case.method.label, curve.case.method.name, x, y, low, high, hover, keys))
    if not series:
        return None
    case = curves[0].case
    axes = Axis("relMSE to reach", True), Axis("time [s]", True)
    caption = "Only what was reached, and after the first look at the image."
    title = f"Time to reach: {case.scene.title}, {case.backend}"
    return Plot(f"summary-{case.scene.name}-{case.backend}", title, *axes, series, caption=caption)


def _top(time: TimeOfSeeds) -> float:
    """The upper end of a spread; the run's end where a seed did not get there."""
    return max(time.high.time, time.median.time)


def _write_csv(path: Path, groups: list[list[Curve]], levels: list[float]) -> None:
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        words = ["scene", "backend", "relmse", "method", "median_s", "censored", "low_s", "high_s", "reached", "seeds"]
        writer.writerow([*words, "runs"])
        for group in groups:
            for level in levels:
                for one in contenders(group, level):
                    case, time = one.curve.case, one.time
                    told = [
                        time.median.time,
                        time.median.censored,
                        time.low.time,
                        time.high.time,
                        time.reached,
                        time.count,
                    ]
                    row = [case.scene.name, case.backend, level, case.method.name, *told, " ".join(one.curve.keys)]
                    writer.writerow(row)
