"""Bias and variance of memoryless progressive photon mapping apart, on a smooth region and over a whole image."""

import json
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path

import numpy as np
from accuracy.panels import panels
from accuracy.theory import bias_limit, edge_limit, point_light_parts, variance_limit
from lab.figures import downloads
from lab.images import read_exr
from lab.runs import Run
from lab.sections import Axis, Column, Download, Plot, Section, Series, Table, Verdict
from lab.statistics import CONFIDENCE, Interval, error_parts, jackknife, log_slope, misses_by_chance
from lab.store import Store
from lab.target import Plan

SOURCE = "Knaus and Zwicker 2011; Kaplanyan and Dachsbacher 2013"
PARTS = {"variance": "variance", "bias_squared": "bias^2", "total": "relMSE"}


@dataclass
class Measured:
    """One method at one alpha on one region."""

    region: str  # "smooth" or "whole"
    method: str
    label: str
    backend: str
    alpha: float
    passes: list[int]
    parts: dict[str, list[float]]  # variance, bias_squared, total: after each of the passes
    levels: dict[str, list[Interval]]  # the same with their confidence
    slopes: dict[str, Interval]
    expected: dict[str, list[float]]  # what theory says of these very passes; only where the region is smooth
    keys: list[list[str]]  # for each of the passes
    truth: str  # the key of the truth's run

    @property
    def place(self) -> str:
        """For titles and rows."""
        return f"{self.label}, {self.backend}, alpha = {self.alpha:.3g}"


def runs(plan: Plan) -> list[Run]:
    """The truth of both regions, and the images of all seeds after each number of passes."""
    found = []
    for region in ("smooth", "whole"):
        found.append(truth_run(plan, region))
        for _, _, of in _regions(plan, region):
            found += [run for seeds in of.values() for run in seeds]
    return found


def truth_run(plan: Plan, region: str) -> Run:
    """By path tracing, which is independent of photons. Under a point light it has no noise."""
    table = plan[region]
    integrator = "path:maxdepth=1" if region == "smooth" else "path"
    return _base(table, integrator).but(passes=None, spp=table.get("truth_spp", 4), seed=8001)


def _regions(plan: Plan, region: str):
    """(method, backend), alpha, and the runs of each number of passes."""
    table = plan[region]
    words = f"schedule=memoryless,direct=photons,photonsperiteration={table['photons']}"
    words += f",maxdepth=1,radius={table['radius']}" if region == "smooth" else ""
    count = table.get("seeds", plan["seeds"])
    for method in plan.methods:
        for backend in plan.backends:
            for i, alpha in enumerate(table.get("alphas", plan["alphas"])):
                integrator = f"{method.integrator.partition(':')[0]}:{words},alpha={alpha}"
                base = _base(table, integrator).but(
                    photon_map=method.photon_map,
                    plugins=method.plugins,
                    backend=backend,
                    device=plan.device if backend == "vulkan" else "",
                )
                # Seeds of their own for each alpha, so that what chance does to one says nothing of the others.
                seeds = [1 + i * count + k for k in range(count)]
                passes = table.get("passes", plan["passes"])
                yield (method, backend), alpha, {n: [base.but(passes=n, seed=one) for one in seeds] for n in passes}


def _base(table: dict, integrator: str) -> Run:
    """A run of a region, of one pass."""
    place = {"scene": table["file"], "resolution": table["resolution"], "crop": table.get("crop", "")}
    return Run(**place, integrator=integrator, passes=1)


def measure(plan: Plan, store: Store, region: str) -> list[Measured]:
    """Read the images of a region."""
    run = truth_run(plan, region)
    truth = read_exr(store.image(run)).astype(np.float64)
    table, found = plan[region], []
    # Relative errors where the truth is exact and bright; relMSE's weight for a whole image, which has dark parts.
    weight = 1 / truth**2 if region == "smooth" else 1 / (truth**2 + 0.01)
    noise = 0.0 if region == "smooth" else store.record(run)["statistics"]["estimated_error"] or 0.0
    for (method, backend), alpha, of in _regions(plan, region):
        images = np.array([[read_exr(store.image(one)) for one in seeds] for seeds in of.values()], dtype=np.float64)
        passes = list(of)
        by_seed = images.swapaxes(0, 1)  # seeds first: one at a time is left out
        parts, levels, slopes = {}, {}, {}
        for part in PARTS:
            of_seeds = partial(part_of, truth=truth, weight=weight, noise=noise, part=part)
            parts[part] = of_seeds(by_seed)
            levels[part] = [jackknife(lambda s, of=of_seeds, i=i: of(s)[i], by_seed) for i in range(len(passes))]
            slopes[part] = jackknife(lambda seeds, of=of_seeds, at=passes: log_slope(at, of(seeds)), by_seed)
        expected = expected_parts(truth.shape[:2], passes, alpha, table) if region == "smooth" else {}
        keys = [[store.key(one) for one in seeds] for seeds in of.values()]
        case = (region, method.name, method.label, backend, alpha, passes)
        found.append(Measured(*case, parts, levels, slopes, expected, keys, store.key(run)))
    return found


