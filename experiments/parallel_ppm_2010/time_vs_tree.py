"""Rendering time of each scene: stochastic hashing against kd-tree, BVH and every other structure, its parts apart."""

from dataclasses import dataclass
from pathlib import Path

from lab.catalogue import Method, Scene
from lab.figures import downloads, draw, figure, palette
from lab.reports import judge, write_csv
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


@dataclass
class Case:
    """A scene, backend and method, and how often it is timed."""

    scene: Scene
    backend: str
    method: Method
    repeats: int

    def runs(self, plan: Plan) -> list[Run]:
        """Its runs, which differ in nothing but when they are made."""
        return [timed_run(plan, self.scene, self.method, self.backend, repeat=i) for i in range(self.repeats)]


def cases(plan: Plan) -> list[Case]:
    """Everything that is timed. Vulkan runs are fewer where the table says so: a processor makes them slowly."""
    compared = {plan["shown"], *plan["trees"]}
    repeats = plan["repeats"]
    found = []
    for backend in plan.backends:
        on_vulkan = backend == "vulkan"
        scenes = [one for one in plan.scenes if not on_vulkan or one.name in plan["vulkan_scenes"]]
        for scene in scenes:
            for method in plan.catalogue.methods(plan["vulkan_methods"]) if on_vulkan else plan.methods:
                of_cpu = repeats["compared" if method.name in compared else "others"]
                found.append(Case(scene, backend, method, repeats["vulkan"] if on_vulkan else of_cpu))
    return found


def runs(plan: Plan) -> list[Run]:
    """Repeats come round after round, so that a slow hour falls on all alike."""
    of_cases = [case.runs(plan) for case in cases(plan)]
    rounds = max((len(one) for one in of_cases), default=0)
    return [one[i] for i in range(rounds) for one in of_cases if i < len(one)]


def rows_of(measured: list[tuple[Case, Timing]]) -> list[dict]:
    """A row for each case: milliseconds a pass, medians, and the spread of the whole."""
    rows = []
    for case, timing in measured:
        row = {"scene": case.scene.title, "backend": case.backend, "structure": structure_name(case.method.name)}
        row |= {step: _milliseconds(timing.median(step)) for step in [*STEPS, "total"]}
        low, high = timing.total[1:] if timing.total else (None, None)
        row |= {"low": _milliseconds(low), "high": _milliseconds(high), "repeats": case.repeats}
        rows.append({**row, "told": timing.failed, "runs": timing.runs})
    return rows


def _milliseconds(seconds: float | None) -> float | None:
    return None if seconds is None else 1e3 * seconds


def ratios(measured: list[tuple[Case, Timing]], backend: str, shown: str, tree: str, step: str) -> list[float]:
    """Time of a step with a tree over that with `shown`, for each scene in which both are known."""
    of = {(case.scene.name, case.method.name): timing for case, timing in measured if case.backend == backend}
    scenes = dict.fromkeys(scene for scene, _ in of)
    unknown = Timing([])
    found = [
        ratio(of.get((scene, tree), unknown).median(step), of.get((scene, shown), unknown).median(step))
        for scene in scenes
    ]
    return [one for one in found if one is not None]


def verdicts_of(measured: list[tuple[Case, Timing]], shown: str, trees: list[str]) -> list[Verdict]:
    """For each backend: are construction and gathering faster than with trees in every scene, and is the whole?"""
    found = []
    for backend in dict.fromkeys(case.backend for case, _ in measured):
        keys = [
            key
            for case, timing in measured
            if case.backend == backend and case.method.name in {shown, *trees}
            for key in timing.runs
        ]
        for claim, steps in [
            (
                "Construction and gathering are faster with stochastic hashing than with a tree",
                ["construction", "gathering"],
            ),
            ("Rendering as a whole is faster with stochastic hashing than with a tree", ["total"]),
        ]:
            told, passed = [], []
            for tree in trees:
                for step in steps:
                    of_scenes = ratios(measured, backend, shown, tree, step)
                    passed += [one > 1.0 for one in of_scenes]
                    told.append(f"{structure_name(tree)}, {step}: {range_of(of_scenes)}")
            failed = sum(not one for one in passed)
            why = f"{failed} of {len(passed)} medians are not above 1" if failed else ""
            measured_text = "Time over that of stochastic hashing, " + "; ".join(told)
            found.append(Verdict(f"{claim} ({backend})", measured_text, judge(passed), why, SOURCE, keys))
    return found


