#!/usr/bin/env python3
"""The meshes of scenes/kitchen: the corner of a kitchen with glasses and pots under lamps in globes. Centimetres."""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from modelling import kitchenware
from modelling.curves import line
from modelling.generator import Divisions, parse_options, write_meshes
from modelling.lamps import fitting, globe_lamp
from modelling.mesh import join
from modelling.shapes import ball, rectangle, rounded_box, tile, tube

SEED = 3
LOW, HIGH = (-62.0, -340.0, -88.0), (230.0, 0.0, 168.0)  # corners of the room; the worktop is at z = 0
GAP = 0.01  # between things and what they stand on: surfaces that coincide would have no order

TILE, JOINT, ROWS = (15.0, 7.5, 0.8), 0.3, 7  # a tile's pitch and thickness, the gap between tiles, rows of them
TILED = (180.0, 64.0)  # how far the far wall and the left one are tiled, from the corner
UNEVEN = 0.22  # standard deviation of how the tiles lean [degrees]
SHADES = 3

POT, PAN, PAN_TURN = (-35.0, -24.0), (-10.5, -43.0), -38.0
BOTTLE, TUMBLER = (7.0, -13.0), (14.5, -34.0)
WINE, EMPTY = (26.5, -42.0), (33.0, -22.0)
BOWL = (51.0, -31.0)
WATER_LEVEL, WINE_LEVEL, OIL_LEVEL = 6.6, 12.4, 15.4
RAIL, RAIL_RADIUS = 40.0, 0.4  # height of the rail on the wall, and its radius

LAMPS = ((-12.0, -34.0, 50.0), (41.0, -34.0, 50.0))  # centres of the lamps
GLOBE, WALL, GLOW = 7.5, 0.2, 1.9  # radius of the globes, how thick their glass is, radius of what shines in them

# What bounds each body that must be closed: meshes, and whether they count as they are (1) or inside out (-1).
BODIES = {
    "wine glass": {"wine-glass-air": 1, "wine-glass": -1},
    "wine": {"wine-glass": 1, "wine-air": 1},
    "tumbler": {"tumbler-air": 1, "water-glass": -1},
    "water": {"water-glass": 1, "water-air": 1},
    "bottle": {"bottle-air": 1, "oil-glass": -1},
    "oil": {"oil-glass": 1, "oil-air": 1},
} | {
    name: {name: 1}
    for name in ("empty-glass", "globes", "lamps", "pot", "copper", "handles", "china", "worktop", "cork")
}
GLASS = ["wine-glass-air", "wine-glass", "wine-air", "tumbler-air", "water-glass", "water-air"]
GLASS += ["bottle-air", "oil-glass", "oil-air", "empty-glass", "globes"]  # the meshes that are interfaces


def room():
    """Floor, ceiling and walls face inwards; the camera stands in the room."""
    size = np.subtract(HIGH, LOW)
    across, deep, up = np.diag(size)
    return join(
        rectangle(LOW, across, deep),
        rectangle(HIGH - across - deep, deep, across),
        rectangle(HIGH - up, -across, up),
        rectangle(LOW, up, across),
        rectangle(LOW, up, deep).flipped(),
        rectangle(HIGH, -deep, -up).flipped(),
    )


def course(length, shift):
    """Where the tiles of a row begin and end: whole ones, but for the first of every other row and the last."""
    edges = np.arange(0.0, length + TILE[0], TILE[0]) - shift
    edges = np.unique(np.clip(edges, 0.0, length))
    return [(start, end) for start, end in zip(edges, edges[1:], strict=False) if end - start > 2.0]


def tiles(random):
    """In a running bond, each leaning a little: reflections break from tile to tile, as on a real wall."""
    shades = [[] for _ in range(SHADES)]
    for wall, length in enumerate(TILED):
        for row in range(ROWS):
            # Around the corner the bond goes on.
            for start, end in course(length, TILE[0] / 2.0 * ((row + wall) % 2)):
                shade = random.integers(SHADES)
                one = tile(end - start - JOINT, TILE[1] - JOINT, TILE[2], 0.18)
                one = one.turned(random.normal(0.0, UNEVEN), "y").turned(random.normal(0.0, UNEVEN), "x")
                one = one.moved((start + end) / 2.0, (row + 0.5) * TILE[1] + 0.3).turned(90.0, "x")
                if wall == 0:
                    shades[shade].append(one.moved(LOW[0] + TILE[2] + 0.1, -0.05))
                else:
                    turned = one.turned(90.0).moved(LOW[0] + 0.05, -TILE[2] - 0.1 - length)
                    shades[shade].append(turned)
    return {f"tiles-{number}": join(*meshes) for number, meshes in enumerate(shades)}


