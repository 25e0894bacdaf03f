"""Construction and query of every structure against the number of random points, on both backends."""

import math
from pathlib import Path

import numpy as np
from lab.catalogue import Method
from lab.figures import downloads, draw, figure, palette
from lab.reports import judge, what_failed, write_csv
from lab.runs import Run
from lab.sections import Axis, Column, Plot, Section, Series, Table, Verdict
from lab.store import Store
from lab.target import Plan
from parallel_ppm_2010.common import SOURCE, is_software, structure_name

LINEAR = (0.9, 1.1)  # exponents of the time to build that count as linear
FIT_FROM = 1e4  # smaller builds are mostly the cost of starting one


def bench_run(plan: Plan, method: Method, backend: str) -> Run:
    """The measurement of one structure on one backend."""
    words = ["--structures", method.photon_map, "--backend", backend, "--points", ",".join(plan["points"])]
    words += ["--distribution", "uniform", "--seconds", str(plan["seconds"]), "--queries", str(plan["queries"])]
    for plugin in method.plugins:
        words += ["--plugin", plugin]
    return Run(
        kind="bench",
        backend=backend,
        device=plan.device if backend == "vulkan" else "",
        arguments=tuple(words),
        plugins=method.plugins,
        measures_time=True,
    )


def runs(plan: Plan) -> list[Run]:
    """One run for each structure and backend, so that each is kept by itself."""
    return [bench_run(plan, method, backend) for backend in plan.backends for method in plan.methods]


def growth(points: list[float], seconds: list[float]) -> tuple[float, float] | None:
    """Exponent of seconds ~ points^e, fitted on log-log axes, and its standard error; None of fewer than two points."""
    chosen = [(n, t) for n, t in zip(points, seconds, strict=True) if n >= FIT_FROM]
    if len(chosen) < 2:
        return None
    x, y = np.log(np.array(chosen)).T
    slope, intercept = np.polyfit(x, y, 1)
    spare = len(x) - 2
    rest = float(np.sum((y - slope * x - intercept) ** 2))
    error = math.sqrt(rest / spare / float(np.sum((x - x.mean()) ** 2))) if spare else math.nan
    return float(slope), error


def rows_of(plan: Plan, store: Store) -> list[dict]:
    """A row for each structure, backend and number of points; what a device could not do is a row, too."""
    rows = []
    for backend in plan.backends:
        for method in plan.methods:
            run = bench_run(plan, method, backend)
            record, key = store.record(run), store.key(run)
            name = structure_name(method.name)
            same = {"structure": name, "backend": backend, "runs": [key]}
            bench = record.get("bench", {"rows": [], "failed": []})
            for row in bench["rows"]:
                kept = {word: row[word] for word in MEASURED}
                kept["total_s"] = row["points"] * row["construction_ns_per_point"] * 1e-9
                rows.append({**same, "points": row["points"], **kept, "told": ""})
            for text in [what_failed(record)] if "failed" in record else [_failure(one) for one in bench["failed"]]:
                rows.append({**same, "points": None, "told": text})
    return rows


MEASURED = ["construction_ns_per_point", "floor_ns_per_point", "query_ns", "bytes_per_point", "photons_found_mean"]


def _failure(one) -> str:
    return " ".join(str(value) for value in one.values()) if isinstance(one, dict) else str(one)


def summary_of(rows: list[dict]) -> list[dict]:
    """Of each structure and backend: the figures at the most points that were measured, and construction's growth."""
    found = []
    for backend, name in dict.fromkeys((row["backend"], row["structure"]) for row in rows):
        of_both = [row for row in rows if (row["backend"], row["structure"]) == (backend, name)]
        measured = sorted((row for row in of_both if row["points"]), key=lambda row: row["points"])
        told = "; ".join(row["told"] for row in of_both if row["told"])
        if not measured:
            found.append({"backend": backend, "structure": name, "told": told, "runs": of_both[0]["runs"]})
            continue
        last = measured[-1]
        fit = growth([row["points"] for row in measured], [row["total_s"] for row in measured])
        over_floor = (
            last["construction_ns_per_point"] / last["floor_ns_per_point"] if last["floor_ns_per_point"] else None
        )
        exponents = {"exponent": fit[0] if fit else None, "exponent_error": fit[1] if fit else None}
        found.append({**last, "over_floor": over_floor, **exponents, "told": told})
    return found


