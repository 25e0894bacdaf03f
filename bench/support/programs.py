"""Builds and runs Lampyris for the benchmarks."""

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCENES = ROOT / "scenes"


def arguments_of(description: str) -> argparse.ArgumentParser:
    """The options that every benchmark has."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--build", type=Path, default=Path("build/release"), help="folder with the built programs")
    parser.add_argument("--json", type=Path, help="where to write the results")
    parser.add_argument("--quick", action="store_true", help="smaller images and fewer repeats: rough figures")
    return parser


def generated_folder() -> Path:
    """Where generated scenes are kept between runs."""
    folder = ROOT / "build" / "bench"
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def build(folder: Path, *targets: str) -> None:
    """Bring targets up to date; a failure shows the compiler's output."""
    command = ["cmake", "--build", str(folder), "--target", *targets]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    if result.returncode != 0:
        # Google Benchmark may have been installed after the tree was configured.
        subprocess.run(["cmake", str(folder)], check=True, stdout=subprocess.DEVNULL)
        result = subprocess.run(command, capture_output=True, text=True, check=False)
    if result.returncode != 0:
        sys.exit(f"{' '.join(command)} failed:\n{result.stdout}{result.stderr}")


def run(command: list) -> subprocess.CompletedProcess:
    """Run a program to its end; if it fails, so does the benchmark, with the program's output."""
    words = [str(word) for word in command]
    result = subprocess.run(words, capture_output=True, text=True, check=False)
    if result.returncode != 0:
        sys.exit(f"{' '.join(words)} ended with {result.returncode}:\n{result.stdout}{result.stderr}")
    return result


@dataclass
class Work:
    """A scene to render, reduced to `size` pixels and `samples` per pixel."""

    scene: Path
    size: str
    samples: int

    @property
    def name(self) -> str:
        """The name of the scene's folder, or of its file if the folder has several."""
        return self.scene.parent.name if self.scene.stem == "scene" else self.scene.stem


def render(folder: Path, work: Work, *options: str) -> dict:
    """Render with `path`, and return the statistics (docs/stats.md), and the processor seconds of it all."""
    with tempfile.TemporaryDirectory() as scratch:
        statistics = Path(scratch) / "stats.json"
        command = [folder / "lampyris", "render", work.scene, "-o", Path(scratch) / "image.pfm", "--stats", statistics]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        run([*command, "--integrator", "path", "--resolution", work.size, "--spp", work.samples, *options])
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        cpu_s = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
        return {**json.loads(statistics.read_text()), "cpu_s": cpu_s}


def write(path: Path | None, name: str, **content) -> None:
    """Write the results as JSON, and how busy the machine was: on a busy one, only alternating ratios are valid."""
    machine = {"processors": os.cpu_count(), "load": os.getloadavg()[0]}
    print(f"(load {machine['load']:.1f} on {machine['processors']} processors)")
    if path:
        path.write_text(
            json.dumps({"schema": f"lampyris.bench-{name}/1", "machine": machine, **content}, indent=1) + "\n"
        )
