#!/usr/bin/env python3
"""The meshes of scenes/pool: a swimming pool in the sun, tiled, with waves. Metres."""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from modelling.curves import chain, line, rounded
from modelling.generator import Divisions, parse_options, write_meshes
from modelling.mesh import Mesh, join
from modelling.shapes import heightfield, lathe, rectangle, rounded_box, tile, torus, tube

SEED = 7
HALF = (3.0, 2.1)  # half the basin's length and width
DEPTH = 1.35  # of the basin, below the deck at z = 0
LEVEL = -0.13  # of the water
BURIED = 0.02  # the body of water ends in the walls, behind the tiles

TILE, JOINT, RAISED = 0.15, 0.005, 0.003  # pitch of the tiles, gap between them, and how far they stand out
SHADES = 4  # of blue, mixed at random; a line of dark tiles runs along the floor
COPING, OVERHANG = 0.30, 0.03  # width of the stones around the basin, and how far they reach over it
SLAB, REACH = 0.60, 3.0  # pitch of the deck's slabs, and how far the deck goes

CELLS = (240, 168)  # of the water's surface
WAVES, LENGTHS, SPREAD = 60, (0.24, 1.5), 55.0  # how many, between which lengths, spread of directions [degrees]
STEEPNESS = 0.125  # root mean square of the slope along the wind

SUN, SUN_RADIUS = (-5.6, 4.6, 9.6), 0.14  # a lamp as wide as 1.3 degrees, where the sun would be
FLOAT, FLOAT_AT = (0.31, 0.085), (-0.75, -0.1)  # radii of the swimming ring, and where it drifts
LADDER, LADDER_WIDTH, RAIL = 1.35, 0.5, 0.019  # where it is along the far side, its width and its tubes' radius

# What bounds each body that must be closed: meshes, and whether they count as they are (1) or inside out (-1).
BODIES = {
    "water": {"water": 1},
    "float": {"float-red": 1, "float-white": 1},
    "coping": {"coping": 1},
    "ladder": {"ladder": 1},
}
GLASS = ["water"]  # the meshes that are interfaces


def water(divide, random):
    """A sum of sines, each as steep as the others: long waves are higher."""
    length = np.exp(random.uniform(*np.log(LENGTHS), WAVES))
    angle = np.radians(random.normal(25.0, SPREAD, WAVES))
    phase = random.uniform(0.0, 2.0 * np.pi, WAVES)
    k = 2.0 * np.pi / length
    kx, ky = k * np.cos(angle), k * np.sin(angle)
    amplitude = STEEPNESS * np.sqrt(2.0 / WAVES) / k

    def height(x, y):
        return LEVEL + np.sin(np.outer(x, kx) + np.outer(y, ky) + phase) @ amplitude

    def slope(x, y):
        cosine = np.cos(np.outer(x, kx) + np.outer(y, ky) + phase)
        return cosine @ (amplitude * kx), cosine @ (amplitude * ky)

    ends = np.array(HALF) + BURIED
    return heightfield(height, slope, -ends, ends, [divide(count) for count in CELLS], -DEPTH - BURIED)


def along_wall(mesh, wall):
    """From the xy plane, where y is up, to one of the four walls, facing the basin: 0 far, 1 left, 2 near, 3 right."""
    distance = HALF[1] if wall % 2 == 0 else HALF[0]
    return mesh.turned(90.0, "x").moved(y=distance).turned(90.0 * wall)


def tiles(random):
    """Floor and walls, by shade; the last is the dark line's."""
    one = tile(TILE - JOINT, TILE - JOINT, RAISED, 0.004)
    shades = [[] for _ in range(SHADES + 1)]
    across, along = (round(2.0 * half / TILE) for half in HALF)
    for i in range(across):
        for j in range(along):
            shade = random.integers(SHADES)
            if abs(j - (along - 1) / 2.0) < 1.6 and 2 <= i < across - 2:
                shade = SHADES
            x, y = (i + 0.5) * TILE - HALF[0], (j + 0.5) * TILE - HALF[1]
            shades[shade].append(one.moved(x, y, -DEPTH))
    for wall in range(4):
        for i in range(across if wall % 2 == 0 else along):
            for j in range(round(DEPTH / TILE)):
                shade = random.integers(SHADES)
                x = (i + 0.5) * TILE - HALF[wall % 2]
                shades[shade].append(along_wall(one.moved(x, (j + 0.5) * TILE - DEPTH), wall))
    return {f"tiles-{number}": join(*meshes) for number, meshes in enumerate(shades)}


