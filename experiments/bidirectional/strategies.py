"""Every strategy of bidirectional path tracing by itself: as its weight leaves it, and alone."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from lab.catalogue import Scene
from lab.figures import downloads, figure
from lab.images import Gallery, exposure_of, luminance, read_exr, write_picture
from lab.reports import judge, show_picture, what_failed, write_csv
from lab.runs import Run
from lab.sections import Column, Figure, Image, Section, Table, Verdict, Viewer
from lab.store import Store
from lab.target import Plan

WEIGHTED, ALONE = "strategy", "alone"  # layers of the program's EXR
TOLERANCE = 1e-3  # of the sum of the weighted pictures, in the picture's mean


@dataclass
class Strategy:
    """One strategy on one scene: `s` vertices from the light, `t` from the camera, and its two pictures."""

    s: int
    t: int
    weighted: np.ndarray
    alone: np.ndarray

    @property
    def scattering(self) -> int:
        """Scattering vertices of its paths."""
        return self.s + self.t - 2

    @property
    def name(self) -> str:
        """For tables and viewers."""
        return f"s = {self.s}, t = {self.t}"


def run_of(plan: Plan, scene: Scene) -> Run:
    """The run of a scene; its settings are the target's, whose paths are short."""
    settings = (f"integrator.maxdepth={plan['maxdepth']}", "integrator.strategies=on")
    return plan.run(scene, plan.methods[0], plan.backends[0], passes=plan["passes"], settings=settings)


def runs(plan: Plan) -> list[Run]:
    """Each scene once."""
    return [run_of(plan, scene) for scene in plan.scenes] if plan.backends else []


def read_strategies(path: Path, maxdepth: int) -> list[Strategy]:
    """The strategies of a run's picture, short paths first, each length from the camera's end to the light's."""
    found = []
    for scattering in range(maxdepth + 1):
        for s in range(scattering + 2 if scattering else 1):
            t = scattering + 2 - s
            weighted, alone = (
                read_exr(path, [f"{layer}.s{s}t{t}.{channel}" for channel in "RGB"]) for layer in (WEIGHTED, ALONE)
            )
            found.append(Strategy(s, t, weighted, alone))
    return found


def draw_pyramid(folder: Path, name: str, strategies: list[Strategy], exposure: float, weighted: bool) -> None:
    """A row for each length of paths, a column for each s."""
    by_place = {(one.scattering, one.s): one for one in strategies}
    rows = max(one.scattering for one in strategies) + 1
    columns = max(one.s for one in strategies) + 1
    height, width = strategies[0].weighted.shape[:2]
    with figure(folder, name, (1.3 * columns, (1.3 * height / width + 0.2) * rows), rows, columns) as (_, axes):
        for one in axes.flat:
            one.set_axis_off()
        for (row, column), one in by_place.items():
            # Longer paths are darker: a stop for each vertex.
            stops = exposure + max(0, one.scattering - 1)
            show_picture(axes[row, column], one.weighted if weighted else one.alone, one.name, stops)


def viewer_of(gallery: Gallery, scene: Scene, run: Run, strategies: list[Strategy], weighted: bool) -> Viewer:
    """The pictures of all strategies of a scene, and the whole picture."""
    word = WEIGHTED if weighted else ALONE
    whole = gallery.of_run("all strategies", "bdpt", run)
    images = [whole]
    for one in strategies:
        path = gallery.folder / "layers" / f"{scene.name}-{word}-s{one.s}t{one.t}.exr"
        write_picture(path, one.weighted if weighted else one.alone)
        images.append(Image(one.name, "", gallery.relative(path), whole.command, whole.run, whole.facts))
    title = "with their weights" if weighted else "each alone, without weights"
    return Viewer(f"{scene.name}-{word}", f"{scene.title}: {title}", images, link=f"strategies-{scene.name}")


