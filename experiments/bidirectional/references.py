"""References that share their photons with what they judge, beside other estimators: do the means agree?"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from lab.catalogue import Scene
from lab.images import luminance, read_exr
from lab.reports import judge, write_csv
from lab.runs import Run
from lab.sections import Column, Section, Table, Verdict
from lab.statistics import Interval, mean_interval
from lab.store import Store
from lab.target import Plan

CONFIDENCE = 0.99  # of each mean's interval
ROUNDING = 0.01  # of the reference's mean: a difference below it is none


@dataclass
class Agreement:
    """A method's mean luminance over a scene's picture, over that of the reference, from several seeds."""

    scene: Scene
    method: str
    label: str
    ratio: Interval
    runs: list[str]

    @property
    def agrees(self) -> bool:
        """Is the ratio 1, as far as can be told?"""
        return self.ratio.meets(1.0 - ROUNDING, 1.0 + ROUNDING)


def runs_of(plan: Plan, scene: Scene, method) -> list[Run]:
    """The seeds of a method on a scene."""
    return [
        plan.run(scene, method, plan.backends[0], time_s=plan["time_s"], seed=seed)
        for seed in range(1, plan["seeds"] + 1)
    ]


def runs(plan: Plan) -> list[Run]:
    """Every scene's reference, and every seed of every method."""
    found = []
    for scene in plan.scenes if plan.backends else []:
        if scene.reference.run:
            found.append(scene.reference.run)
        found += [run for method in plan.methods for run in runs_of(plan, scene, method)]
    return found


def mean_luminance(path: Path) -> float:
    """Of a picture's pixels."""
    return float(luminance(read_exr(path)).mean(dtype=np.float64))


def agreements(plan: Plan, store: Store) -> list[Agreement]:
    """Every method on every scene whose reference was rendered."""
    found = []
    for scene in plan.scenes if plan.backends else []:
        reference = scene.reference.run
        if not reference or "failed" in store.record(reference):
            continue
        mean = mean_luminance(store.image(reference))
        for method in plan.methods:
            made = [run for run in runs_of(plan, scene, method) if "failed" not in store.record(run)]
            ratio = mean_interval([mean_luminance(store.image(run)) / mean for run in made], CONFIDENCE)
            keys = [store.key(run) for run in [reference, *made]]
            found.append(Agreement(scene, method.name, method.label, ratio, keys))
    return found


def rows_of(found: list[Agreement]) -> list[dict]:
    """A row for each scene and method."""
    return [
        {
            "scene": one.scene.title,
            "reference": one.scene.reference.by,
            "method": one.label,
            "ratio": one.ratio.value,
            "low": one.ratio.low,
            "high": one.ratio.high,
            "runs": one.runs,
        }
        for one in found
    ]


def verdict_of(found: list[Agreement]) -> Verdict:
    """Do they agree?"""
    told = "; ".join(f"{one.scene.title}, {one.label}: {one.ratio.value:.3f}" for one in found)
    off = [f"{one.label} on {one.scene.title}" for one in found if not one.agrees]
    return Verdict(
        "Other estimators have the references' mean",
        f"Mean luminance over that of the reference: {told}" if told else "not measured",
        judge(one.agrees for one in found),
        f"the interval of confidence {CONFIDENCE:g}, widened by {ROUNDING:g}, must contain 1"
        + (f"; it does not for {', '.join(off)}" if off else ""),
        runs=list(dict.fromkeys(key for one in found for key in one.runs)),
    )


COLUMNS = [
    Column("scene", "scene"),
    Column("reference", "reference"),
    Column("method", "method"),
    Column("ratio", "mean over the reference's", digits=4),
    Column("low", "from", digits=4),
    Column("high", "to", digits=4),
]


def report(plan: Plan, store: Store, folder: Path) -> Section:
    """The table and the verdict."""
    found = agreements(plan, store)
    rows = rows_of(found)
    return Section(
        plan.name,
        plan["title"],
        plan.experiment,
        [
            "The references of scenes whose light arrives through glass and water are rendered with photons, as the "
            "methods that they judge. Path tracing and bidirectional path tracing find all of that light, since every "
            "lamp has an area, but too rarely for a picture, and `vcm` finds the rest with fireflies: pixels cannot be "
            "compared, means can.",
            f"{plan['seeds']} seeds of {plan['time_s']} s for each method.",
        ],
        [verdict_of(found)],
        tables=[Table("references", "Means of independent estimators", COLUMNS, rows)],
        downloads=[write_csv(folder / "references.csv", rows)],
    )
