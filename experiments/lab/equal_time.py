"""Methods given the same time on the same scene: their runs, what they reached, and how that is shown."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from lab.catalogue import Method, Scene
from lab.figures import figure
from lab.images import Gallery, exposure_of, read_exr
from lab.reports import show_picture, what_failed
from lab.runs import Run
from lab.sections import Axis, Column, Image, Plot, Series, Table, Viewer
from lab.store import Store
from lab.target import Plan


@dataclass(frozen=True)
class Case:
    """A scene, method and backend."""

    scene: Scene
    method: Method
    backend: str

    def run(self, plan: Plan) -> Run:
        """Its run: as many passes as fit into the time."""
        reference = self.scene.reference.source()
        made = plan.run(self.scene, self.method, self.backend, time_s=plan["time_s"], reference=reference)
        return made.but(measures_time=True)


def cases(plan: Plan) -> list[Case]:
    """Every scene under every method."""
    return [
        Case(scene, method, backend) for backend in plan.backends for scene in plan.scenes for method in plan.methods
    ]


@dataclass
class Outcome:
    """A run that was made, and its entry in the viewer; `image` is None where the machine could not."""

    case: Case
    key: str
    record: dict
    image: Image | None

    def error(self, word: str) -> float | None:
        """One of the image's errors."""
        return self.image.errors.get(word) if self.image else None


def outcomes(plan: Plan, store: Store, folder: Path) -> list[Outcome]:
    """Read all runs."""
    gallery = Gallery(store, folder)
    found = []
    for case in cases(plan):
        run = case.run(plan)
        record = store.record(run)
        image = gallery.of_run(_name(plan, case), case.method.name, run) if "statistics" in record else None
        found.append(Outcome(case, store.key(run), record, image))
    return found


def _name(plan: Plan, case: Case) -> str:
    return case.method.label if len(plan.backends) < 2 else f"{case.method.label}, {case.backend}"


def rows_of(found: list[Outcome]) -> list[dict]:
    """A row for each run: what it did, and how wrong it is."""
    rows = []
    for one in found:
        statistics = one.record.get("statistics", {})
        row = {"scene": one.case.scene.title, "method": one.case.method.label, "backend": one.case.backend}
        row |= {"passes": statistics.get("passes"), "seconds": statistics.get("wall_s")}
        row |= {"photons": statistics.get("photons_emitted") or None}
        row |= {word: one.error(word) for word in ("relmse", "relmse_trimmed", "mape", "flip")}
        rows.append({**row, "told": what_failed(one.record), "runs": [one.key]})
    return rows


def table_of(rows: list[dict]) -> Table:
    """The errors as a table."""
    columns = [
        Column("scene", "scene"),
        Column("method", "method"),
        Column("backend", "backend"),
        Column("passes", "passes"),
        Column("seconds", "rendering", "s"),
        Column("photons", "photons emitted"),
        Column("relmse", "relMSE"),
        Column("relmse_trimmed", "relMSE, trimmed"),
        Column("mape", "MAPE"),
        Column("flip", "FLIP"),
        Column("told", "remarks"),
    ]
    caption = (
        "Against the scene's reference. Trimmed: without the 0.1 % of pixels that are worst. FLIP is HDR-FLIP's mean."
    )
    return Table("errors", "Errors in equal time", columns, rows, caption)


def plots_of(plan: Plan, found: list[Outcome]) -> list[Plot]:
    """Error against time as rendering went on, for each scene."""
    plots = []
    for scene in plan.scenes:
        series = []
        for one in found:
            if one.case.scene.name != scene.name or not one.image:
                continue
            points = [
                point
                for point in one.record["statistics"]["convergence"]
                if point.get("relmse_trimmed") and point["wall_s"] > 0.0
            ]
            if not points:
                continue
            settings = (
                f"{one.case.method.integrator}, {one.case.method.photon_map or 'default structure'}, {scene.resolution}"
            )
            hover = [f"{settings}, {point['passes']} passes, {point['wall_s']:.2f} s" for point in points]
            x, y = [point["wall_s"] for point in points], [point["relmse_trimmed"] for point in points]
            name = one.image.name
            series.append(Series(name, one.case.method.name, x, y, hover=hover, runs=[[one.key]] * len(x)))
        if series:
            plots.append(
                Plot(
                    f"time-{scene.name}",
                    scene.title,
                    Axis("rendering time [s]", True),
                    Axis("relMSE, trimmed", True),
                    series,
                )
            )
    return plots


def viewers_of(plan: Plan, store: Store, folder: Path, found: list[Outcome]) -> list[Viewer]:
    """A viewer for each scene, with its reference."""
    viewers = []
    for scene in plan.scenes:
        images = [one.image for one in found if one.case.scene.name == scene.name and one.image]
        if images:
            images.append(Gallery(store, folder).of_reference(scene.reference))
            viewers.append(Viewer(scene.name, f"{scene.title}, {plan['time_s']} s each", images, "reference"))
    return viewers


def pictures_of(store: Store, folder: Path, scene: Scene, found: list[Outcome]) -> list[tuple[str, np.ndarray]]:
    """Title and image of each method on a scene, and of its reference last."""
    chosen = [one for one in found if one.case.scene.name == scene.name and one.image]
    shown = [
        (f"{one.image.name}\nFLIP {one.error('flip'):.3f}", read_exr(store.folder / one.image.file)) for one in chosen
    ]
    reference = Gallery(store, folder).reference_path(scene.reference.source())
    return [*shown, ("reference", read_exr(reference))]


def draw_sheet(plan: Plan, store: Store, folder: Path, found: list[Outcome], name: str) -> None:
    """A row for each scene: its images under every method, at the reference's exposure."""
    rows = [(scene, pictures_of(store, folder, scene, found)) for scene in plan.scenes]
    columns = max(len(pictures) for _, pictures in rows)
    with figure(folder, name, (1.5 * columns, 1.75 * len(rows)), len(rows), columns) as (_, axes):
        for one in axes.flat:
            one.set_axis_off()
        for line, (_, pictures) in zip(axes, rows, strict=True):
            exposure = exposure_of(pictures[-1][1])
            for one, (title, image) in zip(line, pictures, strict=False):
                show_picture(one, image, title, exposure)


def named(found: list[Outcome], scene: str, method: str, backend: str) -> Outcome | None:
    """The outcome of a method on a scene."""
    wanted = (scene, method, backend)
    return next((one for one in found if (one.case.scene.name, one.case.method.name, one.case.backend) == wanted), None)


def below(found: list[Outcome], methods: list[str], against: str, word: str) -> list[tuple[Outcome, Outcome, float]]:
    """Each of `methods` on each scene beside `against`: both, and the error of the one over that of the other."""
    pairs = []
    for scene, backend in dict.fromkeys((one.case.scene.name, one.case.backend) for one in found):
        other = named(found, scene, against, backend)
        for method in methods:
            mine = named(found, scene, method, backend)
            if mine and other and mine.error(word) is not None and other.error(word):
                pairs.append((mine, other, mine.error(word) / other.error(word)))
    return pairs
