#!/usr/bin/env python3
"""Keep hashes of small images of every scene, to show that a change of the code changes no image.

Usage: build/venv/bin/python tools/image_hashes.py record OUT.json [OPTION]...
       build/venv/bin/python tools/image_hashes.py compare BEFORE.json AFTER.json

`record` renders each scene below scenes/ with each integrator on each backend, two passes of few pixels, and writes a
hash of the pixels of all channels of each image. `compare` names what differs, and exits with 1 if anything does.
"""

import argparse
import hashlib
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import OpenEXR

ROOT = Path(__file__).resolve().parent.parent
BACKENDS = ("cpu", "cpu-bvh2", "vulkan")
INTEGRATORS = {
    "path": ["--spp", "2"],
    "ao": ["--spp", "2"],
    "sppm": ["--passes", "2", "--set", "integrator.photonsperiteration=3000"],
    "ppm": ["--passes", "2", "--set", "integrator.photonsperiteration=3000"],
    "photon_map": ["--passes", "2", "--set", "integrator.photons=3000"],
}


def hash_of(image: Path) -> str:
    """SHA-256 over names and values of the image's channels."""
    digest = hashlib.sha256()
    channels = OpenEXR.File(str(image), separate_channels=True).parts[0].channels
    for name in sorted(channels):
        digest.update(name.encode() + np.ascontiguousarray(channels[name].pixels).tobytes())
    return digest.hexdigest()[:16]


def render(program: Path, scene: Path, integrator: str, backend: str, folder: Path) -> str:
    """The hash of an image, or the program's last output if there is no image."""
    image = folder / "image.exr"
    image.unlink(missing_ok=True)
    command = [
        program,
        "render",
        scene,
        "-o",
        image,
        "-q",
        "--backend",
        backend,
        "--integrator",
        integrator,
        "--resolution",
        "24x16",
        "--seed",
        "7",
        *INTEGRATORS[integrator],
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return hash_of(image) if image.exists() else f"exit {done.returncode}: {done.stderr.strip().splitlines()[-1:]}"


def record(options: argparse.Namespace) -> int:
    program = options.program.resolve()
    hashes = {}
    with tempfile.TemporaryDirectory() as folder:
        for scene in sorted((ROOT / "scenes").glob("*/*.pbrt")):
            if options.scene and not any(scene.match(pattern) for pattern in options.scene):
                continue
            for backend in options.backend or BACKENDS:
                for integrator in options.integrator or INTEGRATORS:
                    key = f"{scene.parent.name}/{scene.stem} {integrator} {backend}"
                    hashes[key] = render(program, scene, integrator, backend, Path(folder))
            options.out.write_text(json.dumps(hashes, indent=1) + "\n")
    print(f"{len(hashes)} images")
    return 0


def compare(options: argparse.Namespace) -> int:
    before, after = (json.loads(path.read_text()) for path in (options.before, options.after))
    both = before.keys() & after.keys()
    different = sorted(key for key in both if before[key] != after[key])
    for key in different:
        print(f"{key}: {before[key]} became {after[key]}")
    failed = sorted(key for key in both if "exit" in after[key])
    print(
        f"{len(both) - len(different)} of {len(both)} are the same; {len(failed)} have no image"
        f"; {len(before.keys() ^ after.keys())} are in one file only"
    )
    return 1 if different else 0


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True)
    recorder = commands.add_parser("record")
    recorder.add_argument("out", type=Path)
    recorder.add_argument("--program", type=Path, default=ROOT / "build/release/lampyris")
    recorder.add_argument("--backend", action="append", choices=BACKENDS)
    recorder.add_argument("--integrator", action="append", choices=INTEGRATORS)
    recorder.add_argument("--scene", action="append", help="such as reference/*.pbrt; all without")
    recorder.set_defaults(run=record)
    comparer = commands.add_parser("compare")
    comparer.add_argument("before", type=Path)
    comparer.add_argument("after", type=Path)
    comparer.set_defaults(run=compare)
    options = parser.parse_args()
    return options.run(options)


if __name__ == "__main__":
    sys.exit(main())
