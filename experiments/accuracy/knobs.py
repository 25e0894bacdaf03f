"""The knobs, one at a time: what each costs or gains at equal time, the others as they are by default."""

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from accuracy.measured import NEAR
from accuracy.panels import panels
from lab.catalogue import DeclarationError, Method, Scene
from lab.figures import COLOURS, MARKERS, downloads
from lab.images import reference_error
from lab.runs import Run
from lab.sections import Axis, Column, Download, Plot, Section, Series, Table
from lab.store import Store
from lab.target import Plan


@dataclass(frozen=True)
class Setting:
    """One value of a knob on a scene with a method and backend; `value` is None where nothing is turned.

    What goes `besides` a knob sets aside what the scene says, so that its default has no place among the values.
    """

    scene: Scene
    method: Method
    backend: str
    key: str
    of: str
    value: float | None
    besides: tuple[tuple[str, float], ...] = ()

    def run(self, plan: Plan, seed: int) -> Run:
        """The run of a seed."""
        kept = {"time_s": plan["time_s"], "reference": self.scene.reference.source(), "measures_time": True}
        run = plan.run(self.scene, self.method, self.backend, seed=seed, **kept)
        if self.value is None:
            return run
        field = {"integrator": "integrator", "structure": "photon_map"}[self.of]
        changed = getattr(run, field)
        for key, value in [*self.besides, (self.key, self.value)]:
            changed = with_parameter(changed, key, value)
        return run.but(**{field: changed})

    def value_used(self, statistics: dict) -> float | None:
        """The value of the knob in a run; None where the method does not have it."""
        told = statistics["integrator"] if self.of == "integrator" else statistics["photon_map"] or {}
        return told.get("parameters", {}).get(self.key)


@dataclass(frozen=True)
class Result:
    """What a setting's runs came to: medians over seeds with the least and the most."""

    setting: Setting
    value: float | None  # that was used
    relmse: list[float]
    flip: list[float]
    passes: int
    keys: list[str]
    failed: str = ""


def with_parameter(choice: str, key: str, value: float) -> str:
    """NAME:key=value,... with one parameter set, in the place of what was said before."""
    name, _, words = choice.partition(":")
    kept = [word for word in words.split(",") if word and word.partition("=")[0] != key]
    return f"{name}:{','.join([*kept, f'{key}={value:g}'])}"


def values_of(knob: dict, scene: Scene) -> list[float]:
    """The values that are tried besides the default."""
    if ("values" in knob) == ("factors" in knob):
        raise DeclarationError(f"knob {knob['key']}: give either values or factors")
    return knob["values"] if "values" in knob else [round(scene.photons * one) for one in knob["factors"]]


def settings(plan: Plan, knob: dict) -> list[list[Setting]]:
    """For each scene, method and backend: the default, and the knob's values."""
    found = []
    for scene in plan.scenes:
        for method in plan.methods:
            for backend in plan.backends:
                besides = tuple(knob.get("besides", {}).items())
                base = (scene, method, backend, knob["key"], knob["of"])
                turned = [Setting(*base, value, besides) for value in values_of(knob, scene)]
                found.append([Setting(*base, None, besides), *turned])
    return found


def runs(plan: Plan) -> list[Run]:
    """Every setting with every seed; the default is shared by all knobs."""
    every = [one for knob in plan["knobs"] for group in settings(plan, knob) for one in group]
    return [setting.run(plan, seed) for setting in every for seed in _seeds(plan)]


def _seeds(plan: Plan) -> range:
    return range(1, plan["seeds"] + 1)


def read(plan: Plan, store: Store, setting: Setting) -> Result:
    """The errors of a setting's runs."""
    relmse, flip, passes, keys, value, failed = [], [], [], [], setting.value, ""
    for seed in _seeds(plan):
        run = setting.run(plan, seed)
        record = store.record(run)
        keys.append(record["key"])
        if "failed" in record:
            failed = record["failed"].splitlines()[-1]
            continue
        relmse.append(record["compare"]["relmse"])
        flip.append(record["compare"]["flip"])
        passes.append(record["statistics"]["passes"])
        if setting.value is not None or not setting.besides:
            value = setting.value_used(record["statistics"])
    return Result(setting, value, relmse, flip, int(np.median(passes)) if passes else 0, keys, failed)


def report(plan: Plan, store: Store, folder: Path) -> Section:
    """Read the runs; write figures and data."""
    section = Section(plan.name, plan["title"], plan.experiment)
    groups = [
        (knob, [read(plan, store, one) for one in group]) for knob in plan["knobs"] for group in settings(plan, knob)
    ]
    floors = {scene.name: reference_error(scene.reference, store) for scene in plan.scenes}
    section.text = [
        f"Each run renders for {plan['time_s']:g} s; one knob is turned, the others stay as they are by default. Lines "
        f"are medians of {plan['seeds']} seeds, bands their least and most. relMSE = mean (I-R)^2 / (R^2 + 0.01); FLIP "
        "is the mean of HDR-FLIP. A radius in pixels replaces the scene's own radius, where it has one.",
        *(_floor_text(scene, floors[scene.name]) for scene in plan.scenes),
    ]
    looks = {method.name: {"color": COLOURS[i], "marker": MARKERS[i]} for i, method in enumerate(plan.methods)}
    looks |= {"FLIP": {"color": COLOURS[-1], "marker": "s"}, "theory": {"color": "#222222", "marker": "none"}}
    section.tables = [_table(groups, floors)]
    section.plots = [plot for knob, group in groups for plot in [_plot(knob, group)] if plot]
    panels(folder, "knobs", section.plots, 3, looks)
    _write_csv(folder / "knobs.csv", groups)
    section.downloads = [*downloads("knobs", "The knobs"), Download("knobs.csv", "Every run (CSV)")]
    return section


