"""What the program forecasts while it renders, against what the same runs then did: the runs are those of `curves`.

A forecast is `halving_low_s` to `halving_high_s` further seconds until the error halves. What happened is read off the
run's own error against the reference, between its looks. Where the error did not halve before the run ended, the time
is known to be longer than what was left of the run: an interval that lies beyond is right, one that ends before is
wrong, and nothing is known of the others.
"""

import csv
import math
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from accuracy.measured import NEAR, Curve, Entry, all_curves, all_runs, plan_of_curves, who_columns
from accuracy.panels import panels
from lab.figures import downloads
from lab.runs import Run
from lab.sections import Axis, Column, Download, Plot, Section, Series, Table, Verdict
from lab.statistics import LATER, Interval, Reached, binomial_interval, time_to_reach
from lab.store import Store
from lab.target import Plan

RIGHT, WRONG, OPEN = "right", "wrong", "open"
FAR = 10.0  # times the estimate: an error beyond is one that the estimate did not see


@dataclass(frozen=True)
class Look:
    """An entry of a run's convergence, what it forecast, and what followed."""

    curve: Curve
    key: str
    entry: Entry
    halved: Reached  # further seconds
    near: bool  # the halved error is too near the reference's own to be measured

    @property
    def unstable(self) -> bool:
        """Whether the program said that its estimate of the variance rests on little."""
        return bool(self.entry.told.get("estimate_unstable"))

    @property
    def ratio(self) -> float | None:
        """The error over its estimate: the reference's own error, which adds to it, taken off."""
        estimate = self.entry.told.get("estimated_error")
        measured = self.entry.error - (self.curve.floor or 0.0)
        if not estimate or self.near and self.entry.error < NEAR * (self.curve.floor or 0.0):
            return None
        return measured / estimate

    @property
    def interval(self) -> tuple[float, float] | None:
        """Of the further seconds, as forecast; without an upper end where it may never halve."""
        low, high = self.entry.told.get("halving_low_s"), self.entry.told.get("halving_high_s")
        return None if low is None else (low, math.inf if high is None else high)

    @property
    def outcome(self) -> str:
        """RIGHT, WRONG or OPEN; empty where nothing was forecast or can be measured."""
        if self.interval is None or self.near:
            return ""
        return judge(*self.interval, self.halved)


def judge(low: float, high: float, halved: Reached) -> str:
    """Whether a forecast was right, as far as a run shows."""
    if halved.censored != LATER:
        return RIGHT if low <= halved.time <= high else WRONG
    if high < halved.time:
        return WRONG
    return RIGHT if low >= halved.time else OPEN


def runs(plan: Plan) -> list[Run]:
    """Those of `curves`."""
    return all_runs(plan_of_curves(plan))


def looks_of(curve: Curve) -> list[Look]:
    """Every entry of a curve's runs but the last ones, after which nothing was measured."""
    found = []
    for key, entries in zip(curve.made, curve.entries, strict=True):
        for i, entry in enumerate(entries[:-1]):
            after = entries[i:]
            reached = time_to_reach([one.wall_s for one in after], [one.error for one in after], entry.error / 2)
            halved = Reached(reached.time - entry.wall_s, reached.censored)
            near = curve.floor is not None and entry.error / 2 < NEAR * curve.floor
            found.append(Look(curve, key, entry, halved, near))
    return found


def report(plan: Plan, store: Store, folder: Path) -> Section:
    """Read the runs; write figures and data."""
    curves = [curve for curve in all_curves(plan_of_curves(plan), store) if curve.entries]
    looks = {id(curve): looks_of(curve) for curve in curves}
    every = [look for curve in curves for look in looks[id(curve)]]
    section = Section(plan.name, plan["title"], plan.experiment)
    section.text = [
        "As it renders, the program estimates relMSE from its pixels' own variance, and the further time until that "
        f"halves, with an interval stated at {plan['stated']:.0%}. Both are compared with what the same runs did "
        "against the reference. A run that ends before its error has halved shows only that this takes longer: an "
        "interval beyond its end is right, one before it wrong, any other open. Intervals of the shares are Clopper "
        "and Pearson's (95 %), which take looks as independent; looks at one run are not quite.",
    ]
    section.verdicts = [_coverage_verdict(plan, every), _warning_verdict(every)]
    section.tables = [_estimate_table(plan, curves, looks), _halving_table(curves, looks)]
    section.plots = [_ratio_plot(curves, looks), _halving_plot(curves, looks)]
    panels(folder, "forecast", section.plots)
    _write_csv(folder / "forecast.csv", every)
    section.downloads = [*downloads("forecast", "Forecasts"), Download("forecast.csv", "Every look and forecast (CSV)")]
    return section


