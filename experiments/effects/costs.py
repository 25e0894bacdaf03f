"""What each effect costs: scenes that differ in one effect only, with it and without it, on both backends.

The time of a sample is the number of its rays times the time of a ray, so that what more rays cost and what an effect's
code costs are told apart.
"""

import csv
import statistics
from dataclasses import dataclass, field
from pathlib import Path

from lab.figures import downloads, draw, figure, palette
from lab.images import Gallery
from lab.runs import Run
from lab.sections import Axis, Column, Download, Plot, Section, Series, Table, Verdict, Viewer
from lab.store import Store
from lab.target import Plan

SCENES = "experiments/effects/scenes"
BACKENDS = {"cpu": "CPU", "vulkan": "Vulkan"}
SOURCE = "docs/describe.md"


@dataclass(frozen=True)
class Spread:
    """A median of repeats, and how far they spread."""

    median: float
    low: float
    high: float

    @staticmethod
    def of(values: list[float]) -> "Spread":
        """Of the repeats' values."""
        return Spread(statistics.median(values), min(values), max(values))

    def over(self, other: "Spread") -> "Spread":
        """The ratio of two that were measured apart: its ends take the opposite ends of both."""
        return Spread(self.median / other.median, self.low / other.high, self.high / other.low)


@dataclass
class Cost:
    """What one scene costs on one backend."""

    name: str
    backend: str
    keys: list[str]
    failed: str = ""
    sample_ns: Spread | None = None
    ray_ns: Spread | None = None
    rays: float = 0.0  # per sample
    spirv_bytes: int = 0
    compile_s: float = 0.0
    effects: list[str] = field(default_factory=list)
    settings: str = ""


@dataclass
class Pair:
    """A scene with an effect, and the one without."""

    effect: str
    what: str
    present: Cost
    absent: Cost

    @property
    def keys(self) -> list[str]:
        """Of the runs behind it."""
        return self.present.keys + self.absent.keys

    @property
    def known(self) -> bool:
        """Whether both were measured."""
        return not (self.present.failed or self.absent.failed)

    @property
    def besides(self) -> list[str]:
        """What else the scene with the effect asks for and the one without does not."""
        return [one for one in self.present.effects if one not in {self.effect, *self.absent.effects}]


def names_on(plan: Plan, backend: str) -> list[str]:
    """The variants that are measured on a backend, without those that they are compared with."""
    names = [one["name"] for one in plan["variants"]]
    if backend == "vulkan" and "*" not in plan["on_vulkan"]:
        names = [one for one in names if one in plan["on_vulkan"]]
    return names


def scene_runs(plan: Plan, name: str, backend: str) -> list[Run]:
    """The repeats of one scene on one backend."""
    run = Run(
        scene=f"{SCENES}/{name}.pbrt",
        integrator=plan.methods[0].integrator,
        backend=backend,
        device=plan.device if backend == "vulkan" else "",
        resolution=plan["resolution"],
        spp=plan["spp"][backend],
        measures_time=True,
    )
    return [run.but(repeat=repeat) for repeat in range(plan["repeats"])]


def runs(plan: Plan) -> list[Run]:
    """Every variant and what it is compared with, on every backend: all of them once, then all again."""
    chosen = []
    for backend in plan.backends:
        wanted = names_on(plan, backend)
        names = [plan["base"], *(one["without"] for one in plan["variants"] if one["name"] in wanted), *wanted]
        of_backend = [scene_runs(plan, name, backend) for name in dict.fromkeys(names)]
        chosen += [run for repeats in zip(*of_backend, strict=True) for run in repeats]
    return chosen


