"""Methods beside the best one of a scene, seed by seed, at equal time."""

import math

import numpy as np
from accuracy.measured import Curve
from lab.sections import Column, Table
from lab.statistics import CONFIDENCE, Interval, log_interpolate, paired_log_difference


def errors_at(curve: Curve, time: float) -> dict[int, float]:
    """The error of each seed at a time, by seed; those whose looks do not reach that far are missing."""
    found = {}
    for seed, place in zip(curve.seed_numbers, curve.seeds, strict=True):
        error = float(log_interpolate([time], curve.times(place), curve.errors(place))[0])
        if math.isfinite(error):
            found[seed] = error
    return found


def equal_time(curves: list[Curve]) -> float:
    """The latest time that every seed of every curve has measured."""
    return min(curve.times(seed)[-1] for curve in curves for seed in curve.seeds)


def compare(curve: Curve, best: Curve, time: float) -> tuple[Interval, int]:
    """The mean over seeds of log(error / error of the best), and how many seeds are pairs."""
    own, others = errors_at(curve, time), errors_at(best, time)
    pairs = sorted(own.keys() & others.keys())
    return paired_log_difference([own[one] for one in pairs], [others[one] for one in pairs]), len(pairs)


def paired_table(groups: list[list[Curve]]) -> Table:
    """For each scene and backend: the method with the least mean log error at equal time, and the others beside it."""
    columns = [Column("scene", "scene"), Column("backend", "backend"), Column("method", "method")]
    columns += [Column("best", "against"), Column("time", "at", "s"), Column("seeds", "pairs")]
    columns += [
        Column("difference", "mean difference of ln relMSE"),
        Column("factor", "relMSE, times"),
        Column("told", ""),
    ]
    rows = []
    for group in groups:
        time = equal_time(group)
        means = {id(one): _mean_log(errors_at(one, time)) for one in group}
        ordered = sorted((one for one in group if math.isfinite(means[id(one)])), key=lambda one: means[id(one)])
        for curve in ordered[1:]:
            found, pairs = compare(curve, ordered[0], time)
            case = curve.case
            rows.append(
                {
                    "scene": case.scene.title,
                    "backend": case.backend,
                    "method": case.method.label,
                    "best": ordered[0].case.method.label,
                    "time": time,
                    "seeds": pairs,
                    "difference": found.text(),
                    "factor": _factor(found),
                    "told": _told(found),
                    "runs": [*curve.keys, *ordered[0].keys],
                }
            )
    caption = (
        f"Pairs have the same seed; in brackets the {CONFIDENCE:.0%} interval of the mean, by Student's t over pairs. "
        "Each row is a comparison of its own: of twenty, one may be worse by chance."
    )
    return Table("paired", "Paired comparisons at equal time", columns, rows, caption)


def _mean_log(errors: dict[int, float]) -> float:
    return float(np.mean(np.log(list(errors.values())))) if errors else math.nan


def _factor(found: Interval) -> str:
    return Interval(*(math.exp(one) for one in (found.value, found.low, found.high))).text()


def _told(found: Interval) -> str:
    """Whether a method is worse than the best one, as far as the pairs show."""
    if not math.isfinite(found.low):
        return "too few pairs"
    return "worse" if found.low > 0.0 else "no difference shown"
