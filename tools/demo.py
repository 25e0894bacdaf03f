#!/usr/bin/env python3
"""Renders the demo scene by two methods in equal time on both backends, and writes a page that compares them.

Run by ./dev demo; needs only Python's standard library and the program.
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
METHODS = {"path": "path", "sppm": "sppm:photonsperiteration=500000"}  # as --integrator takes them
RUNS = [(method, backend) for backend in BACKENDS for method in METHODS]
ROOT = Path(__file__).resolve().parent.parent
SCENE = ROOT / "scenes/demo/scene.pbrt"
REFERENCE = ROOT / "scenes/demo/reference.exr"  # and .png
PAGE = ROOT / "tools/demo.html"
AGREEMENT_PASSES = 2


def call(program, *arguments, capture=False):
    done = subprocess.run(
        [program, *map(str, arguments)], stdout=subprocess.PIPE if capture else None, text=True, check=False
    )
    if done.returncode:
        sys.exit(done.returncode)  # the program has printed the reason
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


def render(program, folder, name, method, backend, budget):
    outputs = [word for suffix in ["exr", "png", "pfm"] for word in ["-o", folder / f"{name}.{suffix}"]]
    stats = folder / f"{name}.json"
    choice = ["--integrator", METHODS[method], "--backend", backend]
    call(program, "render", SCENE, *outputs, *choice, "--stats", stats, *budget, capture=True)
    return json.loads(stats.read_text())


def compare(program, folder, image, reference, error_image):
    text = call(program, "compare", image, reference, "--json", "--error-image", folder / error_image, capture=True)
    return json.loads(text)


def rows(stats, errors):
    """The comparison: (name, [a value for each run], explanation)."""
    runs = [stats[run] for run in RUNS]
    against = [errors[run] for run in RUNS]
    setup = [sum(run["setup_s"].values()) for run in runs]
    return [
        ("rendering", [f"{run['wall_s']:.1f} s" for run in runs], "wall-clock seconds, without set-up"),
        ("set-up", [f"{seconds:.1f} s" for seconds in setup], "reading, building, compiling"),
        ("passes", [f"{run['passes']}" for run in runs], "one sample per pixel each"),
        ("rays", [f"{run['rays'] / 1e6:.1f} M" for run in runs], "shadow rays included"),
        ("photon paths", [f"{run['photons_emitted'] / 1e6:.1f} M" for run in runs], ""),
        ("relMSE", [f"{error['relmse']:.4f}" for error in against], "mean of (I - R)² / (R² + 0.01), to the reference"),
        ("FLIP", [f"{error['flip']:.4f}" for error in against], "perceived difference to the reference"),
        (
            "mean",
            [f"{sum(e['mean']) / sum(e['reference_mean']):.4f}" for e in against],
            "as a share of the reference's",
        ),
    ]


def agreement(equal):
    return f"{equal:.2%} of the pixels are equal to the bit on both backends (sppm, {AGREEMENT_PASSES} passes)."


def print_table(stats, table, equal):
    for backend, name in BACKENDS.items():
        print(f"{name}: {stats['sppm', backend]['device']}")
    width = max(len(row[0]) for row in table)
    columns = [max(6, *(len(row[1][i]) for row in table)) for i in range(len(RUNS))]
    heads = [[BACKENDS[backend] for _, backend in RUNS], [method for method, _ in RUNS]]
    print()
    for name, values, meaning in [*(("", head, "") for head in heads), *table]:
        cells = [value.rjust(size) for value, size in zip(values, columns, strict=True)]
        print(name.ljust(width), *cells, meaning, sep="  ")
    print(f"\n{agreement(equal)}")


def embedded(path):
    return "data:image/png;base64," + base64.b64encode(path.read_bytes()).decode()


def caption(stats, error):
    return f"{stats['wall_s']:.1f} s, {stats['passes']} passes: relMSE {error['relmse']:.3f}, FLIP {error['flip']:.3f}"


def write_page(folder, stats, errors, table, equal):
    body = ""
    for name, values, meaning in table:
        cells = "".join(f"<td>{html.escape(value)}</td>" for value in values)
        note = f"<small>{html.escape(meaning)}</small>" if meaning else ""
        body += f'<tr><th scope="row">{html.escape(name)}{note}</th>{cells}</tr>\n'
    effects = ""
    for effect in stats["sppm", "cpu"]["effects"]:
        asked_by = effect["asked_by"].removeprefix(f"{SCENE.parent}/")
        effects += f"<li><b>{html.escape(effect['name'])}</b> <span>{html.escape(asked_by)}</span></li>\n"
    values = {
        "reference": embedded(REFERENCE.with_suffix(".png")),
        "difference": embedded(folder / "difference.png"),
        "width": str(stats["sppm", "cpu"]["resolution"][0]),
        "height": str(stats["sppm", "cpu"]["resolution"][1]),
        "seconds": f"{stats['sppm', 'cpu']['wall_s']:.0f}",
        "agreement": agreement(equal),
        "body": body,
        "effects": effects,
        "sppm": METHODS["sppm"],
        "version": html.escape(str(stats["sppm", "cpu"]["version"])),
    }
    for method, backend in RUNS:
        values[f"{method}_{backend}"] = embedded(folder / f"{method}-{backend}.png")
        if backend == "cpu":
            values[f"{method}_{backend}_error"] = embedded(folder / f"{method}-{backend}-error.png")
        values[f"{method}_{backend}_caption"] = caption(stats[method, backend], errors[method, backend])
        values[f"{backend}_device"] = html.escape(stats[method, backend]["device"])
    (folder / "index.html").write_text(string.Template(PAGE.read_text()).substitute(values))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=Path, default=ROOT / "build/release/lampyris")
    parser.add_argument("--output", type=Path, default=ROOT / "build/demo", help="folder to write into")
    parser.add_argument("--seconds", type=float, default=12, help="what each method may take on each backend")
    parser.add_argument("--passes", type=int, help="passes of each method, instead of a time")
    options = parser.parse_args()
    program, folder = options.program.resolve(), options.output
    folder.mkdir(parents=True, exist_ok=True)
    budget = ["--passes", options.passes] if options.passes else ["--time", f"{options.seconds}s"]

    # This comes first, because it compiles kernels that the other runs reuse.
    print(
        f"Rendering {AGREEMENT_PASSES} passes of sppm on each backend; Vulkan compiles its shaders at first", flush=True
    )
    for backend in BACKENDS:
        render(program, folder, f"agreement-{backend}", "sppm", backend, ["--passes", AGREEMENT_PASSES])
    compare(program, folder, folder / "agreement-vulkan.exr", folder / "agreement-cpu.exr", "difference.png")
    equal = equal_share(*(read_floats(folder / f"agreement-{backend}.pfm") for backend in BACKENDS))

    stats, errors = {}, {}
    for method, backend in RUNS:
        print(f"Rendering by {method} on {BACKENDS[backend]}", flush=True)
        name = f"{method}-{backend}"
        stats[method, backend] = render(program, folder, name, method, backend, budget)
        errors[method, backend] = compare(program, folder, folder / f"{name}.exr", REFERENCE, f"{name}-error.png")

    table = rows(stats, errors)
    print_table(stats, table, equal)
    write_page(folder, stats, errors, table, equal)
    print(f"Images and figures: {folder}; the page: {(folder / 'index.html').resolve().as_uri()}")


if __name__ == "__main__":
    main()