def verdicts_of(summary: list[dict], shown: str, over_hit_points: list[str]) -> list[Verdict]:
    """Per backend: is the construction of `shown` the fastest of those over photons, and linear?"""
    found = []
    for backend in dict.fromkeys(row["backend"] for row in summary):
        rows = [row for row in summary if row["backend"] == backend and row.get("points")]
        mine = next((row for row in rows if row["structure"] == shown), None)
        points = mine["points"] if mine else None
        others = [
            row
            for row in rows
            if row["points"] == points and row["structure"] != shown and row["structure"] not in over_hit_points
        ]
        if not mine or not others:
            found.append(
                Verdict(
                    f"Construction of {shown} is the fastest ({backend})", "not measured", "not tested", source=SOURCE
                )
            )
            continue
        best = min(others, key=lambda row: row["construction_ns_per_point"])
        fastest = mine["construction_ns_per_point"] <= best["construction_ns_per_point"]
        linear = mine["exponent"] is not None and LINEAR[0] <= mine["exponent"] <= LINEAR[1]
        told = "" if mine["exponent"] is None else f"; its time grows as points^{mine['exponent']:.2f}"
        why = [] if fastest else [f"{best['structure']} is built faster here"]
        if not linear:
            why.append(f"an exponent from {LINEAR[0]} to {LINEAR[1]} counts as linear")
        found.append(
            Verdict(
                f"Construction of {shown} is the fastest, and takes time in proportion to the points ({backend})",
                f"{mine['construction_ns_per_point']:.3g} ns a point at {points:,} points, the next "
                f"({best['structure']}) {best['construction_ns_per_point']:.3g} ns{told}",
                judge([fastest, linear]),
                "; ".join(why),
                SOURCE,
                [*mine["runs"], *best["runs"]],
            )
        )
    return found


def plots_of(rows: list[dict]) -> list[Plot]:
    """Construction and query against points, for each backend; the floor is that of the structure that is measured."""
    plots = []
    for key, title, floor in [
        ("construction_ns_per_point", "Construction", "floor_ns_per_point"),
        ("query_ns", "Query", ""),
    ]:
        for backend in dict.fromkeys(row["backend"] for row in rows):
            series = []
            for name in dict.fromkeys(row["structure"] for row in rows):
                of_both = [
                    row for row in rows if (row["backend"], row["structure"]) == (backend, name) and row["points"]
                ]
                if not of_both:
                    continue
                points = [row["points"] for row in of_both]
                settings = [f"{name}, {backend}, {row['points']:,} points, uniform" for row in of_both]
                keys = [row["runs"] for row in of_both]
                series.append(Series(name, name, points, [row[key] for row in of_both], hover=settings, runs=keys))
                if floor:
                    settings = [f"unavoidable memory traffic of {text}" for text in settings]
                    values = [row[floor] or None for row in of_both]
                    series.append(Series(f"{name}: floor", name, points, values, None, None, settings, keys, "dash"))
            unit = "ns a point" if floor else "ns a query"
            plots.append(
                Plot(
                    f"{title.lower()}-{backend}", f"{title}, {backend}", Axis("points", True), Axis(unit, True), series
                )
            )
    return plots


def draw_figure(plots: list[Plot], folder: Path, shown: str) -> None:
    """Construction above, queries below, a column for each backend; of the floors only that of `shown`."""
    columns = max(1, len(plots) // 2)
    names = [series.method for plot in plots for series in plot.series]
    with figure(folder, "random_points", (3.4 * columns + 1.2, 5.2), 2, columns) as (drawn, axes):
        for one, plot in zip(axes.flat, plots, strict=True):
            lines = [series for series in plot.series if series.style != "dash" or series.method == shown]
            draw(one, Plot(plot.id, plot.title, plot.x, plot.y, lines), palette(names))
        handles, labels = axes[0, 0].get_legend_handles_labels()
        drawn.legend(handles, labels, loc="outside right center", fontsize=6)


def text_of(plan: Plan, rows: list[dict], store: Store) -> list[str]:
    """What was measured, and what stands beside it."""
    told = [
        "Points lie evenly in a cube; a query finds ten of them on average. Times are medians of at least three "
        "builds. The dashed floors are the memory traffic that a structure cannot avoid, measured beside each row.",
        f"`splat` is built over {plan['queries']:,} hit points, not over photons: its construction is what a photon's "
        "share of that costs, and its query looks all photons up. It is left out where structures over photons are "
        "ranked.",
        f"Growth is fitted from {FIT_FROM:,.0f} points on: smaller builds are mostly the cost of starting one.",
    ]
    if any(row["backend"] == "vulkan" for row in rows) and is_software(store.machine.vulkan):
        told.append(
            f"The Vulkan device ({store.machine.vulkan}) is the processor itself: its figures are not those of a GPU."
        )
    return told


def report(plan: Plan, store: Store, folder: Path) -> Section:
    """Plots, a table at the most points, and the verdict for each backend."""
    rows = rows_of(plan, store)
    summary, plots = summary_of(rows), plots_of(rows)
    files = [write_csv(folder / "random_points.csv", rows)]
    if plots:
        draw_figure(plots, folder, plan["shown"])
        files += downloads("random_points", "construction and query")
    columns = [
        Column("structure", "structure"),
        Column("backend", "backend"),
        Column("points", "points"),
        Column("construction_ns_per_point", "construction", "ns a point"),
        Column("floor_ns_per_point", "floor", "ns a point"),
        Column("over_floor", "construction over floor", "", 2),
        Column("query_ns", "query", "ns"),
        Column("bytes_per_point", "memory", "bytes a point"),
        Column("exponent", "growth of construction: exponent"),
        Column("exponent_error", "its standard error", "", 1),
        Column("told", "remarks"),
    ]
    return Section(
        plan.name,
        plan["title"],
        plan.experiment,
        text_of(plan, rows, store),
        verdicts_of(summary, plan["shown"], plan["over_hit_points"]),
        plots,
        tables=[Table("largest", "At the most points", columns, summary)],
        downloads=files,
    )
