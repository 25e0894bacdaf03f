#!/usr/bin/env python3
"""The meshes of scenes/box: a room with things of glass and metal under a lamp in a glass globe. Metres."""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from modelling.generator import Divisions, parse_options, write_meshes
from modelling.lamps import fitting, globe_lamp
from modelling.mesh import join
from modelling.shapes import ball, rectangle, rounded_box, torus

LOW, HIGH = (-1.55, -3.3, 0.0), (1.55, 1.2, 2.4)  # corners of the room
GAP = 0.0005  # between things and what they stand on: surfaces that coincide would have no order

BALL, BALL_AT = 0.40, (0.58, -0.12)  # the glass ball's radius, and where it lies
RING, TUBE, RING_AT = 0.30, 0.075, (-0.48, -0.42)  # the gold ring's radii, and where it lies
BLOCK, BLOCK_AT, BLOCK_TURN = (0.62, 0.62, 1.15), (-0.56, 0.58), 33.0  # the mirror block

LAMP = (0.10, 0.0, 1.84)  # centre of the lamp
GLOBE, WALL = 0.15, 0.006  # radius of its globe, and how thick the glass is
GLOW = 0.035  # radius of what shines in it

# What bounds each body that must be closed: meshes, and whether they count as they are (1) or inside out (-1).
BODIES = {name: {name: 1} for name in ("ball", "ring", "block", "globe", "lamp", "fitting")}
GLASS = ["ball", "globe"]  # the meshes that are interfaces


def room():
    """The walls face inwards; the camera stands in the room."""
    size = np.subtract(HIGH, LOW)
    across, deep, up = np.diag(size)
    return {
        "walls": join(
            rectangle(LOW, across, deep),
            rectangle(HIGH - across - deep, deep, across),
            rectangle(HIGH - up, -across, up),
            rectangle(LOW, up, across),
        ),
        "wall-left": rectangle(LOW, deep, up).flipped(),
        "wall-right": rectangle(HIGH, -deep, -up).flipped(),
    }


def build(divide):
    lamp, globe = globe_lamp(LAMP, GLOBE, WALL, GLOW, divide)
    return room() | {
        "ball": ball(BALL, divide(8)).moved(*BALL_AT, BALL + GAP),
        "ring": torus(RING, TUBE, divide(32), divide(15)).moved(*RING_AT, TUBE + GAP),
        "block": rounded_box(BLOCK, 0.02, 1).turned(BLOCK_TURN).moved(*BLOCK_AT, BLOCK[2] / 2.0 + GAP),
        "lamp": lamp,
        "globe": globe,
        "fitting": fitting(GLOBE, 0.006, HIGH[2] - LAMP[2] - 0.001, divide).moved(*LAMP),
    }


if __name__ == "__main__":
    options = parse_options(__doc__)
    write_meshes(options.output, build(Divisions(options.detail)))