def basin():
    """What lies behind the tiles: mortar."""
    (x, y), parts = HALF, []
    parts.append(rectangle((-x, -y, -DEPTH), (2 * x, 0, 0), (0, 2 * y, 0)))
    for wall in range(4):
        half = HALF[wall % 2]
        parts.append(along_wall(rectangle((-half, -DEPTH, 0), (2 * half, 0, 0), (0, DEPTH - 0.05, 0)), wall))
    return join(*parts)


def deck():
    """Stones around the basin, slabs further out, and the ground below them, which leaves the basin open."""
    (x, y), top = HALF, 0.01
    stones, slabs = [], []
    for side in range(4):
        near, half = (y, x + COPING - OVERHANG) if side % 2 == 0 else (x, y - OVERHANG)
        count = round(2.0 * half / 0.5)
        size = 2.0 * half / count
        stone = rounded_box((size - 0.006, COPING, 0.055), 0.016, 1).moved(z=top - 0.0275)
        middle = near - OVERHANG + COPING / 2.0
        stones += [stone.moved((i + 0.5) * size - half, middle).turned(90.0 * side) for i in range(count)]
    slab = tile(SLAB - 0.008, SLAB - 0.008, 0.03, 0.006)
    edge_x, edge_y = x + COPING - OVERHANG + 0.006, y + COPING - OVERHANG + 0.006
    rows = round(REACH / SLAB)
    columns = int(np.ceil((edge_x + REACH) / SLAB))
    for sign in (-1, 1):
        for row in range(rows):
            offset = 0.5 * (row % 2)
            for column in range(-columns, columns):
                slabs.append(slab.moved((column + offset + 0.5) * SLAB, sign * (edge_y + (row + 0.5) * SLAB), -0.03))
        for row in range(rows):
            count = round(2.0 * edge_y / SLAB)
            scale = 2.0 * edge_y / count
            for column in range(count):
                place = (sign * (edge_x + (row + 0.5) * SLAB), (column + 0.5) * scale - edge_y, -0.03)
                slabs.append(tile(SLAB - 0.008, scale - 0.008, 0.03, 0.006).moved(*place))
    far_x, far_y, low = x + 2 * REACH, y + 2 * REACH, -0.05
    ground = join(
        rectangle((-far_x, y, low), (2 * far_x, 0, 0), (0, far_y - y, 0)),
        rectangle((-far_x, -far_y, low), (2 * far_x, 0, 0), (0, far_y - y, 0)),
        rectangle((-far_x, -y, low), (far_x - x, 0, 0), (0, 2 * y, 0)),
        rectangle((x, -y, low), (far_x - x, 0, 0), (0, 2 * y, 0)),
    )
    return {"coping": join(*stones), "deck": join(*slabs), "ground": ground}


def ladder(divide):
    """Two rails that arch from the deck into the water, and three steps between them."""
    back, front, top, foot = HALF[1] + 0.45, HALF[1] - 0.11, 0.72, -1.02
    bend = rounded([(back, 0.005), (back, top), (front, top), (front, foot)], 0.2, divide(12))
    path = chain(line(bend[0], bend[1], 2), bend[1:-1], line(bend[-2], bend[-1], 4))
    rails = []
    for side in (-1, 1):
        x = np.full(len(path), LADDER + side * LADDER_WIDTH / 2.0)
        rails.append(tube(np.column_stack([x, path]), RAIL, divide(20)))
    step = rounded_box((LADDER_WIDTH - 2.5 * RAIL, 0.09, 0.03), 0.012, 2)
    return join(*rails, *[step.moved(LADDER, front, z) for z in (-0.34, -0.64, -0.94)])


def swimming_ring(divide):
    """A torus in eight stripes of two colours."""
    ring = torus(*FLOAT, divide(64, multiple=8), divide(28))
    middle = ring.points[ring.faces].mean(axis=1)
    stripe = np.floor((np.degrees(np.arctan2(middle[:, 1], middle[:, 0])) % 360.0) / 45.0) % 2
    place = lambda mesh: mesh.turned(4.0, "x").turned(20.0).moved(*FLOAT_AT, LEVEL + 0.03)  # noqa: E731
    return [place(Mesh(ring.points, ring.faces[stripe == colour], ring.normals)) for colour in (0, 1)]


def build(divide, seed=SEED):
    random = np.random.Generator(np.random.PCG64(seed))
    red, white = swimming_ring(divide)
    sun = lathe([(SUN_RADIUS, 0.0), (0.0, 0.0)], 12).aligned(-np.array(SUN)).moved(*SUN)
    parts = {"water": water(divide, random), "grout": basin(), "ladder": ladder(divide), "sun": sun}
    return parts | tiles(random) | deck() | {"float-red": red, "float-white": white}


if __name__ == "__main__":
    options = parse_options(__doc__, seed=SEED)
    write_meshes(options.output, build(Divisions(options.detail), options.seed))
