"""A small reproduction of experiments, made up: its images, its sections, and the page made from them."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import OpenEXR
from lab.page import build_page
from lab.sections import Axis, Column, Download, Image, Plot, Section, Series, Table, Verdict, Viewer

WIDTH, HEIGHT = 96, 64
NAN_PIXEL = (70, 20)
RED, GREEN = (0.5, 0.02, 0.02), (0.02, 0.5, 0.02)  # the images of path and ppm, apart from a little structure
TEXT = "Errors fall with the time, as `1/N` says; <b>markup</b> stays text."
MACHINE = {"processor": "A processor", "cores": "2", "Vulkan device": "llvmpipe", "version": "lampyris 0.0"}


def write_exr(path: Path, channels: dict[str, np.ndarray], window=None):
    """Write an EXR; `window` is (x, y, width, height of the picture) of a crop."""
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    if window:
        x, y, width, height = window
        rows, columns = next(iter(channels.values())).shape
        header["dataWindow"] = (np.array([x, y], "i4"), np.array([x + columns - 1, y + rows - 1], "i4"))
        header["displayWindow"] = (np.array([0, 0], "i4"), np.array([width - 1, height - 1], "i4"))
    path.parent.mkdir(parents=True, exist_ok=True)
    OpenEXR.File(header, channels).write(str(path))


def picture(colour, seed):
    """A coloured picture with a bright ring and noise."""
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH] / HEIGHT
    ring = np.exp(-(((np.hypot(x - 0.75, y - 0.5) - 0.3) / 0.05) ** 2))
    noise = np.random.default_rng(seed).uniform(0.98, 1.02, (HEIGHT, WIDTH))
    return np.stack([(level + 0.2 * level * ring) * noise for level in colour], axis=-1).astype(np.float32)


def rgb(pixels):
    return {name: np.ascontiguousarray(pixels[..., i]) for i, name in enumerate("RGB")}


def figures_section(runs: list[str]) -> Section:
    steps = [1.0, 4.0, 16.0, 64.0]
    path = Series("path tracing", "path", steps, [0.1, 0.025, 0.006, 0.0016], style="line")
    path.low, path.high = [0.08, 0.02, 0.0, 0.0013], [0.13, 0.03, 0.008, 0.002]
    path.hover = [f"seed=7, passes={int(x)}, backend=cpu, a <tag> & b" for x in steps]
    path.runs = [[key] for key in runs]
    other = Series("PPM", "ppm", steps, [0.05, 0.02, 0.01, 0.006], hover=[f"photons={int(x)}" for x in steps])
    slope = Series("slope −1", "reference", steps, [0.13 / x for x in steps], style="dash")
    bars = [
        Series("build", "build", ["cpu", "vulkan"], [3.0, 1.5]),
        Series("query", "query", ["cpu", "vulkan"], [5.0, 2.5]),
    ]
    return Section(
        "convergence",
        "Error over time",
        "accuracy",
        text=[TEXT],
        verdicts=[
            Verdict("The variance falls as 1/N.", "Slope −0.99.", "yes", source="Veach 1997, 2.4", runs=runs[:2]),
            Verdict("PPM wins.", "Only for caustics.", "partly", why="The radius is large."),
            Verdict("It is free.", "It is not.", "no"),
            Verdict("Needs a GPU.", "There is none.", "not tested"),
        ],
        plots=[
            Plot("error", "relMSE", Axis("seconds", log=True), Axis("relMSE", log=True), [path, other, slope]),
            Plot("time", "Where time goes", Axis(""), Axis("seconds"), bars, bars="stack", caption="Medians."),
        ],
        tables=[
            Table(
                "summary",
                "Summary",
                [
                    Column("method", "Method"),
                    Column("error", "relMSE"),
                    Column("photons", "Photons", "1/pass"),
                    Column("note", "Note"),
                ],
                [
                    {"method": "path", "error": 0.0123456, "photons": 1000000, "note": "a", "runs": runs[:1]},
                    {"method": "ppm", "error": 0.5, "photons": 20, "note": None},
                    {"method": "sppm", "error": None, "photons": 300, "note": "a longer remark about this method"},
                    {"method": "bdpt", "error": 0.002, "photons": 4, "note": "b"},
                ],
            )
        ],
        downloads=[Download("data.csv", "Data (CSV)")],
        answer=Table(
            "answer",
            "Which method for which scene",
            [Column("scene", "scene"), *(Column(f"level_{i}", f"relMSE 1e-{i}") for i in range(1, 5))],
            [
                {
                    "scene": "the box",
                    **{f"level_{i}": "SPPM = path tracing: 0.21\N{NO-BREAK SPACE}s" for i in range(1, 5)},
                }
            ],
        ),
    )


def images_section() -> Section:
    def image(name, **more):
        command = f"lampyris render scenes/box.lamp --integrator {name}:photons=100000 --time 10 --seed 7 -o {name}.exr"
        return Image(name, name, f"runs/{name}/image.exr", command, **more)

    reference = image("reference")
    path = image(
        "path", run="k0", facts="12 passes, 10.0 s", errors={"relmse": 0.0123, "flip": 0.08}, flip_map="maps/flip.exr"
    )
    return Section(
        "images",
        "Images at equal time",
        "effects",
        viewers=[
            Viewer(
                "whole",
                "The whole box",
                [path, image("ppm"), reference],
                "reference",
                link="box",
                caption="Look at the ring.",
            ),
            Viewer("again", "The same, linked", [reference, path], "reference", link="box"),
            Viewer("many", "Many", [replace(path, name=f"SPPM, structure number {i}") for i in range(14)]),
            Viewer("crop", "A crop with a map", [image("crop", error_map="maps/error.exr"), reference], "reference"),
        ],
    )


def made_up_images() -> dict[str, np.ndarray]:
    """The pixels of the images, as they are in the EXRs."""
    path, ppm, reference = picture(RED, 1), picture(GREEN, 2), picture((0.25, 0.25, 0.25), 3)
    path[NAN_PIXEL[1], NAN_PIXEL[0], 1] = np.nan
    reference[10, 10] = 1e9  # beyond the range of a half float
    return {"path": path, "ppm": ppm, "reference": reference}


def section_files(folder: Path) -> list[Path]:
    """The sections, in the order of the page."""
    return [folder / "accuracy/convergence/section.json", folder / "effects/images/section.json"]


def make_reproduction(folder: Path, images: dict[str, np.ndarray]) -> None:
    """Fill a folder as the experiments leave it, and make its page."""
    for name, pixels in images.items():
        write_exr(folder / f"runs/{name}/image.exr", {**rgb(pixels), "albedo.R": pixels[..., 0] * 0 + 1})
    write_exr(folder / "runs/crop/image.exr", rgb(images["path"][8:40, 16:64].copy()), window=(16, 8, WIDTH, HEIGHT))
    write_exr(folder / "maps/error.exr", {"Y": np.full((32, 48), 1.0, np.float32)}, window=(16, 8, WIDTH, HEIGHT))
    write_exr(folder / "maps/flip.exr", {"Y": np.linspace(0, 1, WIDTH * HEIGHT, dtype="f4").reshape(HEIGHT, WIDTH)})
    runs = [f"k{i}" for i in range(4)]
    for key in runs[:3]:  # one has no record: the page does without
        (folder / "runs" / key).mkdir(parents=True)
        spec = {"seed": 0, "key": key, "long": "x" * 999, "none": None}
        record = {"command": ["lampyris", "render", "a scene.lamp"], "spec": spec}
        (folder / f"runs/{key}/run.json").write_text(json.dumps(record))
    figures_section(runs).write(folder / "accuracy/convergence")
    (folder / "accuracy/convergence/data.csv").write_text("a,b\n")
    images_section().write(folder / "effects/images")
    build_page(folder, section_files(folder), MACHINE)
