"""Compare `path` on the CPU with Mitsuba 3: processor seconds times relMSE, in turns, each with its best sampler."""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median

import numpy
from support.peer_scenes import PeerScene, peer_scenes
from support.programs import ROOT, arguments_of, build, run, write

MITSUBA = "3.9.1"
SAMPLES = 64  # a square: Mitsuba's multijitter takes no other number
OURS, THEIRS = "sobol", "multijitter"
INDEPENDENT = "independent"
GOAL = 1.5


class Unavailable(Exception):
    """A renderer cannot be had on this machine."""


def mitsuba_python() -> Path:
    """The interpreter of a Python environment with Mitsuba, which is made on first use."""
    folder = ROOT / "build" / "peers-venv"
    python = folder / "bin" / "python"
    if not python.exists():
        run([sys.executable, "-m", "venv", folder])
    check = f"import mitsuba; assert mitsuba.__version__ == '{MITSUBA}'"
    if subprocess.run([python, "-c", check], capture_output=True, check=False).returncode != 0:
        install = [python, "-m", "pip", "install", "--quiet", f"mitsuba=={MITSUBA}", "numpy"]
        done = subprocess.run(install, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise Unavailable(f"Mitsuba {MITSUBA} could not be installed from PyPI")
    return python


def llvm_library() -> str:
    """A libLLVM that Mitsuba's compiler takes: 16 or newer."""
    for version in range(30, 15, -1):
        for name in (f"libLLVM.so.{version}.1", f"libLLVM-{version}.so.1", f"libLLVM-{version}.so"):
            for path in sorted(Path("/usr/lib").glob(f"*/{name}")):
                return str(path)
    raise Unavailable("there is no libLLVM of version 16 or newer (Debian: libllvm19)")


class Mitsuba:
    """A process that renders one scene."""

    def __init__(self, scene: PeerScene, scratch: Path, threads: int) -> None:
        environment = {**os.environ, "DRJIT_LIBLLVM_PATH": llvm_library()}
        self.image = scratch / "theirs.npy"
        self.version = MITSUBA
        self.process = subprocess.Popen(
            ["taskset", "-c", f"0-{threads - 1}", mitsuba_python(), ROOT / "bench/support/mitsuba_render.py"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env=environment,
        )
        self.process.stdin.write(json.dumps(scene.to_mitsuba()) + "\n")

    def render(self, sampler: str, samples: int, seed: int) -> tuple[numpy.ndarray, float]:
        """A picture, and the processor seconds of rendering."""
        request = {"sampler": sampler, "samples": samples, "seed": seed, "image": str(self.image)}
        self.process.stdin.write(json.dumps(request) + "\n")
        self.process.stdin.flush()
        line = self.process.stdout.readline()
        if not line:
            raise Unavailable("Mitsuba ended without an answer")
        return numpy.load(self.image)[:, :, :3], json.loads(line)["cpu_s"]

    def close(self) -> None:
        """End the process."""
        self.process.stdin.close()
        self.process.wait()


class Lampyris:
    """Renders one scene, each time in a new process."""

    def __init__(self, folder: Path, scene: PeerScene, scratch: Path, threads: int) -> None:
        self.program, self.scene, self.scratch = folder / "lampyris", scene, scratch
        self.ready = False
        # In vectors from the start: the first rendering compiles them, and keeps the code for the others.
        self.options = ["--backend", "cpu", "--threads", threads, "-q"]
        self.options += ["--set", "backend.vectors=on", "--set", f"backend.cache={scratch}"]

    def cpu_seconds(self, sampler: str, samples: int, seed: int) -> tuple[numpy.ndarray, float]:
        """A picture, and the processor seconds of the process."""
        image = self.scratch / "ours.pfm"
        words = [self.program, "render", self.scene.to_pbrt(sampler), *self.options]
        words += ["--spp", samples, "--seed", seed, "-o", image]
        before = os.times()
        run(words)
        after = os.times()
        seconds = after.children_user - before.children_user + after.children_system - before.children_system
        return read_pfm(image), seconds

    def render(self, sampler: str, samples: int, seed: int) -> tuple[numpy.ndarray, float]:
        """A picture, and the processor seconds of rendering: what one sample takes, set-up with it, is subtracted."""
        if not self.ready:
            self.cpu_seconds(sampler, 1, seed)
            self.ready = True
        _, one = self.cpu_seconds(sampler, 1, seed)
        image, all_samples = self.cpu_seconds(sampler, samples, seed)
        return image, (all_samples - one) * samples / (samples - 1)


def read_pfm(path: Path) -> numpy.ndarray:
    """Pixels from the top, as [height, width, 3]."""
    with path.open("rb") as file:
        file.readline()
        width, height = map(int, file.readline().split())
        file.readline()
        pixels = numpy.frombuffer(file.read(), dtype="<f4").reshape(height, width, 3)
    return pixels[::-1].astype(float)


def relmse_of_pairs(images: list[numpy.ndarray], reference: numpy.ndarray) -> float:
    """The mean relMSE of independent images, from the differences of pairs, without the worst 0.1 % of the numbers."""
    errors = []
    for a, b in zip(images[0::2], images[1::2], strict=True):
        relative = ((a - b) ** 2 / 2 / (reference**2 + 0.01)).ravel()
        kept = len(relative) - len(relative) // 1000
        errors.append(numpy.sort(relative)[:kept].sum() / kept)
    return float(numpy.mean(errors))


def agreement(ours: list[numpy.ndarray], theirs: list[numpy.ndarray]) -> dict:
    """Whether both rendered the same scene: the ratio of means, and the share of 8x8 blocks that differ by 5 errors."""

    def blocks(image: numpy.ndarray) -> numpy.ndarray:
        height, width = image.shape[0] // 8 * 8, image.shape[1] // 8 * 8
        return image[:height, :width].mean(axis=2).reshape(height // 8, 8, width // 8, 8).mean(axis=(1, 3))

    a, b = numpy.array([blocks(i) for i in ours]), numpy.array([blocks(i) for i in theirs])
    variance = a.var(axis=0, ddof=1) / len(a) + b.var(axis=0, ddof=1) / len(b)
    difference = a.mean(axis=0) - b.mean(axis=0)
    level = numpy.sqrt(variance + (2e-3 * numpy.maximum(a.mean(axis=0), b.mean(axis=0))) ** 2) + 1e-4
    return {
        "mean_ratio": float(b.mean() / a.mean()),
        "blocks_off": float((numpy.abs(difference) > 5 * level).mean()),
    }


def compare(scene: PeerScene, folder: Path, threads: int, rounds: int, samples: int) -> list[dict]:
    """A scene by both, in turns, with independent samples and with each one's best sampler."""
    rows = []
    with tempfile.TemporaryDirectory() as scratch:
        lampyris = Lampyris(folder, scene, Path(scratch), threads)
        mitsuba = Mitsuba(scene, Path(scratch), threads)
        for ours, theirs in ((INDEPENDENT, INDEPENDENT), (OURS, THEIRS)):
            pictures, seconds = {"ours": [], "theirs": []}, {"ours": [], "theirs": []}
            for turn in range(2 * rounds):
                for who, renderer, sampler in (("ours", lampyris, ours), ("theirs", mitsuba, theirs)):
                    picture, cpu_s = renderer.render(sampler, samples, 10 + turn)
                    pictures[who].append(picture)
                    seconds[who].append(cpu_s)
            reference = numpy.mean(pictures["ours"] + pictures["theirs"], axis=0)
            row = {"scene": scene.name, "peer": "mitsuba", "peer_version": MITSUBA}
            for who, sampler in (("ours", ours), ("theirs", theirs)):
                error = relmse_of_pairs(pictures[who], reference)
                row[who] = {"cpu_s": median(seconds[who]), "relmse": error, "sampler": sampler}
            row["ratio"] = (
                row["theirs"]["cpu_s"] * row["theirs"]["relmse"] / row["ours"]["cpu_s"] / row["ours"]["relmse"]
            )
            rows.append({**row, **agreement(pictures["ours"], pictures["theirs"])})
            print(
                f"{scene.name:24} {ours:12} {row['ours']['cpu_s']:7.2f} {row['ours']['relmse']:9.2e}"
                f" {theirs:12} {row['theirs']['cpu_s']:7.2f} {row['theirs']['relmse']:9.2e} {row['ratio']:6.2f}"
                f" {rows[-1]['mean_ratio']:7.4f} {rows[-1]['blocks_off']:6.3f}",
                flush=True,
            )
        mitsuba.close()
    return rows


def main() -> None:
    """Run all scenes, print a table, and write the same as JSON."""
    parser = arguments_of(__doc__)
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--scenes", nargs="*", help="only these")
    arguments = parser.parse_args()
    build(arguments.build, "lampyris_program")
    print(
        f"{'scene':24} {'Lampyris':12} {'CPU s':>7} {'relMSE':>9} {'Mitsuba':12} {'CPU s':>7} {'relMSE':>9}"
        f" {'ratio':>6} {'means':>7} {'differ':>6}   (goal of the ratio: {GOAL})"
    )
    rows = []
    try:
        for scene in peer_scenes():
            if not arguments.scenes or scene.name in arguments.scenes:
                rounds, samples = (1, 16) if arguments.quick else (3, SAMPLES)
                rows += compare(scene, arguments.build, arguments.threads, rounds, samples)
    except Unavailable as reason:
        print(f"skipped: {reason}")
        return
    write(arguments.json, "peers", rows=rows)


if __name__ == "__main__":
    main()
