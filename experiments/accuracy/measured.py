"""Curves of error against time, as the targets `curves`, `summary` and `forecast` share them."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from lab.catalogue import EXPERIMENTS, NO_BIAS, STAYS, VANISHES, Method, Scene, read_toml
from lab.images import ROOT, read_exr, reference_error
from lab.runs import Run
from lab.sections import Column
from lab.statistics import (
    ErrorParts,
    Halving,
    Interval,
    TimeOfSeeds,
    bands,
    common_grid,
    error_parts,
    halvings,
    log_interpolate,
    log_slope,
    mean_interval,
    median_time,
    time_to_reach,
)
from lab.store import Store
from lab.target import Plan, Target

GRID = 17  # points of a median curve
NEAR = 2.0  # times the reference's own error: below it a measured error says more of the reference than of the image


@dataclass(frozen=True)
class Case:
    """One curve: a method on a scene and backend, with `time_s` for each seed."""

    scene: Scene
    method: Method
    backend: str
    time_s: float

    @property
    def structure_of(self) -> str:
        """The integrator of a method that names a structure: such methods are compared among themselves."""
        integrator, plus, _ = self.method.name.partition("+")
        return integrator if plus else ""


@dataclass(frozen=True)
class Entry:
    """A look at a run: its time, passes, error against the reference, and everything that the program said."""

    wall_s: float
    passes: int
    error: float
    told: dict = field(compare=False, hash=False, default_factory=dict)


@dataclass
class Curve:
    """The runs of a case: for each seed the entries of its convergence."""

    case: Case
    keys: list[str]
    made: list[str]  # keys of the runs that did not fail, as the lists below
    entries: list[list[Entry]]
    statistics: list[dict]
    failed: list[str]
    floor: float | None  # the reference's own error
    seed_numbers: list[int] = field(default_factory=list)  # of the runs that did not fail

    def times(self, seed: int) -> list[float]:
        """When a seed was looked at."""
        return [one.wall_s for one in self.entries[seed]]

    def errors(self, seed: int) -> list[float]:
        """A seed's errors then."""
        return [one.error for one in self.entries[seed]]

    def passes(self, seed: int) -> list[int]:
        """A seed's passes then."""
        return [one.passes for one in self.entries[seed]]

    @property
    def seeds(self) -> range:
        """Places of the seeds whose runs did not fail."""
        return range(len(self.entries))

    @cached_property
    def grid(self) -> np.ndarray:
        """Times that every seed has measured; empty where no two looks are common."""
        return common_grid([self.times(seed) for seed in self.seeds], GRID)

    def quantiles(self, quantiles: Iterable[float]) -> list[np.ndarray]:
        """Quantiles of the errors over seeds, along the grid."""
        rows = [log_interpolate(self.grid, self.times(seed), self.errors(seed)) for seed in self.seeds]
        return bands(np.array(rows), list(quantiles))

    @cached_property
    def median(self) -> np.ndarray:
        """The median error along the grid."""
        return self.quantiles([0.5])[0]

    def final(self) -> float | None:
        """The median over seeds of the errors at the end."""
        return float(np.median([self.errors(seed)[-1] for seed in self.seeds])) if self.entries else None

    def near_reference(self) -> bool:
        """Whether it comes so near the reference's own error that it flattens for that reason."""
        return self.floor is not None and self.final() is not None and self.final() < NEAR * self.floor

    def slope(self, tail: float, against: str = "wall_s") -> Interval:
        """d log error / d log time (or passes) from 1/tail of the time on, without looks near the reference's error.

        What the reference adds to an error, where that is known, is taken off.
        """
        slopes, floor = [], self.floor or 0.0
        for entries in self.entries:
            kept = [one for one in entries if one.wall_s >= entries[-1].wall_s / tail and one.error >= NEAR * floor]
            slopes.append(log_slope([getattr(one, against) for one in kept], [one.error - floor for one in kept]))
        return mean_interval(slopes)

    def time_to(self, level: float) -> TimeOfSeeds | None:
        """When the seeds came down to a level."""
        found = [time_to_reach(self.times(seed), self.errors(seed), level) for seed in self.seeds]
        return median_time(found) if found else None

    def halvings(self) -> list[Halving]:
        """What each halving of the median error took."""
        return halvings(self.grid, self.median) if len(self.grid) else []

    def theory(self) -> "Theory":
        """What is expected of its method."""
        return theory_of(self.case.method, self.statistics[0])

    def settings(self) -> str:
        """One line for hover texts."""
        case = self.case
        return f"{case.method.label}, {case.scene.title}, {case.backend}, {len(self.keys)} seeds"


def who_columns() -> list[Column]:
    """The columns that say which case a row is about."""
    return [Column("scene", "scene"), Column("backend", "backend"), Column("method", "method")]


