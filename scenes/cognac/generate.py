#!/usr/bin/env python3
"""The meshes of scenes/cognac: a snifter of cognac and a crystal stopper on a table. Centimetres."""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from modelling.curves import chain, offset, spline
from modelling.generator import Divisions, parse_options, write_meshes
from modelling.lamps import globe_lamp, light_box
from modelling.mesh import Mesh
from modelling.shapes import backdrop, lathe
from modelling.vessels import filled_vessel

GAP = 0.01  # between things and the table: surfaces that coincide would have no order

# The snifter's outside, as points (radius, height): its foot and stem, then its bowl up to the rim.
FOOT = [(0.0, 0.20), (2.2, 0.14), (3.15, 0.0)]
STEM = [(3.45, 0.16), (2.9, 0.32), (1.3, 0.58), (0.56, 1.15), (0.46, 1.9), (0.66, 2.5), (1.5, 3.05)]
BOWL = [(1.5, 3.05), (3.55, 4.55), (4.72, 7.2), (4.5, 9.9), (3.7, 12.4), (3.15, 14.4)]
WALL = 0.17  # how thick the bowl is
LEVEL = 5.75  # height of the cognac
CLIMB, REACH = 0.14, 0.3  # its meniscus: how far it climbs the glass, and how far from the glass it begins

LAMP = (22.0, 28.0, 27.0)  # centre of the lamp
GLOBE, GLOW = 2.6, 0.45  # radii of its globe and of what shines in it

# What bounds each body that must be closed: meshes, and whether they count as they are (1) or inside out (-1).
BODIES = {
    "glass": {"glass-air": 1, "cognac-glass": -1},
    "cognac": {"cognac-glass": 1, "cognac-air": 1},
    "stopper": {"stopper": 1},
    "globe": {"globe": 1},
    "pane": {"pane": 1},
    "lamp": {"lamp": 1},
}
GLASS = ["glass-air", "cognac-glass", "cognac-air", "stopper", "globe", "pane"]  # the meshes that are interfaces


def snifter(divide):
    foot = chain(spline(FOOT, divide(10)), spline([FOOT[-1], (3.42, 0.03), STEM[0]], divide(4)))
    outside = chain(foot, spline(STEM, divide(18)), spline(BOWL, divide(24)))
    inside = spline([(0.0, 3.36), (0.8, 3.40), *offset(BOWL, -WALL)[1:]], 600)
    steps = [divide(count) for count in (6, 16, 16, 6, 4)]
    meshes = filled_vessel(outside, inside, LEVEL, (CLIMB, REACH), divide(72), steps)
    names = ("glass-air", "cognac-glass", "cognac-air")
    return {name: mesh.moved(z=GAP) for name, mesh in zip(names, meshes, strict=True)}


def stopper():
    """Of crystal, with eight facets around; it lies on one of them and on the edge of its peg."""
    around = lathe([(0, 0), (0.75, 0), (0.9, 1.7), (1.15, 1.8), (2.0, 2.7), (1.55, 3.9), (0, 4.5)], 8).turned(22.5)
    lean = np.degrees(np.arctan((2.0 - 0.75) * np.cos(np.radians(22.5)) / 2.7))
    lying = Mesh(around.points, around.faces).turned(90.0 + lean, "y")
    return lying.moved(z=GAP - lying.points[:, 2].min())


def build(divide):
    lamp, globe = globe_lamp(LAMP, GLOBE, 0.12, GLOW, divide)
    shine, case, pane = (
        part.aligned((1.0, 0.25, -0.3)).moved(-52.0, -14.0, 26.0) for part in light_box(34, 46, 8, 0.4)
    )
    return snifter(divide) | {
        "stopper": stopper().turned(205.0).moved(-7.4, -4.2),
        "table": backdrop([(60.0, 0.0), (-90.0, 0.0)], -120.0, 120.0),
        "wall": backdrop([(61.0, 120.0), (61.0, -5.0)], -120.0, 120.0),
        "lamp": lamp,
        "globe": globe,
        "window": shine,
        "case": case,
        "pane": pane,
    }


if __name__ == "__main__":
    options = parse_options(__doc__)
    write_meshes(options.output, build(Divisions(options.detail)))
