"""The paper's opening: one scene that specular-diffuse-specular paths light, under every method in equal time."""

from pathlib import Path

from lab import equal_time
from lab.figures import downloads, figure, tikz_grid
from lab.images import encode, exposure_of
from lab.reports import reference_text, show_picture, write_csv
from lab.runs import Run
from lab.sections import Download, Section
from lab.store import Store
from lab.target import Plan
from matplotlib.patches import Rectangle
from parallel_ppm_2010.robustness import better_verdict

FRAMES = ["#D55E00", "#56B4E9", "#009E73"]


def runs(plan: Plan) -> list[Run]:
    """Every method on the scene."""
    return [case.run(plan) for case in equal_time.cases(plan)]


def crop_pixels(share: list[float], height: int, width: int) -> tuple[int, int, int, int]:
    """A crop x0, y0, x1, y1 in pixels, of its shares of the picture."""
    return round(share[0] * width), round(share[1] * height), round(share[2] * width), round(share[3] * height)


def draw_figure(plan: Plan, store: Store, folder: Path, found: list[equal_time.Outcome]) -> None:
    """The whole pictures above, their crops below."""
    pictures = equal_time.pictures_of(store, folder, plan.scenes[0], found)
    exposure = exposure_of(pictures[-1][1])
    count = 1 + len(plan["crops"])
    with figure(folder, "opening", (1.6 * len(pictures), 1.25 * count + 0.4), count, len(pictures)) as (_, axes):
        for column, (title, image) in zip(axes.T, pictures, strict=True):
            show_picture(column[0], image, title, exposure)
            for i, (one, share) in enumerate(zip(column[1:], plan["crops"], strict=True)):
                x0, y0, x1, y1 = crop_pixels(share, *image.shape[:2])
                colour = FRAMES[i % len(FRAMES)]
                frame = {"fill": False, "edgecolor": colour, "linewidth": 1.0}
                patch = column[0].add_patch
                patch(Rectangle((x0 - 0.5, y0 - 0.5), x1 - x0, y1 - y0, **frame))
                show_picture(one, image[y0:y1, x0:x1], "", exposure)
                one.add_patch(Rectangle((-0.5, -0.5), x1 - x0, y1 - y0, **{**frame, "linewidth": 2.0}))


def write_tikz(plan: Plan, store: Store, folder: Path, found: list[equal_time.Outcome]) -> Download:
    """The crops, a row for each, as a paper includes them."""
    pictures = equal_time.pictures_of(store, folder, plan.scenes[0], found)
    exposure = exposure_of(pictures[-1][1])
    rows = []
    for share in plan["crops"]:
        boxes = [(image, crop_pixels(share, *image.shape[:2])) for _, image in pictures]
        rows.append([encode(image[y0:y1, x0:x1], exposure) for image, (x0, y0, x1, y1) in boxes])
    return tikz_grid(folder, "opening", [title.replace("\n", ", ") for title, _ in pictures], rows, 17.0)


def report(plan: Plan, store: Store, folder: Path) -> Section:
    """The pictures, a table of errors and the verdict."""
    found = equal_time.outcomes(plan, store, folder)
    rows = equal_time.rows_of(found)
    files = [write_csv(folder / "opening.csv", rows)]
    if found:
        draw_figure(plan, store, folder, found)
        files += [*downloads("opening", "images and crops"), write_tikz(plan, store, folder, found)]
    claim = "Where all light takes specular-diffuse-specular paths, only progressive photon mapping shows it"
    text = [
        f"{plan['time_s']} s of rendering for each method, set-up not counted.",
        "The paper's figure has path tracing, bidirectional path tracing, Metropolis light transport and progressive "
        "photon mapping; the other methods are here besides.",
        *(reference_text(scene, store) for scene in plan.scenes if found),
    ]
    return Section(
        plan.name,
        plan["title"],
        plan.experiment,
        text,
        [better_verdict(found, plan["progressive"], plan["against"], claim)],
        equal_time.plots_of(plan, found),
        equal_time.viewers_of(plan, store, folder, found),
        [equal_time.table_of(rows)],
        files,
    )