def plan_of_curves(plan: Plan) -> Plan:
    """The plan whose runs a target takes: its own, or that of `runs_of`, less what its own table says otherwise."""
    name = plan.get("runs_of")
    if not name:
        return plan
    table = read_toml(EXPERIMENTS / plan.experiment / "experiment.toml")["targets"][name]
    of = Target(plan.experiment, name, table)
    return of.plan(plan.catalogue, plan.available_backends, plan.device, plan.full, plan.table)


def cases(plan: Plan) -> list[Case]:
    """Everything that is compared, each once: the table's scenes x methods x backends, and those of its rows `more`."""
    found: dict[tuple, Case] = {}
    for row in [{}, *plan.get("more", [])]:
        said = {key: row.get(key, plan[key]) for key in ("scenes", "methods", "backends", "time_s")}
        for backend in said["backends"]:
            if backend not in plan.available_backends:
                continue
            for scene in map(plan.catalogue.scene, said["scenes"]):
                for method in plan.catalogue.methods(said["methods"]):
                    case = Case(scene, method, backend, said["time_s"])
                    found.setdefault((scene.name, method.name, backend), case)
    return list(found.values())


def runs_of(plan: Plan, case: Case) -> list[Run]:
    """A run for each seed."""
    reference = case.scene.reference.source()
    kept = {"time_s": case.time_s, "reference": reference, "measures_time": True}
    seeds = range(1, plan["seeds"] + 1)
    return [plan.run(case.scene, case.method, case.backend, seed=seed, **kept) for seed in seeds]


def all_runs(plan: Plan) -> list[Run]:
    """The runs of every case."""
    return [run for case in cases(plan) for run in runs_of(plan, case)]


def entries_of(statistics: dict) -> list[Entry]:
    """The entries whose error is known, in order; the last look is told twice where a run ends on one."""
    found: dict[float, Entry] = {}
    for told in statistics.get("convergence") or []:
        error, wall = told.get("relmse"), told.get("wall_s")
        if error and wall and error > 0.0 and wall > 0.0:
            found[wall] = Entry(wall, told["passes"], error, told)
    return [found[wall] for wall in sorted(found)]


def curve_of(plan: Plan, store: Store, case: Case, floors: dict[str, float | None] | None = None) -> Curve:
    """Read the runs of a case."""
    curve = Curve(case, [], [], [], [], [], _floor(case.scene, store, {} if floors is None else floors))
    for run in runs_of(plan, case):
        record = store.record(run)
        curve.keys.append(record["key"])
        entries = entries_of(record["statistics"]) if "failed" not in record else []
        if entries:
            curve.made.append(record["key"])
            curve.entries.append(entries)
            curve.statistics.append(record["statistics"])
            curve.seed_numbers.append(run.seed)
        else:
            curve.failed.append((record.get("failed") or "no image was finished in the time").splitlines()[-1])
    return curve


def all_curves(plan: Plan, store: Store) -> list[Curve]:
    """The curves of every case."""
    floors: dict[str, float | None] = {}
    return [curve_of(plan, store, case, floors) for case in cases(plan)]


def _floor(scene: Scene, store: Store, floors: dict[str, float | None]) -> float | None:
    if scene.name not in floors:
        floors[scene.name] = reference_error(scene.reference, store)["relmse"]
    return floors[scene.name]


def parts_of(plan: Plan, store: Store, case: Case, floor: float | None) -> ErrorParts | None:
    """relMSE at the end of a case's runs, as bias and variance; None for fewer than three images.

    The reference's own error, where it is known, is taken off the bias.
    """
    runs = [run for run in runs_of(plan, case) if "failed" not in store.record(run)]
    if len(runs) < 3:
        return None
    source = case.scene.reference.source()
    truth = read_exr(store.image(source) if isinstance(source, Run) else ROOT / source)
    images = np.stack([read_exr(store.image(run)) for run in runs]).astype(np.float64)
    kept = np.isfinite(images).all(axis=0) & np.isfinite(truth)
    parts = error_parts(images[:, kept], truth[kept], 1.0 / (truth[kept] ** 2 + 0.01))
    return ErrorParts(parts.variance, parts.bias_squared - (floor or 0.0))


@dataclass(frozen=True)
class Theory:
    """Slopes that theory allows of a whole image's error against passes, and why."""

    low: float
    high: float
    why: str
    unbiased: bool = False


def theory_of(method: Method, statistics: dict) -> Theory:
    """What is expected of a method: what methods.toml says of its bias, and how fast radii shrink."""
    if method.bias == NO_BIAS:
        return Theory(-1.0, -1.0, "samples are independent", True)
    if method.bias == STAYS:
        return Theory(-1.0, 0.0, "what all passes share stays, with its noise and bias")
    if method.bias != VANISHES:
        return Theory(-1.0, 0.0, "methods.toml does not tell its bias")
    alpha = statistics["integrator"]["parameters"].get("alpha")
    if alpha is None:
        return Theory(-1.0, 0.0, "its bias vanishes, nothing tells how fast")
    return Theory(-1.0, -(1.0 - alpha) / 2, f"eye paths -1, photons -{alpha:.3g}, bias of edges -{(1 - alpha) / 2:.3g}")