def _floor_text(scene: Scene, floor: dict) -> str:
    relmse = f"{floor['relmse']:.2g}" if floor["relmse"] is not None else "not known"
    return f"{scene.title}: the reference's own relMSE is {relmse} ({floor['how']}); it is by {scene.reference.by}."


def best_of(group: list[Result]) -> Result | None:
    """The setting with the least median relMSE."""
    made = [one for one in group if one.relmse]
    return min(made, key=lambda one: np.median(one.relmse)) if made else None


def _table(groups: list[tuple[dict, list[Result]]], floors: dict[str, dict]) -> Table:
    columns = [
        Column("scene", "scene"),
        Column("backend", "backend"),
        Column("method", "method"),
        Column("knob", "knob"),
    ]
    columns += [Column("default", "default"), Column("relmse", "relMSE"), Column("flip", "FLIP")]
    columns += [Column("best", "best value"), Column("best_relmse", "relMSE"), Column("best_flip", "FLIP")]
    columns += [Column("worst", "worst over best"), Column("told", "verdict")]
    rows = []
    for knob, group in groups:
        default, best = group[0], best_of(group)
        case, floor = default.setting, floors[default.setting.scene.name]["relmse"]
        row = {"scene": case.scene.title, "backend": case.backend, "method": case.method.label, "knob": knob["title"]}
        row |= {"runs": [key for one in group for key in one.keys], "told": _told(default, best, group, floor)}
        if default.relmse:
            row |= {
                "default": "as the scene has it" if default.value is None else default.value,
                "relmse": float(np.median(default.relmse)),
            }
            row |= {"flip": float(np.median(default.flip))}
        if best:
            worst = max(float(np.median(one.relmse)) for one in group if one.relmse)
            least = float(np.median(best.relmse))
            row |= {
                "best": "as the scene has it" if best.value is None else best.value,
                "best_relmse": least,
                "best_flip": float(np.median(best.flip)),
            }
            row |= {"worst": worst / least}
        rows.append(row)
    return Table("knobs", "The default and the best value of each knob", columns, rows)


def _told(default: Result, best: Result | None, group: list[Result], floor: float | None) -> str:
    """Whether another value is better than the default by more than the seeds' spread."""
    told = [f"{one.value:g} failed: {one.failed}" for one in group if one.failed and one.value is not None]
    if not best or not default.relmse:
        return "; ".join([*told, "no run"])
    if best is default:
        told.append("the default is best")
    elif max(best.relmse) < min(default.relmse):
        told.append(f"better by a factor of {np.median(default.relmse) / np.median(best.relmse):.2g}")
    else:
        told.append("no difference beyond the seeds' spread")
    if floor and np.median(best.relmse) < NEAR * floor:
        told.append("near the reference's own error")
    return "; ".join(told)


def _plot(knob: dict, group: list[Result]) -> Plot | None:
    made = sorted((one for one in group if one.relmse and one.value is not None), key=lambda one: one.value)
    if not made:
        return None
    case, default = group[0].setting, group[0]
    series = []
    for name, method, values in [("relMSE", case.method.name, "relmse"), ("FLIP", "FLIP", "flip")]:
        of = [getattr(one, values) for one in made]
        y = [float(np.median(one)) for one in of]
        low, high = [min(one) for one in of], [max(one) for one in of]
        hover = [f"{case.method.label}, {knob['key']} = {one.value:g}: {one.passes} passes" for one in made]
        x, keys = [one.value for one in made], [one.keys for one in made]
        series.append(Series(name, method, x, y, low, high, hover, keys))
    if default.relmse and default.value is not None:
        ends = [min(series[1].y + series[0].y), max(series[0].y + series[1].y)]
        series.append(Series("default", "theory", [default.value] * 2, ends, style="dash"))
    elif default.relmse:
        ends, level = [made[0].value, made[-1].value], float(np.median(default.relmse))
        series.append(Series("relMSE, as the scene has it", "theory", ends, [level] * 2, style="dash"))
    title = f"{knob['title'][0].upper()}{knob['title'][1:]}: {case.scene.title}, {case.backend}"
    identifier = f"knobs-{case.scene.name}-{case.method.name}-{case.backend}-{knob['key']}".replace("+", "-")
    return Plot(identifier, title, Axis(knob["title"], True), Axis("error", True), series)


def _write_csv(path: Path, groups: list[tuple[dict, list[Result]]]) -> None:
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["scene", "backend", "method", "knob", "value", "relmse", "flip", "passes", "runs", "failed"])
        for knob, group in groups:
            for one in group:
                case = one.setting
                median = [float(np.median(values)) if values else "" for values in (one.relmse, one.flip)]
                told = [one.value, *median, one.passes, " ".join(one.keys), one.failed]
                writer.writerow([case.scene.name, case.backend, case.method.name, knob["key"], *told])
