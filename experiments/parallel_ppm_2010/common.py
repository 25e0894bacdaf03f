"""What the targets of this experiment share: parameters of methods, and repeated timings."""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np
from lab.catalogue import Scene
from lab.reports import what_failed
from lab.runs import Run
from lab.store import Store
from lab.target import Plan

SOURCE = "Hachisuka and Jensen, Parallel Progressive Photon Mapping on GPUs (SIGGRAPH Asia 2010 sketch)"
# A pass in the paper's parts: the phases of `render --stats` that each is made of.
STEPS = {
    "photon tracing": ("photon_tracing",),
    "construction": ("construction",),
    "gathering": ("gathering", "final_gather"),
    "eye pass and resolve": ("eye_pass", "resolve"),
}


def with_parameters(words: str, **parameters) -> str:
    """An integrator or photon map as the command line has it, with more parameters."""
    for key, value in parameters.items():
        words += f"{',' if ':' in words else ':'}{key}={value}"
    return words


def is_software(device: str) -> bool:
    """Whether a Vulkan device is the processor itself, by its name."""
    return any(word in device.lower() for word in ("llvmpipe", "lavapipe", "swiftshader"))


@dataclass
class Timing:
    """Seconds a pass over repeats of one run: (median, smallest, largest) of the whole and of each step."""

    runs: list[str]
    failed: str = ""
    device: str = ""
    passes: int = 0
    total: tuple[float, float, float] | None = None
    steps: dict[str, tuple[float, float, float]] = field(default_factory=dict)

    def median(self, step: str) -> float | None:
        """Of a step, or of "total"; None where it is not known."""
        told = self.total if step == "total" else self.steps.get(step)
        return told[0] if told else None


def timing_of(store: Store, runs: list[Run]) -> Timing:
    """The timing of runs that differ in `repeat` alone."""
    records = [store.record(run) for run in runs]
    timing = Timing([store.key(run) for run in runs], next(filter(None, map(what_failed, records)), ""))
    statistics = [record["statistics"] for record in records if "statistics" in record]
    if not statistics:
        return timing
    timing.device, timing.passes = statistics[0]["device"], statistics[0]["passes"]
    timing.total = _spread([one["wall_s"] / one["passes"] for one in statistics])
    for step, phases in STEPS.items():
        seconds = [_seconds(one, phases) for one in statistics]
        if None not in seconds:
            timing.steps[step] = _spread(seconds)
    return timing


def _seconds(statistics: dict, phases: tuple[str, ...]) -> float | None:
    told = [statistics["phases"][name] for name in phases if (statistics.get("phases") or {}).get(name) is not None]
    return sum(told) / statistics["passes"] if told else None


def _spread(values: list[float]) -> tuple[float, float, float]:
    return float(np.median(values)), min(values), max(values)


def ratio(slow: float | None, fast: float | None) -> float | None:
    """How many times as long; None where either is not known."""
    return slow / fast if slow is not None and fast else None


def times(value: float | None) -> str:
    """A ratio in words."""
    return "not known" if value is None else f"{value:.3g} times"


def range_of(values: Iterable[float | None]) -> str:
    """From the smallest to the largest ratio, in words."""
    known = [value for value in values if value is not None]
    if not known:
        return "not known"
    low, high = f"{min(known):.3g}", f"{max(known):.3g}"
    return f"{low} times" if low == high else f"{low} to {high} times"


def structure_name(method_name: str) -> str:
    """The structure of INTEGRATOR+STRUCTURE."""
    return method_name.partition("+")[2]


def timed_run(plan: Plan, scene: Scene, method, backend: str, **changes) -> Run:
    """A run whose time counts, of a few passes of equal work: radii shrink by the number of the pass alone.

    Targets that ask for the same scene, method and backend share it.
    """
    sized = replace(scene, photons=plan["photons"])
    run = plan.run(sized, method, backend, passes=plan["passes"], measures_time=True, **changes)
    return run.but(integrator=with_parameters(run.integrator, schedule="memoryless"))
