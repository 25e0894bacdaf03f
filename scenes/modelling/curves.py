"""Curves as arrays of points: profiles for the lathe (r, z) and paths for tubes (x, y, z)."""

import numpy as np

from .mesh import unit


def line(start, end, steps=1):
    return np.linspace(start, end, steps + 1)


def arc(centre, radius, start, end, steps):
    """Part of a circle in the plane, from one angle to another [degrees], counter-clockwise if the second is larger."""
    angles = np.radians(np.linspace(start, end, steps + 1))
    return np.asarray(centre) + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def spline(points, steps):
    """A smooth curve through points (centripetal Catmull-Rom, Barry and Goldman 1988), in equal lengths."""
    points = np.asarray(points, dtype=float)
    padded = np.vstack([2 * points[0] - points[1], points, 2 * points[-1] - points[-2]])
    knots = np.concatenate([[0.0], np.cumsum(np.sqrt(np.linalg.norm(np.diff(padded, axis=0), axis=1)))])
    pieces = []
    for i in range(1, len(padded) - 2):
        p, k = padded[i - 1 : i + 3], knots[i - 1 : i + 3]
        t = np.linspace(k[1], k[2], 33)[:, None]
        level = list(p)
        for order in (1, 2):
            level = [
                ((k[j + order] - t) * level[j] + (t - k[j]) * level[j + 1]) / (k[j + order] - k[j])
                for j in range(4 - order)
            ]
        pieces.append(((k[2] - t) * level[0] + (t - k[1]) * level[1]) / (k[2] - k[1]))
    return resampled(np.vstack(pieces), steps)


def resampled(points, steps):
    """The same curve as steps pieces of equal length."""
    points = np.asarray(points, dtype=float)
    points = points[np.concatenate([[True], np.linalg.norm(np.diff(points, axis=0), axis=1) > 1e-12])]
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    wanted = np.linspace(0.0, along[-1], steps + 1)
    return np.stack([np.interp(wanted, along, column) for column in points.T], axis=1)


def chain(*parts):
    """Curves one after the other, without the points that they share."""
    joined = [np.asarray(parts[0], dtype=float)]
    for part in map(np.asarray, parts[1:]):
        joined.append(part[1:] if np.linalg.norm(part[0] - joined[-1][-1]) < 1e-9 else part)
    return np.vstack(joined)


def rounded(corners, radius, steps):
    """A polyline in the plane with its corners (all but the ends) turned into arcs of a radius."""
    corners = np.asarray(corners, dtype=float)
    parts = [corners[:1]]
    for before, corner, after in zip(corners, corners[1:], corners[2:], strict=False):
        first, second = unit(before - corner), unit(after - corner)
        half = 0.5 * np.arccos(np.clip(first @ second, -1.0, 1.0))
        reach = min(
            radius / np.tan(half), 0.49 * np.linalg.norm(before - corner), 0.49 * np.linalg.norm(after - corner)
        )
        centre = corner + unit(first + second) * reach / np.cos(half)
        start, end = corner + first * reach - centre, corner + second * reach - centre
        t = np.linspace(0.0, 1.0, steps + 1)[:, None]
        angle = np.pi - 2.0 * half
        parts.append(centre + (np.sin((1 - t) * angle) * start + np.sin(t * angle) * end) / np.sin(angle))
    return np.vstack([*parts, corners[-1:]])


def curve_normals(points):
    """Unit normals of a profile, to the right of its direction: out of a body that is drawn from its foot upwards."""
    edges = np.diff(points, axis=0)
    ahead = unit(np.stack([edges[:, 1], -edges[:, 0]], axis=1))
    return unit(np.vstack([ahead[:1], ahead]) + np.vstack([ahead, ahead[-1:]]))


def offset(points, distance):
    """The profile moved along its normals (to its left: a wall inside of it is at a negative distance)."""
    points = np.asarray(points, dtype=float)
    return points + distance * curve_normals(points)
