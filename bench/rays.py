"""Rays per second of `path` in vectors as a share of bare Embree: the same rays, threads and process, in turns."""

import json
import os

from support.programs import SCENES, arguments_of, build, run, write
from support.terrain import terrain

# Scene, image, samples per pixel, goal for the share (none: reported only; tracing does not dominate there).
DIFFUSE_GOAL, GLOSSY_GOAL = 0.75, 0.6


def works() -> list[tuple]:
    """What is measured."""
    return [
        ("terrain, diffuse", terrain(120_000), "128x128", 4, DIFFUSE_GOAL),
        ("terrain, diffuse, 1M", terrain(1_000_000), "128x128", 4, DIFFUSE_GOAL),
        ("terrain, textured and glossy", terrain(120_000, glossy=True), "128x128", 4, GLOSSY_GOAL),
        ("water-caustic", SCENES / "water-caustic/scene.pbrt", "128x72", 4, GLOSSY_GOAL),
        ("coffee", SCENES / "coffee/scene.pbrt", "90x120", 4, GLOSSY_GOAL),
        ("cornell-box", SCENES / "cornell-box/scene.pbrt", "96x96", 4, None),
        ("veach-bidir", SCENES / "veach-bidir/scene.pbrt", "128x72", 4, None),
    ]


def main() -> None:
    """Run rays_bench on every scene, print a table, and write the same as JSON."""
    parser = arguments_of(__doc__)
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    arguments = parser.parse_args()
    build(arguments.build, "rays_bench")
    print(
        f"{'scene':30} {'triangles':>9} {'path Mrays/s':>13} {'scalar':>7} {'Embree Mrays/s':>15} {'packets':>8}"
        f" {'share':>6} {'from':>5} {'to':>5} {'goal':>5}"
    )
    rows = []
    for name, scene, size, samples, goal in works():
        repeats = 3 if arguments.quick else 7
        result = run([arguments.build / "rays_bench", scene, size, samples, arguments.threads, repeats])
        row = {"name": name, **json.loads(result.stdout), "goal": goal}
        row["scene"] = scene.name if scene.stem != "scene" else scene.parent.name
        row["met"] = None if goal is None else row["share"] >= goal
        rows.append(row)
        print(
            f"{name:30} {row['primitives']:9} {row['path_mrays_per_s']:13.3f} {row['scalar_mrays_per_s']:7.3f}"
            f" {row['embree_mrays_per_s']:15.3f} {row['packets_mrays_per_s']:8.3f}"
            f" {row['share']:6.2f} {row['share_min']:5.2f} {row['share_max']:5.2f}"
            f" {'' if goal is None else f'{goal:.2f}':>5} {'' if goal is None else 'met' if row['met'] else 'missed'}",
            flush=True,
        )
    write(arguments.json, "rays", rows=rows)


if __name__ == "__main__":
    main()