def cost_of(plan: Plan, store: Store, name: str, backend: str) -> Cost:
    """What the runs of a scene say."""
    made = scene_runs(plan, name, backend)
    records = [store.record(run) for run in made]
    cost = Cost(name, backend, [store.key(run) for run in made])
    failed = [one["failed"].strip().splitlines() for one in records if "failed" in one]
    if failed:
        cost.failed = failed[0][-1] if failed[0] else "failed"
        return cost
    told = [one["statistics"] for one in records]
    cost.sample_ns = Spread.of([1e9 * one["wall_s"] / one["samples"] for one in told])
    cost.ray_ns = Spread.of([1e9 * one["wall_s"] / one["rays"] for one in told])
    cost.rays = told[0]["rays"] / told[0]["samples"]
    cost.spirv_bytes = sum(told[0]["spirv_bytes"].values())
    cost.compile_s = statistics.median(one["setup_s"]["compile"] for one in told)
    cost.effects = [one["name"] for one in told[0]["effects"]]
    size = "x".join(map(str, told[0]["resolution"]))
    cost.settings = f"{size} pixels, {told[0]['samples_per_pixel']:g} samples each, {told[0]['device']}"
    return cost


def pairs_of(plan: Plan, store: Store, backend: str) -> list[Pair]:
    """Every effect on a backend."""
    wanted = names_on(plan, backend)
    variants = [one for one in plan["variants"] if one["name"] in wanted]
    names = dict.fromkeys([one[word] for one in variants for word in ("name", "without")])
    costs = {name: cost_of(plan, store, name, backend) for name in names}
    return [Pair(one["name"], one["what"], costs[one["name"]], costs[one["without"]]) for one in variants]


def row_of(pair: Pair) -> dict:
    """A line of the table and of the data."""
    present, absent = pair.present, pair.absent
    row = {"effect": pair.effect, "without": absent.name, "what": pair.what, "runs": pair.keys}
    if not pair.known:
        return row | {"besides": f"not measured: {present.failed or absent.failed}"}
    sample, ray = present.sample_ns.over(absent.sample_ns), present.ray_ns.over(absent.ray_ns)
    return row | {
        "besides": ", ".join(pair.besides),
        "sample_ns": present.sample_ns.median,
        "sample_ratio": sample.median,
        "sample_spread": f"{sample.low:.2f} to {sample.high:.2f}",
        "rays": present.rays,
        "rays_ratio": present.rays / absent.rays,
        "ray_ns": present.ray_ns.median,
        "ray_ratio": ray.median,
        "ray_spread": f"{ray.low:.2f} to {ray.high:.2f}",
        "spirv_kb": present.spirv_bytes / 1e3 if present.spirv_bytes else None,
        "spirv_more_kb": (present.spirv_bytes - absent.spirv_bytes) / 1e3 if absent.spirv_bytes else None,
        "compile_s": present.compile_s if present.spirv_bytes else None,
    }


def table_of(backend: str, rows: list[dict]) -> Table:
    """Of one backend."""
    columns = [
        Column("effect", "effect"),
        Column("what", "the scene with it has"),
        Column("without", "compared with"),
        Column("besides", "also asks for"),
        Column("sample_ns", "time per sample", "ns"),
        Column("sample_ratio", "times that without"),
        Column("sample_spread", "spread"),
        Column("rays", "rays per sample"),
        Column("rays_ratio", "times those without"),
        Column("ray_ns", "time per ray", "ns"),
        Column("ray_ratio", "times that without"),
        Column("ray_spread", "spread"),
    ]
    if backend == "vulkan":
        columns += [
            Column("spirv_kb", "SPIR-V", "kB"),
            Column("spirv_more_kb", "more than without", "kB"),
            Column("compile_s", "compiling, driver's cache warm", "s"),
        ]
    return Table(
        f"costs-{backend}",
        f"Each effect on {BACKENDS[backend]}",
        columns,
        rows,
        "Medians of repeats; a spread is from the smallest with over the largest without to the largest with over the "
        "smallest without.",
    )


