"""What one photon a bucket adds in noise, beside the model's prediction, and what its kernels are in lines."""

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from lab import noise
from lab.figures import downloads, draw, figure
from lab.images import Gallery, exposure_of, luminance, read_exr
from lab.reports import judge, reference_text, show_picture, what_failed, write_csv
from lab.runs import Run
from lab.sections import Axis, Column, Plot, Section, Series, Table, Verdict, Viewer
from lab.store import Store
from lab.target import Plan
from matplotlib.ticker import NullFormatter
from parallel_ppm_2010.common import SOURCE, with_parameters
from parallel_ppm_2010.kernel_lines import kernel_rows

MODEL_HOLDS = 0.2  # share by which the measured ratio may differ from the predicted one


@dataclass
class Kind:
    """A way to keep photons: `table_size` is None for the full list."""

    name: str
    method: str
    use: str
    table_size: float | None


@dataclass
class Found:
    """What the runs of one kind gave."""

    kind: Kind
    passes: int
    keys: list[str]
    failed: str
    records: list[dict]
    images: np.ndarray  # luminance: seeds x height x width


def kinds(plan: Plan) -> list[Kind]:
    """The full list, then the tables."""
    full = plan["full_list"]
    found = [Kind(full["name"], f"sppm+{full['use']}", full["use"], None)]
    for one in plan["stochastic"]:
        use = with_parameters(one["use"], table_size=one["table_size"])
        found.append(Kind(one["name"], f"sppm+{one['use']}, {one['name']}", use, one["table_size"]))
    return found


def runs_of(plan: Plan, kind: Kind, passes: int) -> list[Run]:
    """The runs of a kind, a seed each; radii are memoryless, so that equal passes are equal radii."""
    scene = plan.scenes[0]
    reference = scene.reference.source()
    first = plan.run(scene, plan.methods[0], plan.backends[0], passes=passes, reference=reference, measures_time=True)
    integrator = with_parameters(first.integrator, schedule="memoryless", alpha=plan["alpha"])
    run = first.but(integrator=integrator, photon_map=kind.use)
    return [run.but(seed=seed) for seed in range(1, plan["seeds"] + 1)]


def runs(plan: Plan) -> list[Run]:
    """All seeds of all kinds, in turns."""
    if not plan.backends:
        return []
    of_kinds = [runs_of(plan, kind, passes) for passes in plan["passes"] for kind in kinds(plan)]
    return [run for of_seed in zip(*of_kinds, strict=True) for run in of_seed]


def found_of(plan: Plan, store: Store, kind: Kind, passes: int) -> Found:
    """Read the runs of a kind; those that failed are told."""
    made = runs_of(plan, kind, passes)
    records = [(run, store.record(run)) for run in made]
    good = [(run, record) for run, record in records if "statistics" in record]
    images = np.stack([luminance(read_exr(store.image(run))) for run, _ in good]) if good else np.zeros((0, 0, 0))
    failed = next(filter(None, (what_failed(record) for _, record in records)), "")
    return Found(kind, passes, [store.key(run) for run in made], failed, [record for _, record in good], images)


def window(images: np.ndarray, corners: list[int]) -> np.ndarray:
    """The pixels of a window x0, y0, x1, y1."""
    x0, y0, x1, y1 = corners
    return images[:, y0:y1, x0:x1]


def noise_rows(found: list[Found], smooth: list[int], alpha: float) -> list[dict]:
    """For each kind and number of passes: noise in the smooth window, over the full list's, and what the model says.

    lambda comes from the full list with the most passes alone: what it says of fewer passes is a prediction, too.
    """
    most = max(found, key=lambda one: one.passes if one.kind.table_size is None else 0)
    if len(most.images) < 2:
        return []
    first = noise.photons_in_disc(noise.relative_variance(window(most.images, smooth)), most.passes)
    first /= noise.harmonic_share(most.passes, alpha)
    rows = []
    for one in found:
        full = next(other for other in found if other.kind.table_size is None and other.passes == one.passes)
        in_disc = first * noise.harmonic_share(one.passes, alpha)
        row = {"kind": one.kind.name, "method": one.kind.method, "passes": one.passes, "in_disc": in_disc}
        row["predicted_variance"] = 1.0 / (one.passes * in_disc)
        if one.kind.table_size is not None:
            row |= {"cells": in_disc * noise.kappa(cells_of(one)), "collisions": 1.0 / one.kind.table_size}
            row["predicted"] = 1.0 + row["cells"] + row["collisions"]
            row["predicted_variance"] *= row["predicted"]
        if len(one.images) > 1 and len(full.images) > 1:
            row["variance"] = noise.relative_variance(window(one.images, smooth))
            if one is not full:
                row |= compared(window(one.images, smooth), window(full.images, smooth), row["predicted"])
        keys = dict.fromkeys([*most.keys, *full.keys, *one.keys])
        rows.append({**row, "told": one.failed, "runs": list(keys)})
    return rows


