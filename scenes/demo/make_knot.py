#!/usr/bin/env python3
"""Writes knot.pbrt: a trefoil knot as a control mesh for loopsubdiv, which makes it smooth."""

import math
from pathlib import Path

AROUND, ACROSS = 96, 8  # control vertices along the knot and around its tube
TUBE = 0.29  # the control tube's radius; subdivision shrinks it by a tenth


def centre(t):
    """A trefoil knot, lying down: parameter 0 to 2 pi."""
    return (
        (math.sin(t) + 2.0 * math.sin(2.0 * t)) * 0.36,
        (math.cos(t) - 2.0 * math.cos(2.0 * t)) * 0.36,
        -math.sin(3.0 * t) * 0.28,
    )


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(v):
    length = math.sqrt(sum(x * x for x in v))
    return tuple(x / length for x in v)


def vertex(i, j):
    t, step = 2.0 * math.pi * i / AROUND, 1e-4
    tangent = unit([b - a for a, b in zip(centre(t - step), centre(t + step), strict=True)])
    # The tube's cross-section turns with the direction away from the vertical axis, so it closes without a seam.
    side = unit(cross(tangent, (0.0, 0.0, 1.0)))
    up = cross(side, tangent)
    angle = 2.0 * math.pi * j / ACROSS
    return [c + TUBE * (math.cos(angle) * s + math.sin(angle) * u) for c, s, u in zip(centre(t), side, up, strict=True)]


def main():
    points = [vertex(i, j) for i in range(AROUND) for j in range(ACROSS)]
    faces = []
    for i in range(AROUND):
        for j in range(ACROSS):
            a, b = i * ACROSS + j, i * ACROSS + (j + 1) % ACROSS
            c, d = (i + 1) % AROUND * ACROSS + j, (i + 1) % AROUND * ACROSS + (j + 1) % ACROSS
            faces += [(a, c, b), (b, c, d)]
    lines = ["# Made by make_knot.py.", 'Shape "loopsubdiv" "integer levels" 3', '  "point3 P" [']
    lines += ["    " + " ".join(f"{x:.4f}" for x in point) for point in points]
    lines += ["  ]", '  "integer indices" [']
    lines += ["    " + "  ".join(f"{a} {b} {c}" for a, b, c in faces[k : k + 8]) for k in range(0, len(faces), 8)]
    lines += ["  ]", ""]
    Path(__file__).with_name("knot.pbrt").write_text("\n".join(lines))


if __name__ == "__main__":
    main()