def plot_of(backend: str, pairs: list[Pair]) -> Plot | None:
    """Bars of an effect's ratios, the costliest first."""
    known = [one for one in pairs if one.known]
    if not known:
        return None
    known.sort(key=lambda one: -one.present.sample_ns.median / one.absent.sample_ns.median)
    kinds = {
        "time per sample": lambda one: one.present.sample_ns.over(one.absent.sample_ns),
        "rays per sample": lambda one: Spread.of([one.present.rays / one.absent.rays]),
        "time per ray": lambda one: one.present.ray_ns.over(one.absent.ray_ns),
    }
    series = []
    for kind, ratio in kinds.items():
        ratios = [ratio(one) for one in known]
        series.append(
            Series(
                kind,
                kind,
                [one.effect for one in known],
                [one.median for one in ratios],
                [one.low for one in ratios],
                [one.high for one in ratios],
                [
                    f"{one.effect} over {one.absent.name}: {kind} x {of.median:.2f} ({of.low:.2f} to {of.high:.2f}); "
                    f"{one.present.settings}"
                    for one, of in zip(known, ratios, strict=True)
                ],
                [one.keys for one in known],
            )
        )
    return Plot(
        f"ratios-{backend}",
        f"{BACKENDS[backend]}: with an effect over without it",
        Axis(""),
        Axis("ratio"),
        series,
        "group",
        "The time per sample is the rays per sample times the time per ray.",
    )


def code_verdict(pairs: list[Pair], base: str) -> Verdict:
    """Does a shader grow with each effect, and is it smallest where none is asked for?"""
    claim = "A scene's shader holds the code of the effects that it asks for, and of no others"
    known = [one for one in pairs if one.known and one.present.spirv_bytes and one.absent.spirv_bytes]
    if not known:
        return Verdict(claim, "no shader was compiled", "not tested", source=SOURCE)
    sizes = {cost.name: cost.spirv_bytes for one in known for cost in (one.present, one.absent)}
    grown = [one for one in known if one.present.spirv_bytes > one.absent.spirv_bytes]
    least = min(sizes.values())
    base_least = sizes.get(base) == least
    largest = max(sizes, key=sizes.get)
    measured = f"{len(grown)} of {len(known)} effects make the shader larger than it is without them. "
    if base in sizes:
        measured += f"The base's has {sizes[base] / 1e3:.0f} kB"
        measured += ", the least of all" if base_least else f", the least {least / 1e3:.0f} kB"
        measured += f"; {largest}'s has {sizes[largest] / 1e3:.0f} kB"
    why = [f"{one.effect} makes it no larger" for one in known if one not in grown]
    if not base_least:
        why.append("the base's is not the smallest")
    holds = "yes" if not why else "partly" if 2 * len(grown) >= len(known) else "no"
    return Verdict(claim, measured, holds, "; ".join(why), SOURCE, [key for one in known for key in one.keys])


def time_verdict(backend: str, pairs: list[Pair]) -> Verdict:
    """Is a ray no slower where less is asked for?"""
    claim = f"{BACKENDS[backend]}: a ray takes no longer in a scene that does without an effect than in one that has it"
    known = [one for one in pairs if one.known]
    if not known:
        return Verdict(claim, "nothing was measured", "not tested", source=SOURCE)
    ratios = {one.effect: one.present.ray_ns.over(one.absent.ray_ns) for one in known}
    if all(ratio.low == ratio.high for ratio in ratios.values()):
        return Verdict(claim, "one repeat has no spread", "not tested", source=SOURCE)
    faster = [name for name, ratio in ratios.items() if ratio.high < 1.0]
    slower = [name for name, ratio in ratios.items() if ratio.low > 1.0]
    most = max(ratios, key=lambda name: ratios[name].median)
    measured = (
        f"Of {len(known)} effects {len(slower)} make a ray slower beyond the repeats' spread, {len(faster)} faster, "
        f"and {len(known) - len(slower) - len(faster)} cannot be told from nothing. "
        f"Most: {most}, x {ratios[most].median:.2f}"
    )
    why = ""
    if faster:
        shown = ", ".join(f"{name} (x {ratios[name].median:.2f})" for name in faster)
        why = f"Rays are faster with {shown}: their scenes send other rays, which may be cheaper to trace"
    holds = "yes" if not faster else "partly" if 5 * len(faster) <= len(known) else "no"
    return Verdict(claim, measured, holds, why, SOURCE, [key for one in known for key in one.keys])