def cells_of(found: Found) -> float:
    """Width of a cell in radii: what the program says of its runs, or its default."""
    parameters = found.records[0]["statistics"]["photon_map"]["parameters"] if found.records else {}
    return float(parameters.get("cell_size", 2.0))


def compared(images: np.ndarray, full: np.ndarray, predicted: float) -> dict:
    """The ratio of variances, its interval, and whether the prediction is near it."""
    measured = noise.variance_ratio(images, full)
    near = abs(measured.ratio / predicted - 1.0) <= MODEL_HOLDS or measured.low <= predicted <= measured.high
    return {"measured": measured.ratio, "low": measured.low, "high": measured.high, "near": near}


def verdicts_of(rows: list[dict], lines: list[dict]) -> list[Verdict]:
    """Is there more noise the smaller the table is, does the model say how much, and is the method the shortest?"""
    known = [row for row in rows if "measured" in row]
    keys = list(dict.fromkeys(key for row in known for key in row["runs"]))
    told = "; ".join(
        f"{row['kind']}, {row['passes']} passes: {row['measured']:.3g} times the variance of the full list"
        for row in known
    )
    ordered = sorted(known, key=lambda row: (row["passes"], row["collisions"]))
    grows = [a["measured"] < b["measured"] for a, b in pairwise(ordered) if a["passes"] == b["passes"]]
    more = Verdict(
        "One photon a bucket adds noise, and the more, the fewer buckets there are",
        told or "not measured",
        judge([*(row["low"] > 1.0 for row in known), *grows]),
        source=SOURCE,
        runs=keys,
    )
    model = "; ".join(
        f"{row['kind']}, {row['passes']} passes: {row['measured']:.3g} (95 % interval {row['low']:.3g} to "
        f"{row['high']:.3g}), predicted {row['predicted']:.3g}"
        for row in known
    )
    as_predicted = Verdict(
        "The variance is that of the full list times 1 + lambda kappa + P / T",
        model or "not measured",
        judge(row["near"] for row in known),
        f"It holds where the prediction lies within the interval or within {MODEL_HOLDS:.0%} of what was measured.",
        "the noise model of docs/photon-maps.md",
        keys,
    )
    return [more, as_predicted, easy(lines)]


def easy(lines: list[dict], shown: str = "stochastic_hash") -> Verdict:
    """Is stochastic hashing the least code? Lines that share a folder are one structure."""
    counts = {row["structure"]: row["lines"] for row in lines if row["lines"]}
    claim = "Stochastic hashing is easy to implement: its kernels are the fewest lines"
    others = {name: count for name, count in counts.items() if not name.startswith(shown)}
    if shown not in counts or not others:
        return Verdict(claim, "not measured", "not tested", source=SOURCE)
    shorter = sorted((name for name in others if others[name] < counts[shown]), key=others.get)
    shortest = min(others, key=others.get)
    longest = max(others, key=others.get)
    return Verdict(
        claim,
        f"{counts[shown]} lines; the others have {others[shortest]} ({shortest}) to {others[longest]} ({longest})",
        "yes" if not shorter else "partly" if len(shorter) < len(others) else "no",
        f"{', '.join(shorter)} have fewer; stochastic_hash's kernels hold three selections and several slots, of "
        "which the paper has one."
        if shorter
        else "",
        SOURCE,
    )


