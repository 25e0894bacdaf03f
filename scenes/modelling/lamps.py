"""Lamps behind closed walls of glass, so that no shadow ray from outside arrives."""

import numpy as np

from .curves import arc, chain, line
from .mesh import join, shell
from .shapes import ball, lathe, rectangle, slab, tube


def globe_lamp(centre, radius, wall, glow, divide):
    """What shines, and the globe of glass around it: an outer wall and an inner one that faces the hollow."""
    globe = shell(ball(radius, divide(6)), ball(radius - wall, divide(6)))
    return ball(glow, 2).moved(*centre), globe.moved(*centre)


def fitting(radius, rod, height, divide):
    """What a globe of a radius hangs on: a cap that does not touch it, and a rod up to a height above its centre."""
    near, far = 1.015 * radius, 1.055 * radius
    cap = chain(arc((0.0, 0.0), near, 90.0, 68.0, divide(4)), arc((0.0, 0.0), far, 68.0, 90.0, divide(4)))
    return join(lathe(cap, divide(16)), tube(line((0.0, 0.0, 1.01 * far), (0.0, 0.0, height)), rod, divide(8)))


def light_box(width, height, depth, wall):
    """A case that shines towards +z through a pane of glass: what shines, the case (open) and the pane.

    The pane, a wall thick, covers the rim, and what shines lies as deep as the case, so that hardly any light leaves
    beside it."""
    w, h = width / 2.0, height / 2.0
    corner, right, up, ahead = (
        np.array((-w, -h, 0.0)),
        np.diag((width, 0, 0))[0],
        np.diag((0, height, 0))[1],
        (0, 0, depth),
    )
    shine = rectangle(corner, right, up).moved(z=0.01 * depth)
    case = join(
        rectangle(corner, right, up),
        rectangle(corner, ahead, right),
        rectangle(corner + right, ahead, up),
        rectangle(corner + right + up, ahead, -right),
        rectangle(corner + up, ahead, -up),
    )
    overlap, gap = 0.5 * depth, 0.002 * depth
    pane = slab((-w - overlap, -h - overlap, depth + gap), (w + overlap, h + overlap, depth + gap + wall))
    return shine, case, pane
