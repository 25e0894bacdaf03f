#!/usr/bin/env python3
"""The meshes of scenes/torus: a matt torus cast into a block of glass, under a lamp in a glass globe. Centimetres."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from modelling.curves import arc, chain
from modelling.generator import Divisions, parse_options, write_meshes
from modelling.lamps import globe_lamp
from modelling.shapes import backdrop, rounded_box, torus

BLOCK = 12.0  # side of the block
EDGE = 0.7  # radius of its edges
RING, TUBE = 3.35, 1.25  # radii of the torus
LAMP = (-31.0, -3.0, 39.0)  # centre of the lamp
GLOBE, WALL = 4.0, 0.15  # radius of its globe, and how thick the glass is
GLOW = 1.2  # radius of what shines in it
GAP = 0.01  # between the block and the ground: surfaces that coincide would have no order

# What bounds each body that must be closed: meshes, and whether they count as they are (1) or inside out (-1).
BODIES = {"block": {"block": 1}, "torus": {"torus": 1}, "globe": {"globe": 1}, "lamp": {"lamp": 1}}
GLASS = ["block", "globe"]  # the meshes that are interfaces


def build(divide):
    ring = torus(RING, TUBE, divide(112), divide(56)).turned(62.0, "x").turned(-28.0, "z")
    block = rounded_box((BLOCK, BLOCK, BLOCK), EDGE, divide(6)).turned(24.0)
    ground = chain([(150.0, 90.0), (150.0, 60.0)], arc((90.0, 60.0), 60.0, 0.0, -90.0, divide(24)), [(-160.0, 0.0)])
    lamp, globe = globe_lamp(LAMP, GLOBE, WALL, GLOW, divide)
    return {
        "torus": ring.moved(z=BLOCK / 2.0 + GAP),
        "block": block.moved(z=BLOCK / 2.0 + GAP),
        "ground": backdrop(ground, -160.0, 160.0),
        "lamp": lamp,
        "globe": globe,
    }


if __name__ == "__main__":
    options = parse_options(__doc__)
    write_meshes(options.output, build(Divisions(options.detail)))