def curves(found: list[Found], key: str = "relmse_trimmed") -> list[dict]:
    """Error against passes and time: medians over seeds, with the quantiles at 10 and 90 %.

    The program notes an error now and then by the clock, too: only passes at which every seed has one are kept.
    """
    rows = []
    for one in found:
        of_passes: dict[int, list[tuple[float, float]]] = {}
        for record in one.records:
            for point in record["statistics"]["convergence"]:
                if point.get(key) is not None:
                    of_passes.setdefault(point["passes"], []).append((point[key], point["wall_s"]))
        for passes, values in sorted(of_passes.items()):
            if len(values) == len(one.records):
                errors, seconds = np.array(values).T
                low, middle, high = (float(value) for value in np.quantile(errors, [0.1, 0.5, 0.9]))
                row = {"kind": one.kind.name, "method": one.kind.method, "passes": passes, "error": middle}
                row |= {"low": low, "high": high, "seconds": float(np.median(seconds))}
                rows.append({**row, "runs": one.keys})
    return rows


def plots_of(plan: Plan, rows: list[dict], measured: list[dict]) -> list[Plot]:
    """Error against passes and time, and noise in the smooth window beside its prediction."""
    plots = []
    settings = f"{plan.scenes[0].title}, {plan['seeds']} seeds, memoryless radii"
    for key, title in [("passes", "passes"), ("seconds", "seconds")]:
        series = []
        for name, of_kind in by_kind(rows).items():
            column = {word: [row[word] for row in of_kind] for word in (key, "error", "low", "high", "runs")}
            hover = [f"{name}, {row['passes']} passes, {row['seconds']:.2f} s, {settings}" for row in of_kind]
            bands = {"low": column["low"], "high": column["high"], "hover": hover, "runs": column["runs"]}
            series.append(Series(name, of_kind[0]["method"], column[key], column["error"], **bands))
        if series:
            axes = Axis(title, True), Axis("relMSE, trimmed", True)
            plots.append(Plot(f"error-{key}", f"Whole image against {title}", *axes, series))
    series = []
    for name, of_kind in by_kind(measured).items():
        x, keys = [row["passes"] for row in of_kind], [row["runs"] for row in of_kind]
        for style, word, told in [("points", "variance", "measured"), ("dash", "predicted_variance", "predicted")]:
            hover = [f"{told}, {name}, {n} passes, {settings}" for n in x]
            y = [row.get(word) for row in of_kind]
            more = {"hover": hover, "runs": keys, "style": style}
            series.append(Series(f"{name}, {told}", of_kind[0]["method"], x, y, **more))
    if series:
        axes = Axis("passes", True), Axis("variance over squared mean", True)
        plots.append(Plot("window", "Smooth window against passes", *axes, series))
    return plots


def by_kind(rows: list[dict]) -> dict[str, list[dict]]:
    """Rows by their kind, in the order in which they come."""
    return {name: [row for row in rows if row["kind"] == name] for name in dict.fromkeys(row["kind"] for row in rows)}


def first_runs(plan: Plan, store: Store) -> list[tuple[Kind, Run]]:
    """A run of each kind that was made: the first seed, the most passes."""
    firsts = [(kind, runs_of(plan, kind, max(plan["passes"]))[0]) for kind in kinds(plan)]
    return [(kind, run) for kind, run in firsts if "statistics" in store.record(run)]


def draw_crops(plan: Plan, store: Store, folder: Path, reference: np.ndarray) -> None:
    """The same crop of one seed of each kind, and of the reference, at one exposure."""
    x0, y0, x1, y1 = plan["crop"]
    exposure = exposure_of(reference[y0:y1, x0:x1])
    shown = [(kind.name, read_exr(store.image(run))) for kind, run in first_runs(plan, store)]
    shown.append(("reference", reference))
    with figure(folder, "crops", (1.8 * len(shown), 2.1), 1, len(shown)) as (_, axes):
        for one, (title, image) in zip(axes.flat, shown, strict=True):
            show_picture(one, image[y0:y1, x0:x1], title, exposure)


def draw_plots(plots: list[Plot], folder: Path) -> None:
    """The plots side by side, with one legend: the last one's, which has every kind."""
    with figure(folder, "noise", (3.2 * len(plots), 2.9), 1, len(plots)) as (drawn, axes):
        for one, plot in zip(axes.flat, plots, strict=True):
            draw(one, plot)
            one.xaxis.set_minor_formatter(NullFormatter())
            if plot.x.title == "passes":
                places = sorted({x for series in plot.series for x in series.x})
                one.set_xticks(places, [str(place) for place in places])
        handles, labels = axes.flat[-1].get_legend_handles_labels()
        drawn.legend(handles, labels, loc="outside upper center", ncols=6, fontsize=7)