def part_of(seeds: np.ndarray, truth: np.ndarray, weight: np.ndarray, noise: float, part: str) -> list[float]:
    """Variance, squared bias or their sum after each number of passes; the truth's own noise is taken off the bias."""
    found = [error_parts(seeds[:, i], truth, weight) for i in range(seeds.shape[1])]
    variance = np.array([one.variance for one in found])
    bias = np.array([one.bias_squared for one in found]) - noise
    return {"variance": variance, "bias_squared": bias, "total": variance + bias}[part].tolist()


def expected_parts(shape: tuple, passes: list[int], alpha: float, table: dict) -> dict[str, list[float]]:
    """Theory's, over pixels at their distances from the light's foot."""
    distance = distances(shape, table["foot"]).ravel()
    radius, height = table["radius"], table["height"]
    bias, variance = point_light_parts(distance, passes, alpha, radius, height, table["photons"])
    return {"variance": variance.tolist(), "bias_squared": bias.tolist(), "total": (bias + variance).tolist()}


def distances(shape: tuple, foot: list[float]) -> np.ndarray:
    """Of pixels from the light's foot, in a picture that shows -1 to 1 both ways, upwards and to the right."""
    rows, columns = (2 * (np.arange(count) + 0.5) / count - 1 for count in shape)
    return np.hypot(columns[None, :] - foot[0], -rows[:, None] - foot[1])


def report(plan: Plan, store: Store, folder: Path) -> Section:
    """Read the images; write figures and data."""
    smooth, whole = measure(plan, store, "smooth"), measure(plan, store, "whole")
    section = Section(plan.name, plan["title"], plan.experiment)
    section.text = [
        "Memoryless radii, so that passes are independent; all light by photons. Variance is over seeds; squared bias "
        "is the squared distance of their mean from the truth, less the mean's own variance. The smooth region is a "
        "floor under a point light, where no disk of a look-up reaches an edge, and errors are relative; its truth is "
        "path tracing, which has no noise there. The whole image has corners, a ball and its shadow, and relMSE's "
        "weights.",
        f"Intervals are Student's over seeds, by the jackknife ({CONFIDENCE:.0%}). `These passes` is what theory says "
        "of the sums over the passes that were fitted; it tends to the limit.",
    ]
    section.verdicts = [_smooth_verdict(smooth), _level_verdict(smooth), _whole_verdict(whole)]
    section.tables = [_table(smooth, "smooth", "On a smooth region"), _table(whole, "whole", "Over a whole image")]
    section.plots = [_plot(one) for one in smooth + whole]
    panels(folder, "slopes", section.plots, looks=LOOKS)
    plain = [asdict(one) for one in smooth + whole]
    (folder / "slopes.json").write_text(json.dumps(plain, indent=1) + "\n")
    section.downloads = [*downloads("slopes", "Bias and variance"), Download("slopes.json", "All numbers (JSON)")]
    return section


LOOKS = {
    "variance": {"color": "#0072B2", "marker": "o"},
    "bias^2": {"color": "#D55E00", "marker": "s"},
    "relMSE": {"color": "#009E73", "marker": "^"},
    "theory": {"color": "#222222", "marker": "none"},
}


def _plot(one: Measured) -> Plot:
    series = []
    for part, name in PARTS.items():
        y = [value if value > 0.0 else None for value in one.parts[part]]
        hover = [f"{one.place}, {n} passes, {len(keys)} seeds" for n, keys in zip(one.passes, one.keys, strict=True)]
        label = f"{name}: {one.slopes[part].text()}"
        series.append(Series(label, name, one.passes, y, hover=hover, runs=[[*keys, one.truth] for keys in one.keys]))
        if part != "total" and one.expected:
            series.append(Series(f"{name}, theory", "theory", one.passes, one.expected[part], style="dash"))
    if not one.expected:
        start = one.parts["bias_squared"][0]
        guide = [start * (n / one.passes[0]) ** edge_limit(one.alpha) for n in one.passes]
        series.append(Series(f"-(1-a)/2 = {edge_limit(one.alpha):.2f}", "theory", one.passes, guide, style="dash"))
    title = f"{'Smooth region' if one.region == 'smooth' else 'Whole image'}: {one.place}"
    y = Axis("relative squared error" if one.region == "smooth" else "relMSE", True)
    identifier = f"slopes-{one.region}-{one.method}-{one.backend}-{one.alpha:.3f}"
    return Plot(identifier, title, Axis("passes", True), y, series)


