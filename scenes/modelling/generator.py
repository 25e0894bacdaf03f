"""The command line that the generators share."""

import argparse
import sys
from pathlib import Path


def parse_options(description, seed=None):
    """--output, --detail and, where a scene has something random, --seed. The defaults make the files that lie here."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.ArgumentDefaultsHelpFormatter)
    parser.add_argument("--output", type=Path, default=Path(sys.argv[0]).resolve().parent, help="folder of the meshes")
    parser.add_argument("--detail", type=float, default=1.0, help="multiplies how finely curved surfaces are divided")
    if seed is not None:
        parser.add_argument("--seed", type=int, default=seed, help="another seed gives another arrangement")
    return parser.parse_args()


class Divisions:
    """How many pieces a curve or a turn is divided into, at a level of detail."""

    def __init__(self, detail):
        self.detail = detail

    def __call__(self, count, multiple=1):
        """At least 3, and a multiple where one piece has to end at a certain place."""
        return max(3, multiple * round(count * self.detail / multiple))


def write_meshes(folder, meshes):
    """NAME.ply.gz for each, and a line that tells their triangles."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, mesh in meshes.items():
        mesh.write(folder / f"{name}.ply.gz")
        print(f"{name:20}{len(mesh.faces):8}")
    print(f"{'triangles':20}{sum(len(mesh.faces) for mesh in meshes.values()):8}")