def rows_of(scene: Scene, key: str, picture: np.ndarray, strategies: list[Strategy]) -> list[dict]:
    """What each strategy brings to the picture's mean luminance, and how noisy it is alone."""
    whole = float(luminance(picture).mean(dtype=np.float64))
    rows = []
    for one in strategies:
        means = [float(luminance(image).mean(dtype=np.float64)) for image in (one.weighted, one.alone)]
        row = {"scene": scene.title, "scattering": one.scattering, "s": one.s, "t": one.t}
        shares = [mean / whole if whole else None for mean in means]
        rows.append({**row, "weighted": shares[0], "alone": shares[1], "runs": [key]})
    return rows


def sum_difference(picture: np.ndarray, strategies: list[Strategy]) -> float:
    """The mean difference of a picture from the sum of its weighted strategies, in its mean."""
    total = np.sum([one.weighted.astype(np.float64) for one in strategies], axis=0)
    return float(np.abs(total - picture).mean() / max(picture.mean(dtype=np.float64), 1e-30))


def sum_verdict(differences: dict[str, tuple[float, str]]) -> Verdict:
    """Do the weighted strategies add up to the picture?"""
    told = "; ".join(f"{title}: {difference:.1g}" for title, (difference, _) in differences.items())
    return Verdict(
        "With their weights, the strategies add up to the picture",
        f"Mean difference of a pixel, over the picture's mean: {told}" if told else "not measured",
        judge(difference <= TOLERANCE for difference, _ in differences.values()),
        f"a difference up to {TOLERANCE:g} counts as none",
        "Veach, Robust Monte Carlo Methods for Light Transport Simulation (1997), section 10.2",
        [key for _, key in differences.values()],
    )


COLUMNS = [
    Column("scene", "scene"),
    Column("scattering", "scattering vertices"),
    Column("s", "s"),
    Column("t", "t"),
    Column("weighted", "share of the picture, weighted"),
    Column("alone", "alone", digits=3),
]


def report(plan: Plan, store: Store, folder: Path) -> Section:
    """The pyramids, viewers of their pictures, and what each strategy brings."""
    gallery = Gallery(store, folder)
    rows, viewers, figures, files, differences, failed = [], [], [], [], {}, []
    for run, scene in zip(runs(plan), plan.scenes, strict=False):
        if why := what_failed(store.record(run)):
            failed.append(f"{scene.title} could not be rendered: {why}")
            continue
        picture = read_exr(store.image(run))
        strategies = read_strategies(store.image(run), plan["maxdepth"])
        exposure = exposure_of(picture)
        differences[scene.title] = (sum_difference(picture, strategies), store.key(run))
        rows += rows_of(scene, store.key(run), picture, strategies)
        for weighted in (True, False):
            name = f"{scene.name}-{WEIGHTED if weighted else ALONE}"
            draw_pyramid(folder, name, strategies, exposure, weighted)
            words = "strategies with their weights" if weighted else "strategies alone"
            figures.append(Figure(f"{name}.png", f"{scene.title}: {words}"))
            files += downloads(name, f"{scene.title}, {words}")[1:]  # the page shows the PNG
            viewers.append(viewer_of(gallery, scene, run, strategies, weighted))
    files.insert(0, write_csv(folder / "strategies.csv", rows))
    return Section(
        plan.name,
        plan["title"],
        plan.experiment,
        [
            "A path with k scattering vertices can be found with s vertices from the light and t = k + 2 - s from the "
            "camera. Rows: k from 0; columns: s from 0. Alone, each strategy shows all light that it can find, with "
            "its own noise; its weight keeps what it is good at (Veach 1997, figure 10.2).",
            f"{plan['passes']} passes, `maxdepth` {plan['maxdepth']}; all pictures of a scene at one exposure, in the "
            "figures a stop more for each vertex beyond the first. `--set integrator.strategies=on` writes these "
            "pictures of any scene as layers of its EXR.",
            *failed,
        ],
        [sum_verdict(differences)],
        viewers=viewers,
        tables=[Table("strategies", "What each strategy finds", COLUMNS, rows, "In the picture's mean luminance.")],
        downloads=files,
        figures=figures,
    )