def _table(measured: list[Measured], name: str, title: str) -> Table:
    columns = [Column("method", "method"), Column("backend", "backend"), Column("alpha", "alpha")]
    columns += [Column("part", "part"), Column("slope", "fitted slope")]
    columns += [Column("finite", "theory, these passes"), Column("limit", "theory, limit")]
    columns += [Column("first", "after the fewest passes"), Column("last", "after the most")]
    rows = []
    for one in measured:
        limits = {"variance": variance_limit(one.alpha)}
        limits["bias_squared"] = (bias_limit if one.expected else edge_limit)(one.alpha)
        limits["total"] = max(limits.values())
        for part, shown in PARTS.items():
            finite = log_slope(one.passes, one.expected[part]) if one.expected else None
            row = {"method": one.label, "backend": one.backend, "alpha": one.alpha, "part": shown, "finite": finite}
            row |= {"slope": one.slopes[part].text(3), "limit": limits[part]}
            row |= {"first": one.parts[part][0], "last": one.parts[part][-1]}
            rows.append(row | {"runs": [key for keys in one.keys for key in keys] + [one.truth]})
    return Table(name, title, columns, rows)


def _smooth_verdict(measured: list[Measured]) -> Verdict:
    claim = "Where radiance is smooth, variance falls as n^-a and squared bias as n^-(2-2a)."
    checked = [
        (one, part, one.slopes[part], log_slope(one.passes, one.expected[part]))
        for one in measured
        for part in ("variance", "bias_squared")
    ]
    known = [row for row in checked if np.isfinite(row[2].low)]
    if not known:
        return Verdict(claim, "Too few seeds for an interval.", "not tested", source=SOURCE)
    missed = [row for row in known if not row[2].holds(row[3])]
    allowed = misses_by_chance(len(known))
    holds = "yes" if len(missed) <= allowed else "partly" if 2 * len(missed) <= len(known) else "no"
    widest = max((row[2].high - row[2].low) / 2 for row in known)
    text = (
        f"{len(known) - len(missed)} of {len(known)} fitted slopes agree with those of the same finite sums within "
        f"their {CONFIDENCE:.0%} intervals, the widest +- {widest:.2f} (chance alone lets up to {allowed} miss)."
    )
    why = "; ".join(f"{PARTS[part]}, {one.place}: {fit.text(3)}, theory {said:.3f}" for one, part, fit, said in missed)
    return Verdict(claim, text, holds, why, SOURCE, _keys(measured))


def _level_verdict(measured: list[Measured]) -> Verdict:
    claim = "Not only slopes: variance and squared bias themselves follow from the radii and the number of photons."
    ratios = {
        part: [
            found / said for one in measured for found, said in zip(one.parts[part], one.expected[part], strict=True)
        ]
        for part in ("variance", "bias_squared")
    }
    inside = [
        level.holds(said)
        for one in measured
        for part in ratios
        for level, said in zip(one.levels[part], one.expected[part], strict=True)
        if np.isfinite(level.low)
    ]
    if not inside:
        return Verdict(claim, "Too few seeds for an interval.", "not tested", source=SOURCE)
    missed, allowed = inside.count(False), misses_by_chance(len(inside))
    near = all(abs(np.log(np.median(of))) < np.log(1.25) for of in ratios.values())
    holds = "yes" if missed <= allowed else "partly" if near else "no"
    text = "; ".join(f"{PARTS[part]} {min(of):.2f} to {max(of):.2f} times theory's" for part, of in ratios.items())
    text += f"; {len(inside) - missed} of {len(inside)} {CONFIDENCE:.0%} intervals hold theory's"
    text += f" (chance alone lets up to {allowed} miss)"
    return Verdict(claim, f"{text}.", holds, source=SOURCE, runs=_keys(measured))


def _whole_verdict(measured: list[Measured]) -> Verdict:
    claim = "Edges slow the whole image's squared bias down, to n^-(1-a)/2 in the end: flatter than n^-(2-2a)."
    texts, flatter, steeper = [], [], []
    for one in measured:
        slope = one.slopes["bias_squared"]
        texts.append(f"{one.place}: {slope.text(3)} beside -(1-a)/2 = {edge_limit(one.alpha):.3f}")
        if np.isfinite(slope.low):
            flatter.append(slope.low > bias_limit(one.alpha))
            steeper.append(slope.high < bias_limit(one.alpha))
    if not flatter:
        return Verdict(claim, "; ".join(texts), "not tested", source=SOURCE)
    holds = "yes" if all(flatter) else "no" if all(steeper) else "partly"
    return Verdict(claim, "; ".join(texts), holds, source=SOURCE, runs=_keys(measured))


def _keys(measured: list[Measured]) -> list[str]:
    return [key for one in measured for keys in one.keys for key in keys]
