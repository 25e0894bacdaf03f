"""Rendering time on the CPU against Vulkan: a serial hash with lists against stochastic hashing, and each on both."""

from dataclasses import dataclass
from pathlib import Path

from lab.catalogue import Method, Scene
from lab.figures import downloads
from lab.reports import write_csv
from lab.runs import Run
from lab.sections import Axis, Column, Plot, Section, Series, Table, Verdict
from lab.store import Store
from lab.target import Plan
from parallel_ppm_2010.common import (
    SOURCE,
    STEPS,
    Timing,
    is_software,
    range_of,
    ratio,
    structure_name,
    timed_run,
    timing_of,
)
from parallel_ppm_2010.time_vs_tree import columns_of, draw_figure

# The paper's parts of a pass: it gathers and renders in one.
SERIAL, ALL_THREADS, VULKAN = "CPU, one thread", "CPU, all threads", "Vulkan"


@dataclass(frozen=True)
class Case:
    """A scene and method in a place: on one thread, on all, or on Vulkan."""

    scene: Scene
    method: Method
    place: str
    repeats: int

    def runs(self, plan: Plan) -> list[Run]:
        """Its runs, which differ in nothing but when they are made."""
        backend = "vulkan" if self.place == VULKAN else "cpu"
        threads = {"threads": 1} if self.place == SERIAL else {}
        return [timed_run(plan, self.scene, self.method, backend, repeat=i, **threads) for i in range(self.repeats)]


def cases(plan: Plan) -> list[Case]:
    """Everything that is timed."""
    found = []
    for scene in plan.scenes:
        for method in plan.methods:
            if "cpu" in plan.backends:
                found += [Case(scene, method, place, plan["repeats"]["cpu"]) for place in (SERIAL, ALL_THREADS)]
            if "vulkan" in plan.backends and scene.name in plan["vulkan_scenes"]:
                found.append(Case(scene, method, VULKAN, plan["repeats"]["vulkan"]))
    return found


def runs(plan: Plan) -> list[Run]:
    """Repeats come round after round, so that a slow hour falls on all alike."""
    of_cases = [case.runs(plan) for case in cases(plan)]
    rounds = max((len(one) for one in of_cases), default=0)
    return [one[i] for i in range(rounds) for one in of_cases if i < len(one)]


def comparisons(serial: str, parallel: str) -> list[tuple[str, tuple[str, str], tuple[str, str]]]:
    """What is divided by what: a title, and the method and place of each side. The paper's comparison comes first."""
    found = [("the paper's", (serial, SERIAL), (parallel, VULKAN))]
    for method in (serial, parallel):
        for place in (SERIAL, ALL_THREADS):
            found.append((f"{structure_name(method)} on both", (method, place), (method, VULKAN)))
    found.append(("one thread against all", (serial, SERIAL), (serial, ALL_THREADS)))
    found.append(("the structures on one processor", (serial, ALL_THREADS), (parallel, ALL_THREADS)))
    return found


def ratio_rows(
    measured: dict[tuple[str, str, str], Timing], titles: dict[str, str], serial: str, parallel: str
) -> list[dict]:
    """A row for each comparison and scene of which both sides were measured (by scene, method and place)."""
    rows = []
    for title, slow_side, fast_side in comparisons(serial, parallel):
        for scene, scene_title in titles.items():
            slow, fast = (measured.get((scene, *side)) for side in (slow_side, fast_side))
            if not slow or not fast:
                continue
            row = {"comparison": title, "scene": scene_title}
            row |= {"slow": _side(slow_side), "fast": _side(fast_side)}
            row |= {step: ratio(slow.median(step), fast.median(step)) for step in [*STEPS, "total"]}
            told = "; ".join(one.failed for one in (slow, fast) if one.failed)
            rows.append({**row, "told": told, "runs": slow.runs + fast.runs})
    return rows


def _side(side: tuple[str, str]) -> str:
    return f"{structure_name(side[0])}, {side[1]}"


def verdicts_of(rows: list[dict], device: str, paper: dict[str, float]) -> list[Verdict]:
    """The paper's two ratios: reached in every scene is yes, faster at all is partly; a processor cannot test them."""
    of_paper = [row for row in rows if row["comparison"] == "the paper's"]
    found = []
    for step, goal in paper.items():
        values = [row[step] for row in of_paper if row[step] is not None]
        what = "Construction alone" if step == "construction" else "A pass as a whole"
        measured, why = f"{range_of(values)} as fast", ""
        if not values:
            measured, holds, why = "not measured", "not tested", "no Vulkan device was asked, or none could do it"
        elif is_software(device):
            holds = "not tested"
            why = f"{device} is the processor itself, so no GPU was measured; `--device` takes one"
        else:
            holds = "yes" if min(values) >= goal else "partly" if max(values) > 1.0 else "no"
            why = "" if holds == "yes" else f"{goal} times are not reached in every scene on {device}"
        keys = [key for row in of_paper for key in row["runs"]]
        claim = f"{what} is about {goal} times as fast on a GPU as the serial hash with lists on a CPU"
        found.append(Verdict(claim, measured, holds, why, SOURCE, keys))
    return found


