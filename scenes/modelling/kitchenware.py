"""Pots, glasses and fruit, in centimetres; each stands on z = 0, its axis the z axis."""

import numpy as np

from .curves import arc, chain, line, offset, rounded, spline
from .mesh import join
from .shapes import lathe, tube
from .vessels import empty_vessel, filled_vessel


def drinking_glass(divide, around=40, wine=None):
    """A wine glass, 20 cm high: one mesh, or three (see filled_vessel) if wine stands so high in it."""
    bowl = [(0.55, 9.0), (2.3, 9.75), (3.85, 11.9), (4.2, 14.2), (3.85, 17.3), (3.25, 20.0)]
    foot = spline([(0.0, 0.22), (2.4, 0.12), (3.4, 0.0)], divide(6))
    edge = spline([(3.4, 0.0), (3.66, 0.05), (3.7, 0.2)], divide(3))
    stem = spline([(3.7, 0.2), (3.2, 0.33), (1.2, 0.58), (0.5, 1.3), (0.36, 3.0), (0.36, 6.4), (0.55, 9.0)], divide(14))
    outside = chain(foot, edge, stem, spline(bowl, divide(16)))
    inner = [(0.0, 9.55), (0.7, 9.62), *offset(bowl, -0.12)[1:]]
    if wine is None:
        return empty_vessel(outside, spline(inner, divide(16)), divide(around), divide(4))
    steps = [divide(count) for count in (4, 10, 10, 4, 3)]
    return filled_vessel(outside, spline(inner, 400), wine, (0.12, 0.25), divide(around), steps)


def tumbler(divide, water, around=40):
    """A tumbler of thick glass, 9.5 cm high, and the water in it (see filled_vessel)."""
    corner = rounded([(0.0, 0.0), (3.35, 0.0), (3.75, 4.7)], 0.5, divide(5))
    outside = chain(corner, line((3.75, 4.7), (4.1, 9.5), divide(4)))
    inside = rounded([(0.0, 1.1), (3.12, 1.1), (3.86, 9.5)], 0.6, 24)
    steps = [divide(count) for count in (5, 8, 4, 5, 4)]
    return filled_vessel(outside, inside, water, (0.13, 0.28), divide(around), steps)


def bottle(divide, oil, around=40):
    """A bottle, 27 cm high, and the oil in it (see filled_vessel)."""
    body = rounded([(0.0, 0.35), (2.6, 0.0), (3.6, 0.0), (3.6, 9.0)], 0.45, divide(4))
    up = line((3.6, 9.0), (3.6, 16.0), divide(3))
    neck = spline([(3.6, 16.0), (3.3, 18.2), (2.0, 20.4), (1.42, 22.4), (1.35, 25.6)], divide(14))
    ring = rounded([(1.35, 25.6), (1.62, 25.7), (1.62, 26.6), (1.30, 26.9)], 0.15, divide(2))
    inner = rounded([(0.0, 0.95), (3.25, 0.55), (3.25, 9.0)], 0.6, 16)
    inner_neck = spline([(3.25, 16.0), (2.97, 18.0), (1.7, 20.2), (1.1, 22.4), (1.03, 26.9)], 200)
    inside = chain(inner, line((3.25, 9.0), (3.25, 16.0), 20), inner_neck)
    steps = [divide(count) for count in (3, 12, 12, 4, 3)]
    return filled_vessel(chain(body, up, neck, ring), inside, oil, (0.12, 0.25), divide(around), steps)


def cork(divide, around=24):
    """For the bottle's neck, which it does not touch; it stands where it belongs in the bottle."""
    return lathe(
        rounded([(0.0, 24.6), (0.97, 24.6), (0.99, 27.6), (1.15, 28.6), (0.0, 28.6)], 0.12, divide(2)), divide(around)
    )


def pot(divide, around=52):
    """A pot with its lid, and what one holds them by."""
    side = rounded([(0.0, 0.0), (11.6, 0.0), (11.6, 14.2), (12.1, 15.0)], 1.1, divide(5))
    inside = rounded([(11.75, 15.05), (11.3, 14.3), (11.3, 0.3), (0.0, 0.3)], 0.9, divide(5))
    body = lathe(chain(side, inside), divide(around))
    over = arc((0.0, -13.0), 30.8, 67.2, 90.0, divide(10))
    below = arc((0.0, -13.0), 30.5, 90.0, 67.3, divide(10))
    lid = lathe(chain(below, over), divide(around))
    stem = [(0.0, 17.0), (0.9, 17.0), (0.7, 18.6), (2.1, 19.1), (2.2, 19.9), (0.0, 20.2)]
    knob = lathe(rounded(stem, 0.3, divide(3)), divide(24))
    handles = []
    for side_of in (-1.0, 1.0):
        bend = rounded([(11.4, -3.4), (15.0, -3.4), (15.0, 3.4), (11.4, 3.4)], 1.7, divide(6))
        path = np.column_stack([side_of * bend[:, 0], bend[:, 1], np.full(len(bend), 11.2)])
        handles.append(tube(path, 0.5, divide(12)))
    return {"body": body, "lid": lid, "fittings": join(knob, *handles)}


def saucepan(divide, around=52):
    """An open pan and its long handle, along +x."""
    side = rounded([(0.0, 0.0), (7.8, 0.0), (8.2, 8.8), (8.6, 9.1)], 0.9, divide(5))
    inside = rounded([(8.45, 9.25), (7.95, 8.9), (7.55, 0.3), (0.0, 0.3)], 0.8, divide(5))
    path = spline([(8.0, 0.0, 7.2), (10.5, 0.0, 8.0), (16.0, 0.0, 9.2), (25.0, 0.0, 10.2)], divide(14))
    return {"body": lathe(chain(side, inside), divide(around)), "handle": tube(path, 0.75, divide(16))}


def bowl(divide, around=40):
    """An open bowl of china."""
    outside = spline([(4.4, 0.55), (7.4, 1.9), (10.6, 4.8), (12.4, 8.6)], divide(10))
    foot = rounded([(0.0, 0.35), (3.6, 0.35), (3.7, 0.0), (4.3, 0.0), (4.4, 0.55)], 0.1, divide(2))
    inside = spline([(0.0, 0.9), (3.6, 1.0), (7.2, 2.3), (10.3, 5.1), (12.05, 8.65)], divide(14))
    return empty_vessel(chain(foot, outside), inside, divide(around), divide(4))


def lemon(divide, around=28):
    """About its centre, its ends along z."""
    half = [
        (0.0, -4.5),
        (0.45, -4.25),
        (0.8, -3.7),
        (2.0, -2.7),
        (2.85, 0.0),
        (2.1, 2.5),
        (0.9, 3.5),
        (0.5, 3.9),
        (0.0, 4.05),
    ]
    return lathe(spline(half, divide(20)), divide(around))


def ladle(divide, around=26):
    """Hangs from its hook at the origin; its bowl opens towards -y."""
    path = [
        (0.0, 0.9, -1.2),
        (0.0, 1.1, 0.2),
        (0.0, 0.0, 0.75),
        (0.0, -0.6, -0.6),
        (0.0, -0.4, -4.0),
        (0.0, -0.3, -24.0),
    ]
    handle = tube(spline(path, divide(20)), 0.28, divide(9))
    outer, inner = arc((0.0, 0.0), 4.0, -90.0, 0.0, divide(9)), arc((0.0, 0.0), 3.85, 0.0, -90.0, divide(9))
    scoop = lathe(chain(outer, inner), divide(around)).turned(62.0, "x")
    return join(handle, scoop.moved(y=-3.6, z=-26.2))