def coverage(looks: Iterable[Look]) -> tuple[Interval, int, int]:
    """The share of right forecasts among those that are right or wrong, how many those are, and how many are open."""
    outcomes = [look.outcome for look in looks]
    right, wrong = outcomes.count(RIGHT), outcomes.count(WRONG)
    return binomial_interval(right, right + wrong), right + wrong, outcomes.count(OPEN)


def _coverage_verdict(plan: Plan, looks: list[Look]) -> Verdict:
    stated = plan["stated"]
    claim = (
        f"The time until the error halves lies within the forecast interval {stated:.0%} of the time, or more often."
    )
    trusted = [look for look in looks if not look.unstable]
    stable, count, still_open = coverage(trusted)
    outlasts = sum(look.outcome == RIGHT and look.halved.censored == LATER for look in trusted)
    everything, all_count, _ = coverage(looks)
    if not count:
        return Verdict(claim, "No run holds a forecast that its end could tell right from wrong.", "not tested")
    holds = "yes" if stable.high >= stated else "partly" if stable.high >= stated - 0.2 else "no"
    measured = (
        f"{stable.text()} of {count} forecasts that were not called unstable, {outlasts} of them right because the run "
        f"ended first, {still_open} more open; with the unstable ones {everything.text()} of {all_count}."
    )
    wrong = [look for look in trusted if look.outcome == WRONG]
    worst = sorted({f"{look.curve.case.method.label}, {look.curve.case.scene.title}" for look in wrong})
    why = "" if holds == "yes" else f"wrong ones: {'; '.join(worst)}"
    return Verdict(claim, measured, holds, why, runs=sorted({look.key for look in looks if look.outcome}))


def _warning_verdict(looks: list[Look]) -> Verdict:
    claim = f"Where the error is more than {FAR:g} times its estimate, the program calls the estimate unstable."
    known = [look for look in looks if look.ratio is not None and "estimate_unstable" in look.entry.told]
    off = [look for look in known if look.ratio > FAR]
    if not off:
        told = "No estimate was that far off." if known else "The program does not tell."
        return Verdict(claim, told, "not tested")
    warned = sum(look.unstable for look in off)
    fine = [look for look in known if look.ratio <= 2.0]
    alarms = sum(look.unstable for look in fine)
    holds = "yes" if warned >= 0.9 * len(off) else "partly" if warned >= 0.5 * len(off) else "no"
    measured = (
        f"{warned} of {len(off)} such estimates were called unstable; so were {alarms} of {len(fine)} that the error "
        "exceeded by at most a factor of 2."
    )
    return Verdict(claim, measured, holds, runs=sorted({look.key for look in off}))


def _estimate_table(plan: Plan, curves: list[Curve], looks: dict[int, list[Look]]) -> Table:
    factor = plan["factor"]
    columns = [*who_columns(), Column("looks", "looks"), Column("median", "error over estimate, median")]
    columns += [Column("largest", "largest"), Column("below", "error below the estimate")]
    columns += [Column("within", f"within a factor of {factor:g}"), Column("unstable", "called unstable")]
    rows = []
    for curve in curves:
        told = [look for look in looks[id(curve)] if look.ratio is not None]
        ratios = np.array([look.ratio for look in told])
        row = _row(curve) | {"looks": len(told), "unstable": sum(look.unstable for look in told)}
        if told:
            within = int(np.sum((ratios <= factor) & (ratios >= 1 / factor)))
            row |= {"median": float(np.median(ratios)), "largest": float(ratios.max())}
            row |= {"below": binomial_interval(int(np.sum(ratios <= 1.0)), len(told)).text()}
            row |= {"within": binomial_interval(within, len(told)).text()}
        rows.append(row)
    caption = "The reference's own error, where it is known, is taken off the measured one first."
    return Table("estimates", "The error and its estimate", columns, rows, caption)