def plots_of(plan: Plan, measured: dict[Case, Timing]) -> list[Plot]:
    """Stacked bars for each scene."""
    plots = []
    for scene in plan.scenes:
        timed = [(case, timing) for case, timing in measured.items() if case.scene.name == scene.name and timing.steps]
        if not timed:
            continue
        names = [f"{structure_name(case.method.name)}, {case.place}" for case, _ in timed]
        settings = [
            f"{case.method.integrator}, {case.method.photon_map}, {scene.resolution}, {timing.passes} passes, "
            f"{case.repeats} runs, {timing.device}"
            for case, timing in timed
        ]
        keys = [timing.runs for _, timing in timed]
        series = []
        for step in STEPS:
            values = [1e3 * timing.median(step) if timing.median(step) is not None else None for _, timing in timed]
            series.append(Series(step, step, names, values, hover=settings, runs=keys))
        plots.append(
            Plot(scene.name, scene.title, Axis("structure and place"), Axis("ms a pass"), series, bars="stack")
        )
    return plots


def time_rows(measured: dict[Case, Timing]) -> list[dict]:
    """A row for each case: milliseconds a pass, medians, and the spread of the whole."""
    rows = []
    for case, timing in measured.items():
        row = {"scene": case.scene.title, "structure": structure_name(case.method.name), "place": case.place}
        for step in [*STEPS, "total"]:
            row[step] = None if timing.median(step) is None else 1e3 * timing.median(step)
        row |= {"low": 1e3 * timing.total[1], "high": 1e3 * timing.total[2]} if timing.total else {}
        rows.append({**row, "repeats": case.repeats, "told": timing.failed, "runs": timing.runs})
    return rows


def report(plan: Plan, store: Store, folder: Path) -> Section:
    """Bars, the ratios, and the paper's two claims."""
    measured = {case: timing_of(store, case.runs(plan)) for case in cases(plan)}
    by_name = {(case.scene.name, case.method.name, case.place): timing for case, timing in measured.items()}
    titles = {scene.name: scene.title for scene in plan.scenes}
    ratios = ratio_rows(by_name, titles, plan["serial"], plan["parallel"])
    devices = [timing.device for case, timing in measured.items() if case.place == VULKAN and timing.device]
    device = devices[0] if devices else store.machine.vulkan
    rows, plots = time_rows(measured), plots_of(plan, measured)
    files = [write_csv(folder / "time_vs_cpu.csv", rows), write_csv(folder / "ratios.csv", ratios)]
    if plots:
        draw_figure(plots, folder, "time_vs_cpu", 2)
        files += downloads("time_vs_cpu", "time of a pass")
    first = [Column("scene", "scene"), Column("structure", "structure"), Column("place", "on")]
    comparing = [
        Column("comparison", "comparison"),
        Column("scene", "scene"),
        Column("slow", "this"),
        Column("fast", "over this"),
    ]
    comparing += [Column(step, step) for step in STEPS] + [Column("total", "a pass"), Column("told", "remarks")]
    return Section(
        plan.name,
        plan["title"],
        plan.experiment,
        text_of(plan, device),
        verdicts_of(ratios, device, plan["paper"]),
        plots,
        tables=[
            Table("ratios", "Ratios of times", comparing, ratios, "Above 1: the second side is faster, so many times."),
            Table(
                "times", "Time of a pass", columns_of(first), rows, "Medians; shortest and longest of the whole pass."
            ),
        ],
        downloads=files,
    )


def text_of(plan: Plan, device: str) -> list[str]:
    """What is compared, and on what."""
    told = [
        f"{plan['passes']} passes of `sppm` with memoryless radii, so that work is equal everywhere. The paper's "
        f"baseline builds and uses a hash with lists on one thread of a CPU: `{structure_name(plan['serial'])}` with "
        f"one thread; its method is `{structure_name(plan['parallel'])}` on Vulkan. What it calls gathering and "
        "rendering is gathering, eye pass and resolve here.",
        "`hash_list` is built by one thread wherever it runs, on Vulkan by one invocation.",
    ]
    if is_software(device):
        told.append(
            f"The Vulkan device here, {device}, is the processor itself: both sides share its cores, and the ratios "
            "say what the shaders' way of computing costs there, not what a GPU gains. On a machine with a GPU "
            "`./dev reproduce time_vs_cpu --device NAME` measures the same on it."
        )
    return told