def report(plan: Plan, store: Store, folder: Path) -> Section:
    """Crops, curves, ratios beside their prediction, and lines of kernels."""
    lines = kernel_rows(plan.catalogue.structures)
    found = [found_of(plan, store, kind, n) for n in plan["passes"] for kind in kinds(plan)] if plan.backends else []
    rows = curves([one for one in found if one.passes == max(plan["passes"])])
    measured = noise_rows(found, plan["smooth"], plan["alpha"]) if found else []
    plots = plots_of(plan, rows, measured)
    files = [write_csv(folder / "error.csv", rows), write_csv(folder / "noise.csv", measured)]
    files.append(write_csv(folder / "lines.csv", lines))
    viewers = []
    if found:
        gallery, scene = Gallery(store, folder), plan.scenes[0]
        draw_crops(plan, store, folder, read_exr(gallery.reference_path(scene.reference.source())))
        files += downloads("crops", "crops")
        images = [gallery.of_run(kind.name, kind.method, run) for kind, run in first_runs(plan, store)]
        images.append(gallery.of_reference(scene.reference))
        viewers.append(Viewer("tables", f"{scene.title}, {max(plan['passes'])} passes, one seed", images, "reference"))
    if plots:
        draw_plots(plots, folder)
        files += downloads("noise", "error, and noise beside its prediction")
    return Section(
        plan.name,
        plan["title"],
        plan.experiment,
        text_of(plan, store),
        verdicts_of(measured, lines),
        plots,
        viewers,
        [noise_table(measured), lines_table(lines)],
        files,
    )


def text_of(plan: Plan, store: Store) -> list[str]:
    """What the model assumes, and where it is approximate."""
    told = [
        f"Memoryless radii and {plan['seeds']} seeds: equal passes are equal radii, so that what differs is noise. "
        "Seed by seed, all kinds see the same photons and the same hit points.",
        "The prediction is 1 + lambda kappa + P / T: lambda photons of a pass in a query's disc, P photons stored "
        "and T buckets, kappa of cells as wide as the structure's. It is exact for Poisson photons of equal flux on "
        "a plane along the grid's axes, and is compared in a window on the back wall, where illumination is smooth "
        "and no edge is near. lambda comes from the noise of the full list with the most passes there (a pass of "
        "Poisson photons has the relative variance 1 / lambda); what is said of fewer passes, and of the tables, is "
        "predicted from it. Photons of unequal flux make that lambda, and the prediction, too small; a tilted plane "
        "has a kappa that is 6 % smaller.",
        "Elsewhere the model is approximate: noise of the eye's own path through glass is in every kind alike, and "
        "at edges the disc holds fewer photons. Errors of the whole image are therefore shown without it.",
    ]
    return [*told, reference_text(plan.scenes[0], store)] if plan.backends else told


def noise_table(rows: list[dict]) -> Table:
    """Ratios of variances beside the model's."""
    columns = [
        Column("kind", "kept photons"),
        Column("passes", "passes"),
        Column("variance", "variance over squared mean"),
        Column("predicted_variance", "predicted"),
        Column("in_disc", "lambda, photons of a pass in a disc"),
        Column("cells", "lambda kappa"),
        Column("collisions", "P / T"),
        Column("predicted", "predicted ratio"),
        Column("measured", "measured ratio"),
        Column("low", "2.5 %"),
        Column("high", "97.5 %"),
        Column("told", "remarks"),
    ]
    caption = "Variance over seeds in the smooth window, over the full list's; the interval is a bootstrap over seeds."
    return Table("noise", "Noise beside its prediction", columns, rows, caption)


def lines_table(lines: list[dict]) -> Table:
    """Lines of kernels of every structure."""
    columns = [
        Column("structure", "structure"),
        Column("lines", "lines of kernels"),
        Column("construction", "construction"),
        Column("gathering", "gathering"),
        Column("shared", "shared by both"),
        Column("files", "files"),
    ]
    caption = (
        "Lines of `*.kernel.h`, `*.gather.h` and other headers for kernels without comments and blank ones. What "
        "structures share (hashing, prefix sums, sorting) and what runs on the host is not counted; structures of one "
        "folder have the same count."
    )
    return Table("lines", "Lines of kernels", columns, lines, caption)
