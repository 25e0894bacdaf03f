#!/usr/bin/env python3
"""Renders the demo scene on both backends, compares the images, and writes a page that shows them.

Run by ./dev demo; needs nothing but Python's standard library and the program.
"""

import argparse
import array
import base64
import html
import json
import string
import subprocess
import sys
from pathlib import Path

BACKENDS = {"cpu": "CPU", "vulkan": "Vulkan"}
ROOT = Path(__file__).resolve().parent.parent
SCENE = ROOT / "scenes/demo/scene.pbrt"
REFERENCE = ROOT / "scenes/demo/reference.exr"  # and .png
PAGE = ROOT / "tools/demo.html"


def call(program, *arguments, capture=False):
    done = subprocess.run(
        [program, *map(str, arguments)], stdout=subprocess.PIPE if capture else None, text=True, check=False
    )
    if done.returncode:
        sys.exit(done.returncode)  # the program has said why
    return done.stdout


def read_floats(path):
    """The values of a little-endian RGB PFM, bottom row first."""
    with open(path, "rb") as file:
        for _ in range(3):
            file.readline()
        values = array.array("f", file.read())
    if sys.byteorder == "big":
        values.byteswap()
    return values


def equal_share(a, b):
    """The share of pixels that are equal to the bit."""
    pixels = len(a) // 3
    return sum(a[3 * i : 3 * i + 3] == b[3 * i : 3 * i + 3] for i in range(pixels)) / pixels


def render(program, folder, backend, samples):
    outputs = [word for suffix in ["exr", "png", "pfm"] for word in ["-o", folder / f"{backend}.{suffix}"]]
    stats = folder / f"{backend}.json"
    spp = ["--spp", samples] if samples else []
    call(program, "render", SCENE, *outputs, "--backend", backend, "--stats", stats, *spp, capture=True)
    return json.loads(stats.read_text())


def compare(program, folder, image, reference, error_image):
    text = call(program, "compare", image, reference, "--json", "--error-image", folder / error_image, capture=True)
    return json.loads(text)


def rows(stats, errors):
    """The comparison: (what, [a value for each backend], how it is meant)."""
    runs = [stats[backend] for backend in BACKENDS]
    against = [errors[backend] for backend in BACKENDS]
    setup = [sum(run["setup_s"].values()) for run in runs]
    return [
        ("device", [run["device"] for run in runs], ""),
        ("rendering", [f"{run['wall_s']:.1f} s" for run in runs], "wall-clock seconds, without set-up"),
        ("set-up", [f"{seconds:.1f} s" for seconds in setup], "reading, building, compiling"),
        ("samples per pixel", [f"{run['samples_per_pixel']:g}" for run in runs], ""),
        ("rays", [f"{run['rays'] / 1e6:.1f} M" for run in runs], "shadow rays included"),
        ("rays per second", [f"{run['rays'] / run['wall_s'] / 1e6:.2f} M" for run in runs], ""),
        ("relMSE", [f"{error['relmse']:.4f}" for error in against], "mean of (I - R)² / (R² + 0.01), to the reference"),
        ("FLIP", [f"{error['flip']:.4f}" for error in against], "perceived difference to the reference"),
        (
            "mean",
            [f"{sum(e['mean']) / sum(e['reference_mean']):.4f}" for e in against],
            "as a share of the reference's",
        ),
    ]


def print_table(table, equal):
    names = list(BACKENDS.values())
    figures = table[1:]  # the first row, the devices' names, is too wide for a column
    width = max(len(row[0]) for row in figures)
    columns = [max(len(names[i]), *(len(row[1][i]) for row in figures)) for i in range(len(names))]
    for name, device in zip(names, table[0][1], strict=True):
        print(f"{name}: {device}")
    print()
    print(" " * width, *(name.rjust(size) for name, size in zip(names, columns, strict=True)), sep="  ")
    for name, values, meaning in figures:
        cells = [value.rjust(size) for value, size in zip(values, columns, strict=True)]
        print(name.ljust(width), *cells, meaning, sep="  ")
    print(f"\n{equal:.2%} of the pixels are equal to the bit on both backends.")


def embedded(path):
    return "data:image/png;base64," + base64.b64encode(path.read_bytes()).decode()


def write_page(folder, stats, table, equal):
    head = "".join(f'<th scope="col">{name}</th>' for name in BACKENDS.values())
    body = ""
    for name, values, meaning in table:
        cells = "".join(f"<td>{html.escape(value)}</td>" for value in values)
        note = f"<small>{html.escape(meaning)}</small>" if meaning else ""
        body += f'<tr><th scope="row">{html.escape(name)}{note}</th>{cells}</tr>\n'
    effects = ""
    for effect in stats["cpu"]["effects"]:
        asked_by = effect["asked_by"].removeprefix(f"{SCENE.parent}/")
        effects += f"<li><b>{html.escape(effect['name'])}</b> <span>{html.escape(asked_by)}</span></li>\n"
    values = {
        "cpu": embedded(folder / "cpu.png"),
        "vulkan": embedded(folder / "vulkan.png"),
        "reference": embedded(REFERENCE.with_suffix(".png")),
        "error": embedded(folder / "error.png"),
        "difference": embedded(folder / "difference.png"),
        "width": str(stats["cpu"]["resolution"][0]),
        "height": str(stats["cpu"]["resolution"][1]),
        "samples": f"{stats['cpu']['samples_per_pixel']:g}",
        "equal": f"{equal:.2%}",
        "head": head,
        "body": body,
        "effects": effects,
        "version": html.escape(str(stats["cpu"]["version"])),
    }
    (folder / "index.html").write_text(string.Template(PAGE.read_text()).substitute(values))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=Path, default=ROOT / "build/release/lampyris")
    parser.add_argument("--output", type=Path, default=ROOT / "build/demo", help="folder to write into")
    parser.add_argument("--spp", type=int, help="samples per pixel, instead of the scene's")
    options = parser.parse_args()
    program, folder = options.program.resolve(), options.output
    folder.mkdir(parents=True, exist_ok=True)

    stats, errors = {}, {}
    for backend, name in BACKENDS.items():
        print(f"Rendering on {name}", flush=True)
        stats[backend] = render(program, folder, backend, options.spp)
        errors[backend] = compare(program, folder, folder / f"{backend}.exr", REFERENCE, "error.png")
    compare(program, folder, folder / "vulkan.exr", folder / "cpu.exr", "difference.png")
    equal = equal_share(read_floats(folder / "cpu.pfm"), read_floats(folder / "vulkan.pfm"))

    table = rows(stats, errors)
    print_table(table, equal)
    write_page(folder, stats, table, equal)
    print(f"Images and figures: {folder}; the page: {(folder / 'index.html').resolve().as_uri()}")


if __name__ == "__main__":
    main()