def plots_of(plan: Plan, measured: list[tuple[Case, Timing]]) -> list[Plot]:
    """Stacked bars for each scene and backend."""
    plots = []
    for backend in plan.backends:
        for scene in plan.scenes:
            chosen = [one for one in measured if one[0].backend == backend and one[0].scene.name == scene.name]
            timed = [(case, timing) for case, timing in chosen if timing.steps]
            if not timed:
                continue
            names = [structure_name(case.method.name) for case, _ in timed]
            settings = [
                f"{case.method.integrator}, {case.method.photon_map}, {scene.resolution}, {timing.passes} passes, "
                f"{case.repeats} runs"
                for case, timing in timed
            ]
            keys = [timing.runs for _, timing in timed]
            series = [
                Series(step, step, names, [_milliseconds(t.median(step)) for _, t in timed], hover=settings, runs=keys)
                for step in STEPS
            ]
            title = f"{scene.title}, {backend}"
            plots.append(
                Plot(f"{scene.name}-{backend}", title, Axis("structure"), Axis("ms a pass"), series, bars="stack")
            )
    return plots


def draw_figure(plots: list[Plot], folder: Path, name: str, columns: int) -> None:
    """The plots side by side, with one legend."""
    rows = -(-len(plots) // columns)
    with figure(folder, name, (3.0 * columns + 1.0, 2.4 * rows), rows, columns) as (drawn, axes):
        for one in axes.flat[len(plots) :]:
            one.set_axis_off()
        for one, plot in zip(axes.flat, plots, strict=False):
            draw(one, plot, palette(STEPS))
            one.tick_params(axis="x", labelsize=6)
        handles, labels = axes[0, 0].get_legend_handles_labels()
        drawn.legend(handles, labels, loc="outside upper center", ncols=len(STEPS), fontsize=7)


def columns_of(first: list[Column]) -> list[Column]:
    """The columns of a table of timings."""
    steps = [Column(step, step, "ms") for step in STEPS]
    spread = [Column("low", "shortest", "ms"), Column("high", "longest", "ms"), Column("repeats", "runs")]
    return [*first, *steps, Column("total", "a pass", "ms"), *spread, Column("told", "remarks")]


def report(plan: Plan, store: Store, folder: Path) -> Section:
    """Bars, the table behind them, and verdicts for each backend."""
    measured = [(case, timing_of(store, case.runs(plan))) for case in cases(plan)]
    rows, plots = rows_of(measured), plots_of(plan, measured)
    files = [write_csv(folder / "time_vs_tree.csv", rows)]
    if plots:
        draw_figure(plots, folder, "time_vs_tree", 2)
        files += downloads("time_vs_tree", "time of a pass")
    text = [
        f"{plan['passes']} passes of `sppm` with memoryless radii, so that every structure answers the same queries; "
        "medians of the runs, a pass each. Tracing photons is the same work for all of them.",
        "`splat` is built over the hit points, and looks photons up when it gathers.",
    ]
    devices = {timing.device for case, timing in measured if case.backend == "vulkan" and timing.device}
    if any(is_software(device) for device in devices):
        text.append(
            f"The Vulkan device ({', '.join(devices)}) is the processor itself: its figures are not those of a GPU."
        )
    first = [Column("scene", "scene"), Column("backend", "backend"), Column("structure", "structure")]
    return Section(
        plan.name,
        plan["title"],
        plan.experiment,
        text,
        verdicts_of(measured, plan["shown"], plan["trees"]),
        plots,
        tables=[
            Table(
                "times", "Time of a pass", columns_of(first), rows, "Medians; shortest and longest of the whole pass."
            )
        ],
        downloads=files,
    )