def write_data(file: Path, rows: dict[str, list[dict]]) -> Download:
    """The tables as one CSV; the runs' keys are in its last column."""
    columns = ["backend", *dict.fromkeys(key for lines in rows.values() for line in lines for key in line)]
    columns = [one for one in columns if one != "runs"] + ["runs"]
    with file.open("w", newline="") as out:
        writer = csv.DictWriter(out, columns)
        writer.writeheader()
        for backend, lines in rows.items():
            for line in lines:
                writer.writerow({"backend": backend, **line, "runs": " ".join(line["runs"])})
    return Download(file.name, "data (CSV)")


def viewer_of(plan: Plan, store: Store, folder: Path, backend: str) -> Viewer | None:
    """The scenes themselves, as one backend renders them."""
    gallery = Gallery(store, folder)
    names = dict.fromkeys([plan["base"], *names_on(plan, backend)])
    made = {name: scene_runs(plan, name, backend)[0] for name in names}
    images = [gallery.of_run(name, name, run) for name, run in made.items() if "failed" not in store.record(run)]
    return Viewer("scenes", "The scenes", images) if images else None


def draw_bars(axes, plot: Plot, looks: dict[str, dict]) -> None:
    """The page's plot, with the spreads of its bars."""
    draw(axes, plot, looks)
    for series, bars in zip(plot.series, axes.containers, strict=True):
        middles = [bar.get_x() + bar.get_width() / 2 for bar in bars]
        axes.vlines(middles, series.low, series.high, color="#222222", linewidth=0.5)
    axes.axhline(1.0, color="#222222", linewidth=0.6)
    axes.set_ylim(0.0, 1.2 * max(high for series in plot.series for high in series.high))
    axes.tick_params(axis="x", labelsize=5.5)
    axes.legend(fontsize=6, ncols=len(plot.series), loc="upper right")


def report(plan: Plan, store: Store, folder: Path) -> Section:
    """A table, bars and a verdict for each backend; the size of shaders; the scenes."""
    pairs = {backend: pairs_of(plan, store, backend) for backend in plan.backends}
    rows = {backend: [row_of(one) for one in of_backend] for backend, of_backend in pairs.items()}
    plots = [plot for backend, of_backend in pairs.items() if (plot := plot_of(backend, of_backend))]
    files = [write_data(folder / "costs.csv", rows)]
    if plots:
        looks = palette(series.method for series in plots[0].series)
        with figure(folder, "costs", (7.2, 3.1 * len(plots)), len(plots)) as (_, axes):
            for place, plot in zip(axes.flat, plots, strict=True):
                draw_bars(place, plot, looks)
        files += downloads("costs", "figure")
    viewer = viewer_of(plan, store, folder, plan.backends[0]) if plan.backends else None
    verdicts = [code_verdict(pairs.get("vulkan", []), plan["base"])]
    verdicts += [time_verdict(backend, of_backend) for backend, of_backend in pairs.items()]
    left = len(plan["variants"]) - len(names_on(plan, "vulkan"))
    text = [
        "A ball in a box under a square lamp: each scene has one effect more than the one it is compared with, by "
        f"`path`, {plan['repeats']} repeats. Where an effect does not come alone, the table says what comes with it.",
        "On Vulkan a shader is compiled for exactly the effects of a scene; on the CPU the smallest of a kernel's "
        "prebuilt sets that has them runs, which the statistics do not name: a ratio there holds what the step to a "
        "larger set costs, too (docs/performance.md counts its instructions).",
    ]
    if left and "vulkan" in plan.backends:
        text.append(
            f"{left} of the effects are measured on Vulkan with `--full` only: compiling their shaders takes longer."
        )
    return Section(
        plan.name,
        plan["title"],
        plan.experiment,
        text,
        verdicts,
        plots,
        [viewer] if viewer else [],
        [table_of(backend, lines) for backend, lines in rows.items()],
        files,
    )