def _halving_table(curves: list[Curve], looks: dict[int, list[Look]]) -> Table:
    columns = [*who_columns(), Column("looks", "looks"), Column("forecast", "with a forecast")]
    columns += [
        Column("stable", "right, if not unstable"),
        Column("all", "right, all"),
        Column("open", "open at the end"),
    ]
    columns += [Column("near", "too near the reference"), Column("actual", "halving over time so far, median")]
    rows = []
    for curve in curves:
        of = looks[id(curve)]
        stable, count, _ = coverage(look for look in of if not look.unstable)
        everything, all_count, still_open = coverage(of)
        row = _row(curve) | {"looks": len(of), "forecast": sum(look.interval is not None for look in of)}
        row |= {"stable": f"{stable.text()} of {count}" if count else "", "open": still_open}
        row |= {"all": f"{everything.text()} of {all_count}" if all_count else ""}
        row |= {"near": sum(look.near for look in of)}
        actual = [look.halved.time / look.entry.wall_s for look in of if not look.halved.censored and not look.near]
        rows.append(row | {"actual": float(np.median(actual)) if actual else None})
    caption = "Halving over time so far: 1 where the error falls as 1/time; of those that halved before the run's end."
    return Table("halvings", "The next halving and its forecast", columns, rows, caption)


def _row(curve: Curve) -> dict:
    case = curve.case
    return {"scene": case.scene.title, "backend": case.backend, "method": case.method.label, "runs": curve.keys}


def _by_method(curves: list[Curve], looks: dict[int, list[Look]]) -> dict[str, list[Look]]:
    found: dict[str, list[Look]] = {}
    for curve in curves:
        found.setdefault(curve.case.method.name, []).extend(looks[id(curve)])
    return found


def _hover(look: Look) -> str:
    told = f"{look.curve.settings()}; {look.entry.passes} passes, relMSE {look.entry.error:.3g}"
    return told + (", called unstable" if look.unstable else "")


def _points(chosen: dict[str, list[Look]], x_of, y_of) -> list[Series]:
    series = []
    for method, looks in chosen.items():
        if looks:
            label = looks[0].curve.case.method.label
            x, y = [x_of(look) for look in looks], [y_of(look) for look in looks]
            hover, keys = [_hover(look) for look in looks], [[look.key] for look in looks]
            series.append(Series(label, method, x, y, hover=hover, runs=keys, style="points"))
    return series


def _ratio_plot(curves: list[Curve], looks: dict[int, list[Look]]) -> Plot:
    chosen = {
        method: [look for look in of if look.ratio is not None and look.ratio > 0.0]
        for method, of in _by_method(curves, looks).items()
    }
    series = _points(chosen, lambda look: look.entry.passes, lambda look: look.ratio)
    series += _level(series, 1.0, "as estimated")
    axes = Axis("passes", True), Axis("relMSE over its estimate", True)
    return Plot("forecast-estimates", "The error over its estimate", *axes, series)


def _halving_plot(curves: list[Curve], looks: dict[int, list[Look]]) -> Plot:
    """Where there is a forecast, what happened over what was forecast; over the time so far in an older program."""
    forecast = any(look.entry.told.get("halving_s") for of in looks.values() for look in of)

    def expected(look: Look) -> float | None:
        return look.entry.told.get("halving_s") if forecast else look.entry.wall_s

    chosen = {
        method: [look for look in of if not look.halved.censored and not look.near and expected(look)]
        for method, of in _by_method(curves, looks).items()
    }
    series = _points(chosen, lambda look: look.entry.wall_s, lambda look: look.halved.time / expected(look))
    series += _level(series, 1.0, "as forecast" if forecast else "as 1/time")
    axes = Axis("time so far [s]", True), Axis(f"halving over {'its forecast' if forecast else 'time so far'}", True)
    caption = "Only halvings that came before the run's end: slow ones are missing late in a run."
    return Plot("forecast-halvings", "The next halving", *axes, series, caption=caption)


def _level(series: list[Series], value: float, name: str) -> list[Series]:
    x = [one for each in series for one in each.x]
    return [Series(name, "theory", [min(x), max(x)], [value, value], style="dash")] if x else []


def _write_csv(path: Path, looks: list[Look]) -> None:
    words = ["estimated_error", "halving_s", "halving_low_s", "halving_high_s", "estimate_unstable"]
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["scene", "backend", "method", "run", "wall_s", "passes", "relmse", *words,
                         "halved_s", "censored", "near_reference", "outcome"])  # fmt: skip
        for look in looks:
            case, entry = look.curve.case, look.entry
            told = [entry.told.get(word) for word in words]
            happened = [look.halved.time, look.halved.censored, look.near, look.outcome]
            who = [case.scene.name, case.backend, case.method.name, look.key]
            writer.writerow([*who, entry.wall_s, entry.passes, entry.error, *told, *happened])
