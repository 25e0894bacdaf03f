"""Measure how cost grows with triangles and falls with threads, and what it costs to set a scene up."""

import math
import os

from support.programs import SCENES, Work, arguments_of, build, render, write
from support.terrain import terrain


def fit(points: list[tuple[float, float]]) -> float:
    """The exponent of y ~ x^k, by least squares in logarithms."""
    logarithms = [(math.log(x), math.log(y)) for x, y in points]
    mean_x = sum(x for x, _ in logarithms) / len(logarithms)
    mean_y = sum(y for _, y in logarithms) / len(logarithms)
    covariance = sum((x - mean_x) * (y - mean_y) for x, y in logarithms)
    return covariance / sum((x - mean_x) ** 2 for x, _ in logarithms)


def best(folder, work: Work, repeats: int, *options: str) -> dict:
    """The fastest of a few runs, because other work of the machine can only add time."""
    return min((render(folder, work, *options) for _ in range(repeats)), key=lambda result: result["wall_s"])


def triangles(folder, repeats: int, largest: int) -> dict:
    """Cost per sample against the number of triangles; the same hills, cut finer.

    The cost is in processor time on one thread, which other programs disturb less than wall-clock time. It is the time
    of many samples minus that of one, so that set-up cancels.
    """
    print(
        f"{'triangles':>10} {'CPU us/sample':>14} {'rays per sample':>16} {'parse s':>8}"
        f" {'build s':>8} {'memory MB':>10}"
    )
    rows = []
    for count in [10**digits for digits in range(3, 8) if 10**digits <= largest]:
        scene, options = terrain(count), ["--backend", "cpu", "--threads", "1"]
        seconds = []
        for _ in range(repeats):
            one = render(folder, Work(scene, "256x256", 1), *options)
            result = render(folder, Work(scene, "256x256", 17), *options)
            seconds.append(max(result["cpu_s"] - one["cpu_s"], 1e-9))
        row = {
            "triangles": count,
            "us_per_sample": 1e6 * min(seconds) / (result["samples"] - one["samples"]),
            "rays_per_sample": result["rays"] / result["samples"],
            "setup_s": result["setup_s"],
            "peak_memory_bytes": result["peak_memory_bytes"],
        }
        rows.append(row)
        print(
            f"{count:10} {row['us_per_sample']:14.3f} {row['rays_per_sample']:16.2f} {result['setup_s']['parse']:8.2f}"
            f" {result['setup_s']['build']:8.2f} {result['peak_memory_bytes'] / 1e6:10.0f}",
            flush=True,
        )
    cost = [(row["triangles"], row["us_per_sample"] / row["rays_per_sample"]) for row in rows]
    exponents = {
        "of_log_triangles": fit([(math.log(count), value) for count, value in cost]),
        "of_triangles": fit(cost),
    }
    print(
        f"cost per ray ~ log(triangles)^{exponents['of_log_triangles']:.2f}"
        f", or triangles^{exponents['of_triangles']:.3f} (goal: near-logarithmic:"
        " the first near 1, the second near 0)\n"
    )
    return {"rows": rows, "exponents": exponents}


def threads(folder, repeats: int) -> list[dict]:
    """Speed against threads, one more than there are processors included: it must not collapse."""
    print(f"{'scene':16} {'threads':>7} {'wall s':>7} {'speed-up':>9} {'efficiency':>11}")
    rows = []
    processors = os.cpu_count() or 1
    counts = sorted({2**power for power in range(0, 8) if 2**power <= processors} | {processors, 2 * processors})
    for work in [Work(SCENES / "cornell-box/scene.pbrt", "192x192", 16), Work(terrain(100_000), "192x192", 16)]:
        alone = None
        for count in counts:
            result = best(folder, work, repeats, "--backend", "cpu", "--threads", str(count))
            alone = alone or result["wall_s"]
            speedup = alone / result["wall_s"]
            row = {"scene": work.name, "threads": count, "wall_s": result["wall_s"], "speedup": speedup}
            row["efficiency"] = speedup / min(count, processors)
            rows.append(row)
            print(f"{work.name:16} {count:7} {row['wall_s']:7.2f} {speedup:9.2f} {row['efficiency']:11.2f}", flush=True)
    print()
    return rows


def setup(folder) -> list[dict]:
    """Seconds before the first sample. Vulkan compiles anew: without caches (first) and with them (again)."""
    print(f"{'scene':16} {'backend':8} {'parse s':>8} {'scene s':>8} {'build s':>8} {'compile s':>10} {'again s':>8}")
    rows = []
    for scene in sorted(SCENES.glob("*/scene.pbrt")):
        for backend in ("cpu", "vulkan"):
            work = Work(scene, "16x16", 1)
            options = ["--backend", backend, "--skip-unsupported"]
            uncached = ["--set", "backend.cache=off"] if backend == "vulkan" else []
            seconds = render(folder, work, *options, *uncached)["setup_s"]
            render(folder, work, *options)
            again = render(folder, work, *options)["setup_s"]
            rows.append({"scene": work.name, "backend": backend, **seconds, "compile_again": again["compile"]})
            print(
                f"{work.name:16} {backend:8} {seconds['parse']:8.3f} {seconds['scene']:8.3f} {seconds['build']:8.3f}"
                f" {seconds['compile']:10.3f} {again['compile']:8.3f}",
                flush=True,
            )
    return rows


def main() -> None:
    """Run the three measurements, print tables, and write the same as JSON."""
    parser = arguments_of(__doc__)
    parser.add_argument(
        "--largest", type=int, default=1_000_000, help="triangles of the largest scene; 10000000 takes minutes"
    )
    arguments = parser.parse_args()
    build(arguments.build, "lampyris_program")
    repeats = 1 if arguments.quick else 3
    results = {
        "triangles": triangles(arguments.build, repeats, arguments.largest),
        "threads": threads(arguments.build, repeats),
        "setup": setup(arguments.build),
    }
    write(arguments.json, "scaling", **results)


if __name__ == "__main__":
    main()
