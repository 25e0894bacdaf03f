"""Measure the processor seconds of a first pass by Vulkan with empty caches: nearly all of it compiles shaders."""

import json
import os
import resource
import tempfile
from pathlib import Path

from support.programs import ROOT, SCENES, arguments_of, build, run, write

GOAL_S = 60
# The scenes' own integrators, except for this scene, which is slow to compile with any.
COATS, INTEGRATORS = SCENES / "reference/coated-diffuse.pbrt", ["path", "sppm", "ppm", "photon_map"]


def scenes() -> list[Path]:
    """Every scene file in scenes/: those that no other includes."""
    found = [file for file in sorted(SCENES.glob("*/*.pbrt")) if "WorldBegin" in file.read_text()]
    return [file for file in found if file.stem == "scene"] + [file for file in found if file.stem != "scene"]


def first_pass(folder: Path, scene: Path, integrator: str | None) -> dict:
    """Renders one sample a pixel of a tiny image; returns its cost, the largest shader and the seconds of waiting."""
    with tempfile.TemporaryDirectory() as scratch:
        os.environ["MESA_SHADER_CACHE_DIR"] = scratch
        statistics = Path(scratch) / "stats.json"
        command = [folder / "lampyris", "render", scene, "-o", Path(scratch) / "image.pfm", "--stats", statistics]
        command += ["--backend", "vulkan", "--set", "backend.cache=off", "--resolution", "16x16", "--passes", "1"]
        command += ["--skip-unsupported"]  # of scenes/prism, dispersion
        if integrator:
            command += ["--integrator", integrator]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        run(command)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        stats = json.loads(statistics.read_text())
        return {
            "scene": str(scene.relative_to(ROOT)),
            "integrator": stats["integrator"]["name"],
            "cpu_s": after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime,
            "compile_s": stats["setup_s"]["compile"],
            "spirv_bytes": sum(stats["spirv_bytes"].values()),
        }


def main() -> None:
    """Measure each scene, print a table, and write the same as JSON."""
    arguments = arguments_of(__doc__).parse_args()
    build(arguments.build, "lampyris_program")
    works: list[tuple[Path, str | None]] = [(COATS, name) for name in INTEGRATORS]
    if not arguments.quick:
        works += [(scene, None) for scene in scenes() if scene != COATS]
    print(f"{'scene':44} {'integrator':12} {'CPU s':>6} {'SPIR-V kB':>10}  goal {GOAL_S} s")
    rows = []
    for scene, integrator in works:
        row = first_pass(arguments.build, scene, integrator)
        row["met"] = row["cpu_s"] < GOAL_S
        rows.append(row)
        print(
            f"{row['scene']:44} {row['integrator']:12} {row['cpu_s']:6.1f} {row['spirv_bytes'] / 1000:10.0f}"
            f"  {'met' if row['met'] else 'missed'}",
            flush=True,
        )
    write(arguments.json, "first-pass", rows=rows)


if __name__ == "__main__":
    main()
