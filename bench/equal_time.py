"""Measure what decides between photon-query structures: the error of sppm after the same time with each of them.

The same scenes, photons per pass and (memoryless) radii for every structure, so that equal passes are equal radii; what
differs is how many passes fit into the time, and the noise of a stochastic structure. References: `sds-lamp` has a path
tracer's; the others are long runs of sppm with other seeds, whose own noise and blur is what the last columns end at.
"""

import hashlib
import json
import statistics
from dataclasses import dataclass
from pathlib import Path

from support.programs import SCENES, arguments_of, build, generated_folder, run, write

BASELINE = "sorted_grid"
STOCHASTIC = ["stochastic_hash:slots=4", "stochastic_hash:table_size=0.015625"]  # beside every structure's defaults
OMITTED = ["brute_force"]  # right by definition, and slow


@dataclass
class Case:
    """A scene at a size, with photons emitted a pass."""

    name: str
    scene: Path
    size: str
    photons: int
    reference: Path | None = None

    def integrator(self) -> str:
        """The integrator that uses each structure."""
        return f"sppm:schedule=memoryless,photonsperiteration={self.photons}"


def cases() -> list[Case]:
    """What is rendered."""
    reference = SCENES / "reference"
    return [
        Case("sds-lamp", reference / "sds-lamp.pbrt", "128x128", 60_000, reference / "sds-lamp-path.exr"),
        Case("box", SCENES / "box/scene.pbrt", "160x120", 100_000),
        Case("pool", SCENES / "pool/scene.pbrt", "160x120", 100_000),
    ]


def structures(program: Path) -> list[str]:
    """Every structure that the program has, with its defaults, and the stochastic one's variants."""
    text = run([program, "plugins", "photon-map", "--json"]).stdout
    names = [plugin["name"] for plugin in json.loads(text)["kinds"][0]["plugins"]]
    return [name for name in names if name not in OMITTED] + STOCHASTIC


def render(program: Path, case: Case, image: Path, *options: str) -> dict:
    """Render into `image`; returns the statistics."""
    stats = image.with_suffix(".json")
    command = [program, "render", case.scene, "-o", image, "--stats", stats, "--resolution", case.size, "--quiet"]
    run([*command, "--integrator", case.integrator(), *options])
    return json.loads(stats.read_text())


def reference_of(program: Path, case: Case, seconds: float) -> Path:
    """The scene's reference image, or a long run that is kept for as long as nothing about it changes."""
    if case.reference:
        return case.reference
    version = run([program, "--version"]).stdout
    what = [version, case.scene.read_text(), case.size, case.integrator(), seconds]
    key = hashlib.sha256(json.dumps(what).encode()).hexdigest()[:16]
    image = generated_folder() / f"reference-{case.name}-{key}.exr"
    if not image.exists():
        unfinished = image.with_name("unfinished.exr")
        options = ["--photon-map", BASELINE, "--seed", "77", "--time", f"{seconds}s"]
        render(program, case, unfinished, *options)
        unfinished.rename(image)
    return image


def error_of(program: Path, image: Path, reference: Path) -> dict:
    """Every metric of an image."""
    return json.loads(run([program, "compare", image, reference, "--json"]).stdout)


def measure(program: Path, case: Case, reference: Path, choice: str, backend: str, seconds: float, seeds: int) -> dict:
    """Render with several seeds for the same time; medians."""
    image = generated_folder() / "equal-time.exr"
    options = ["--photon-map", choice, "--backend", backend]
    render(program, case, image, *options, "--passes", "2")  # compiles shaders
    runs = []
    for seed in range(1, seeds + 1):
        stats = render(program, case, image, *options, "--time", f"{seconds}s", "--seed", str(seed))
        errors = error_of(program, image, reference)
        phases = stats["phases"]
        total = sum(phases.values())
        runs.append(
            {
                "passes": stats["passes"],
                "relmse": errors["relmse"],
                "relmse_trimmed": errors["relmse_trimmed"],
                "wall_s": stats["wall_s"],
                "map_share": (phases["construction"] + phases["gathering"]) / total,
            }
        )
    middle = {key: statistics.median(one[key] for one in runs) for key in runs[0]}
    return {"scene": case.name, "structure": choice, "backend": backend, **middle, "runs": runs}


def main() -> None:
    """Measure every scene, backend and structure; print a table, and write the same as JSON."""
    parser = arguments_of(__doc__)
    parser.add_argument("--seconds", type=float, help="of each run")
    parser.add_argument("--backends", default="cpu,vulkan")
    parser.add_argument("--scenes", help="names, of those that there are")
    arguments = parser.parse_args()
    build(arguments.build, "lampyris_program")
    program = (arguments.build / "lampyris").resolve()
    seconds = arguments.seconds or (4.0 if arguments.quick else 10.0)
    seeds = 1 if arguments.quick else 3
    head = f"{'scene':10} {'backend':8} {'structure':36} {'passes':>7} {'map':>5}"
    print(f"{head} {'relMSE':>9} {'trimmed':>9} {'ratio':>6}")
    rows = []
    for case in cases():
        if arguments.scenes and case.name not in arguments.scenes.split(","):
            continue
        reference = reference_of(program, case, 20 * seconds)
        for backend in arguments.backends.split(","):
            choices = structures(program)
            choices.remove(BASELINE)
            baseline = 0.0
            for choice in [BASELINE, *choices]:
                row = measure(program, case, reference, choice, backend, seconds, seeds)
                baseline = baseline or row["relmse_trimmed"]
                row["ratio"] = row["relmse_trimmed"] / baseline
                rows.append(row)
                print(
                    f"{row['scene']:10} {backend:8} {choice:36} {row['passes']:7.0f} {row['map_share']:5.2f}"
                    f" {row['relmse']:9.2e} {row['relmse_trimmed']:9.2e} {row['ratio']:6.2f}",
                    flush=True,
                )
    write(arguments.json, "equal-time", seconds=seconds, seeds=seeds, rows=rows)


if __name__ == "__main__":
    main()
