"""Measure Vulkan against the CPU backend on the same work: samples per second, and where the time goes."""

from support.programs import SCENES, Work, arguments_of, build, render, write
from support.terrain import terrain

GOAL = 0.25  # of the CPU backend's speed, on lavapipe with as many threads


def works() -> list[Work]:
    """What is rendered."""
    return [
        Work(SCENES / "cornell-box/scene.pbrt", "192x192", 16),
        Work(SCENES / "veach-bidir/scene.pbrt", "192x108", 16),
        Work(SCENES / "water-caustic/scene.pbrt", "192x108", 16),
        Work(SCENES / "coffee/scene.pbrt", "120x160", 8),
        Work(SCENES / "reference/textures.pbrt", "128x128", 16),
        Work(terrain(120_000), "192x192", 16),
        Work(terrain(120_000, glossy=True), "192x192", 16),
    ]


def main() -> None:
    """Render each scene on both backends in turns, print a table, and write the same as JSON."""
    arguments = arguments_of(__doc__).parse_args()
    build(arguments.build, "lampyris_program")
    header = f"{'scene':24} {'CPU s':>7} {'Vulkan s':>9} {'ratio':>6} {'kernel s':>9} {'other s':>8}"
    print(f"{header} {'compile s':>10} {'again s':>8} {'build s':>8} {'SPIR-V kB':>10}  goal {GOAL}")
    rows = []
    for work in works():
        # Before timing: compiled shaders go to Lampyris's and to Mesa's caches, scenes to the page cache.
        small = Work(work.scene, "16x16", 1)
        first = render(arguments.build, small, "--backend", "vulkan", "--set", "backend.cache=off")
        render(arguments.build, small, "--backend", "vulkan")
        pairs = []
        for _ in range(1 if arguments.quick else 3):
            pairs.append([render(arguments.build, work, "--backend", backend) for backend in ("cpu", "vulkan")])
        pairs.sort(key=lambda pair: pair[0]["wall_s"] / pair[1]["wall_s"])
        cpu, vulkan = pairs[len(pairs) // 2]
        kernels = sum(vulkan["kernels"].values())
        row = {
            "scene": work.name,
            "device": vulkan["device"],
            "samples": vulkan["samples"],
            "rays": {"cpu": cpu["rays"], "vulkan": vulkan["rays"]},
            "cpu_s": cpu["wall_s"],
            "vulkan_s": vulkan["wall_s"],
            "ratio": cpu["wall_s"] / vulkan["wall_s"],
            "ratios": [one["wall_s"] / other["wall_s"] for one, other in pairs],
            "kernel_s": kernels,
            "other_s": vulkan["wall_s"] - kernels,
            "compile_s": {"first": first["setup_s"]["compile"], "again": vulkan["setup_s"]["compile"]},
            "build_s": {"cpu": cpu["setup_s"]["build"], "vulkan": vulkan["setup_s"]["build"]},
            "spirv_bytes": sum(vulkan["spirv_bytes"].values()),
            "goal": GOAL,
        }
        row["met"] = row["ratio"] >= GOAL
        rows.append(row)
        print(
            f"{row['scene']:24} {row['cpu_s']:7.2f} {row['vulkan_s']:9.2f} {row['ratio']:6.2f} {kernels:9.2f}"
            f" {row['other_s']:8.2f} {row['compile_s']['first']:10.2f} {row['compile_s']['again']:8.2f}"
            f" {row['build_s']['vulkan']:8.2f} {row['spirv_bytes'] / 1000:10.0f}  {'met' if row['met'] else 'missed'}",
            flush=True,
        )
    write(arguments.json, "backends", rows=rows)


if __name__ == "__main__":
    main()
