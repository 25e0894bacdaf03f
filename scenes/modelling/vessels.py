"""Vessels of glass, and what is in them, as interfaces that meet without coinciding."""

import numpy as np

from .curves import arc, chain, resampled
from .shapes import lathe


def lip(outer, inner, steps):
    """Half a circle from the outer wall's upper end to the inner wall's."""
    middle, radius = (outer + inner) / 2.0, np.linalg.norm(outer - inner) / 2.0
    lean = np.degrees(np.arctan2(*(outer - inner)[::-1]))
    curve = arc(middle, radius, lean, lean + 180.0, steps)
    curve[0], curve[-1] = outer, inner
    return curve


def empty_vessel(outside, inside, around, steps):
    """A solid between two walls, both drawn from the axis to the rim; the lip has so many steps."""
    return lathe(chain(outside, lip(outside[-1], inside[-1], steps), inside[::-1]), around)


def filled_vessel(outside, inside, level, meniscus, around, steps):
    """Three interfaces, which meet in the circle where the meniscus ends: glass-air, liquid-glass and liquid-air.

    Those of the liquid face out of it, into the glass and the air. The meniscus climbs and reaches so far. The steps
    are those of the lip, of the inner wall below and above the circle, of the meniscus and of the rest of the surface.
    """
    lip_steps, below_steps, above_steps, meniscus_steps, flat_steps = steps
    climb, reach = meniscus
    wall = resampled(inside, 2000)
    contact = np.argmax(wall[:, 1] > level + climb)
    edge = wall[contact]
    below, above = resampled(wall[: contact + 1], below_steps), resampled(wall[contact:], above_steps)
    t = np.linspace(0.0, 1.0, meniscus_steps + 1)
    # Close to the exponential that capillarity gives a shallow meniscus.
    curve = np.exp(-3.0 * t) * (1.0 - t)
    surface = np.column_stack([edge[0] - reach * t, level + (edge[1] - level) * curve])
    top = chain(surface, resampled([surface[-1], (0.0, level)], flat_steps))
    glass = chain(outside, lip(outside[-1], wall[-1], lip_steps), above[::-1])
    return lathe(glass, around), lathe(below, around), lathe(top, around)
