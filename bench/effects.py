"""Measure what effects cost that a scene does not call for: instructions on the CPU, shader size and time on Vulkan."""

import json
import re
import tempfile
from pathlib import Path

from support.programs import SCENES, Work, arguments_of, build, render, run, write

GOAL = 0.01  # more instructions than a build that never heard of the other effects
# Each needs different effects; effects_path.radiance.h has a build for exactly the effects of each.
CPU_SCENES = ["diffuse", "dielectric-smooth", "textures", "coated-diffuse", "infinite-image"]


def instructions(program: Path, scene: Path, size: str, which: str) -> dict:
    """Instructions of the measured kernel under callgrind, apart from Embree, which traces the same rays in both."""
    with tempfile.TemporaryDirectory() as scratch:
        profile = Path(scratch) / "callgrind.out"
        command = ["valgrind", "--tool=callgrind", "--collect-atstart=no", "--toggle-collect=lampyris_measured_kernel"]
        result = run([*command, f"--callgrind-out-file={profile}", program, scene, size, "1", which])
        counts = {"kernel": 0, "embree": 0}
        objects: dict[str, str] = {}
        inside, called = "kernel", False
        for line in profile.read_text().splitlines():
            if line.startswith("ob="):
                number, _, name = line[3:].partition(" ")
                objects.setdefault(number, name)
                inside = "embree" if "libembree" in objects[number] else "kernel"
            elif line.startswith("cob="):
                number, _, name = line[4:].partition(" ")
                if name:
                    objects.setdefault(number, name)
            elif line.startswith("calls="):
                called = True  # the next line is the callee's cost, which is counted in the callee
            elif re.match(r"[0-9+*-]", line):
                if not called:
                    counts[inside] += int(line.split()[-1])
                called = False
        return {**json.loads(result.stdout.splitlines()[-1]), **counts}


def on_cpu(folder: Path, quick: bool) -> list[dict]:
    """The build that the program picks against one for exactly the scene's effects, on one thread."""
    size = "16x16" if quick else "48x48"
    print(
        f"{'CPU: scene':20} {'rays':>8} {'instructions per ray':>21} {'exact build':>12}"
        f" {'more':>7} {'same image':>11}  goal {GOAL:.0%}"
    )
    rows = []
    for name in CPU_SCENES:
        scene = SCENES / "reference" / f"{name}.pbrt"
        picked = instructions(folder / "effects_bench", scene, size, "registered")
        exact = instructions(folder / "effects_bench", scene, size, "exact")
        row = {
            "scene": name,
            "effects": picked["effects"],
            "rays": picked["rays"],
            "instructions": picked["kernel"],
            "exact_instructions": exact["kernel"],
            "embree_instructions": picked["embree"],
            "more": picked["kernel"] / exact["kernel"] - 1,
            "same_image": picked["film_hash"] == exact["film_hash"],
        }
        row["met"] = row["more"] <= GOAL and row["same_image"]
        rows.append(row)
        print(
            f"{name:20} {row['rays']:8} {row['instructions'] / row['rays']:21.0f}"
            f" {row['exact_instructions'] / row['rays']:12.0f} {row['more']:+7.1%}"
            f" {'yes' if row['same_image'] else 'NO':>11}  {'met' if row['met'] else 'missed'}",
            flush=True,
        )
    print()
    return rows


def on_vulkan(folder: Path, repeats: int) -> list[dict]:
    """Shaders for the scene's effects only against shaders for all: size, and time in turns.

    The shader for all effects takes minutes to compile, so it is not a part of every run.
    """
    print(
        f"{'Vulkan: scene':20} {'SPIR-V kB':>10} {'all':>6} {'compile s':>10} {'all':>6}"
        f" {'render s':>9} {'all':>6} {'all / exact':>12}"
    )
    rows = []
    for work in [
        Work(SCENES / "cornell-box/scene.pbrt", "128x128", 8),
        Work(SCENES / "reference/textures.pbrt", "128x128", 8),
        Work(SCENES / "water-caustic/scene.pbrt", "192x108", 8),
        Work(SCENES / "coffee/scene.pbrt", "90x120", 4),
    ]:
        options = {"exact": ["--backend", "vulkan"], "all": ["--backend", "vulkan", "--set", "backend.specialise=off"]}
        row: dict = {"scene": work.name}
        for which, words in options.items():
            small = Work(work.scene, "16x16", 1)
            first = render(folder, small, *words, "--set", "backend.cache=off")
            row[which] = {"compile_s": first["setup_s"]["compile"], "spirv_bytes": sum(first["spirv_bytes"].values())}
            render(folder, small, *words)
        times: dict[str, list[float]] = {"exact": [], "all": []}
        for _ in range(repeats):
            for which, words in options.items():
                times[which].append(render(folder, work, *words)["wall_s"])
        for which, seconds in times.items():
            row[which]["wall_s"] = min(seconds)
        ratios = sorted(every / exact for every, exact in zip(times["all"], times["exact"], strict=True))
        row["time_ratio"] = ratios[len(ratios) // 2]
        rows.append(row)
        exact, every = row["exact"], row["all"]
        print(
            f"{work.name:20} {exact['spirv_bytes'] / 1000:10.0f} {every['spirv_bytes'] / 1000:6.0f}"
            f" {exact['compile_s']:10.2f} {every['compile_s']:6.2f}"
            f" {exact['wall_s']:9.2f} {every['wall_s']:6.2f} {row['time_ratio']:12.2f}",
            flush=True,
        )
    return rows


def main() -> None:
    """Run both measurements, print tables, and write the same as JSON."""
    parser = arguments_of(__doc__)
    parser.add_argument(
        "--every-effect", action="store_true", help="Vulkan: compare with shaders for all effects (minutes)"
    )
    arguments = parser.parse_args()
    build(arguments.build, "effects_bench", "lampyris_program")
    cpu = on_cpu(arguments.build, arguments.quick)
    vulkan = on_vulkan(arguments.build, 1 if arguments.quick else 3) if arguments.every_effect else []
    write(arguments.json, "effects", cpu=cpu, vulkan=vulkan)


if __name__ == "__main__":
    main()