def cupboards():
    """The worktop, and drawers below it with a bar to pull each."""
    right, front, thick = 150.0, -63.0, 3.8
    left, back = LOW[0] + 1.0, HIGH[1] - 1.0
    top = rounded_box((right - left, back - front, thick), 0.5, 2)
    fronts, bars = [], []
    for number in range(4):
        x = left + (number + 0.5) * 52.0
        fronts.append(rounded_box((51.4, 2.0, 22.0), 0.25, 1).moved(x, front + 3.0, -16.0))
        bars.append(tube(line((x - 12, front - 0.8, -12), (x + 12, front - 0.8, -12), 1), 0.6, 12))
    worktop = top.moved((left + right) / 2.0, (front + back) / 2.0, -thick / 2.0)
    return {"worktop": worktop, "fronts": join(*fronts), "bars": join(*bars)}


def fruit(divide):
    """Oranges, and lemons that lean on each other, in the bowl."""
    oranges = [((-4.6, -1.8, 5.6), 3.7), ((3.5, -4.3, 5.9), 3.8), ((0.6, 4.7, 5.9), 3.9)]
    lemons = [((5.2, 3.0, 9.2), (0.6, 0.8, 0.35)), ((-1.2, -1.4, 10.9), (0.9, -0.35, 0.12))]
    place = (*BOWL, GAP)
    return {
        "oranges": join(*[ball(radius, divide(6)).moved(*at) for at, radius in oranges]).moved(*place),
        "lemons": join(*[kitchenware.lemon(divide).aligned(d).moved(*at) for at, d in lemons]).moved(*place),
    }


def build(divide, seed=SEED):
    random = np.random.Generator(np.random.PCG64(seed))
    meshes = {"room": room()} | tiles(random) | cupboards() | fruit(divide)

    pot, pan = kitchenware.pot(divide), kitchenware.saucepan(divide)
    meshes["pot"] = join(pot["body"], pot["lid"]).moved(*POT, GAP)
    meshes["copper"] = pan["body"].moved(*PAN, GAP)
    fittings = pot["fittings"].turned(-20.0).moved(*POT, GAP)
    meshes["handles"] = join(fittings, pan["handle"].turned(PAN_TURN).moved(*PAN, GAP))
    meshes["china"] = kitchenware.bowl(divide).moved(*BOWL, GAP)

    rail = tube(line((-56.0, -5.0, RAIL), (-6.0, -5.0, RAIL)), RAIL_RADIUS, divide(12))
    ladle = kitchenware.ladle(divide)
    meshes["rail"] = join(rail, ladle.moved(-18.0, -5.0, RAIL), ladle.scaled(0.82).moved(-28.5, -5.0, RAIL))

    vessels = {
        ("wine-glass-air", "wine-glass", "wine-air"): (kitchenware.drinking_glass(divide, wine=WINE_LEVEL), WINE),
        ("tumbler-air", "water-glass", "water-air"): (kitchenware.tumbler(divide, WATER_LEVEL), TUMBLER),
        ("bottle-air", "oil-glass", "oil-air"): (kitchenware.bottle(divide, OIL_LEVEL), BOTTLE),
        ("empty-glass",): ([kitchenware.drinking_glass(divide)], EMPTY),
    }
    for names, (parts, place) in vessels.items():
        meshes |= {name: part.moved(*place, GAP) for name, part in zip(names, parts, strict=True)}
    meshes["cork"] = kitchenware.cork(divide).moved(*BOTTLE, GAP)

    lamps = [globe_lamp(centre, GLOBE, WALL, GLOW, divide) for centre in LAMPS]
    meshes["lamps"], meshes["globes"] = (join(*parts) for parts in zip(*lamps, strict=True))
    hung = [fitting(GLOBE, 0.25, HIGH[2] - centre[2] - 0.01, divide).moved(*centre) for centre in LAMPS]
    return meshes | {"fittings": join(*hung)}


if __name__ == "__main__":
    options = parse_options(__doc__, seed=SEED)
    write_meshes(options.output, build(Divisions(options.detail), options.seed))
