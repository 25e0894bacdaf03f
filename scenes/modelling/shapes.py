"""Solids as meshes with outward normals, closed unless they say otherwise; z is up."""

import numpy as np

from .curves import arc, curve_normals
from .mesh import Mesh, join, unit

CREASE = np.cos(np.radians(40.0))  # edges of a profile that are sharper than this are not smoothed


def lathe(profile, segments, loop=False):
    """A profile of points (r, z) turned about the z axis; the body lies to the left of the profile's direction.

    Ends on the axis become poles; a loop's last point is its first; other ends stay open."""
    profile = np.asarray(profile, dtype=float)
    edges = np.diff(profile, axis=0)
    facing = unit(np.stack([edges[:, 1], -edges[:, 0]], axis=1))
    angles = np.arange(segments) * (2.0 * np.pi / segments)
    around = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    points, normals, faces = [], [], []

    def ring(point, normal):
        start = sum(map(len, points))
        if point[0] < 1e-9:
            points.append(np.array([[0.0, 0.0, point[1]]]))
            normals.append(np.array([[0.0, 0.0, np.sign(normal[1])]]))
            return np.full(segments, start)
        points.append(np.column_stack([point[0] * around, np.full(segments, point[1])]))
        normals.append(np.column_stack([normal[0] * around, np.full(segments, normal[1])]))
        return start + np.arange(segments)

    last = len(edges) - 1
    before = facing[last] if loop else facing[0]
    smooth = before @ facing[0] > CREASE
    lower = first = ring(profile[0], unit(before + facing[0]) if smooth else facing[0])
    for i in range(last + 1):
        after = facing[i + 1] if i < last else (facing[0] if loop else facing[i])
        joined = facing[i] @ after > CREASE
        if loop and i == last and joined:
            upper = first
        else:
            upper = ring(profile[i + 1], unit(facing[i] + after) if joined else facing[i])
        right, above = np.roll(lower, -1), np.roll(upper, -1)
        if profile[i, 0] >= 1e-9:
            faces.append(np.stack([lower, right, above if profile[i + 1, 0] >= 1e-9 else upper], axis=1))
        if profile[i + 1, 0] >= 1e-9:
            faces.append(np.stack([lower, above, upper], axis=1))
        lower = upper
        if i < last and not joined:
            lower = ring(profile[i + 1], after)
    return Mesh(np.vstack(points), np.vstack(faces), np.vstack(normals))


def torus(major, minor, around, across):
    """A ring about the z axis."""
    return lathe(arc((major, 0.0), minor, 0.0, 360.0, across), around, loop=True)


def ball(radius, frequency):
    """A geodesic sphere: an icosahedron's faces, each split into frequency^2."""
    golden = (1.0 + 5.0**0.5) / 2.0
    corners = np.array([(0, s, t * golden) for s in (-1, 1) for t in (-1, 1)], dtype=float)
    corners = unit(np.vstack([np.roll(corners, shift, axis=1) for shift in range(3)]))
    apart = np.linalg.norm(corners[:, None] - corners[None], axis=2)
    near = (apart > 0.1) & (apart < 1.2)
    triples = [(a, b, c) for a in range(12) for b in range(a + 1, 12) for c in range(b + 1, 12)]
    index, points, faces = {}, [], []

    def vertex(weights):
        # Named by its integer weights of the corners, so that faces share the vertices of their common edge.
        key = tuple(sorted((corner, weight) for corner, weight in weights if weight))
        if key not in index:
            index[key] = len(points)
            points.append(unit(sum(corners[corner] * weight for corner, weight in key)))
        return index[key]

    for a, b, c in triples:
        if not (near[a, b] and near[b, c] and near[a, c]):
            continue
        if np.dot(np.cross(corners[b] - corners[a], corners[c] - corners[a]), corners[a]) < 0:
            b, c = c, b  # noqa: PLW2901 (the face as seen from outside)
        for i in range(frequency):
            for j in range(frequency - i):
                at = lambda u, v, a=a, b=b, c=c: vertex([(a, frequency - u - v), (b, u), (c, v)])  # noqa: E731
                faces.append((at(i, j), at(i + 1, j), at(i, j + 1)))
                if i + j < frequency - 1:
                    faces.append((at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)))
    normals = np.array(points)
    return Mesh(normals * radius, np.array(faces), normals)


def rounded_box(size, radius, steps):
    """A box about the origin whose edges and corners are rounded, by 2 * steps strips an edge."""
    core = np.asarray(size, dtype=float) / 2.0 - radius
    quarter = np.tan(np.radians(np.linspace(0.0, 45.0, steps + 1)))
    # Along each axis of a face: the rounded part of one end, then that of the other; between them lies what is flat.
    reach = np.concatenate([-quarter[::-1], quarter])
    side = np.repeat([-1.0, 1.0], steps + 1)
    count = len(reach)
    u, v = (grid.ravel() for grid in np.meshgrid(np.arange(count), np.arange(count), indexing="ij"))
    cell = (np.arange(count - 1)[:, None] * count + np.arange(count - 1)).ravel()
    quads = np.stack([cell, cell + count, cell + count + 1, cell + 1], axis=1)
    parts = []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            second, third = (axis + 1) % 3, (axis + 2) % 3
            direction, corner = np.empty((count * count, 3)), np.empty((count * count, 3))
            direction[:, axis], corner[:, axis] = sign, sign
            direction[:, second], direction[:, third] = reach[u], reach[v]
            corner[:, second], corner[:, third] = side[u], side[v]
            normals = unit(direction)
            mesh = Mesh(
                corner * core + normals * radius, np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]), normals
            )
            parts.append(mesh if sign > 0 else Mesh(mesh.points, mesh.faces[:, ::-1], mesh.normals))
    return join(*parts)


def slab(low, high):
    """A box with sharp edges between two corners, shaded flat: 12 triangles."""
    low, high = np.asarray(low, dtype=float), np.asarray(high, dtype=float)
    points = np.array([[(low, high)[(i >> axis) & 1][axis] for axis in range(3)] for i in range(8)])
    quads = np.array([(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)])
    return Mesh(points, np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]))


def rectangle(corner, first, second):
    """Two triangles, shaded flat; the normal is first x second. Open."""
    corner, first, second = (np.asarray(vector, dtype=float) for vector in (corner, first, second))
    return Mesh(
        np.array([corner, corner + first, corner + first + second, corner + second]), np.array([(0, 1, 2), (0, 2, 3)])
    )


def tile(width, height, thickness, bevel):
    """A wall tile in the xy plane with a bevelled front towards +z and no back: 10 triangles. Open."""
    outer = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * [width / 2.0, height / 2.0]
    inner = np.sign(outer) * (np.abs(outer) - bevel)
    points = np.vstack([np.column_stack([outer, np.zeros(4)]), np.column_stack([inner, np.full(4, thickness)])])
    sides = [face for i in range(4) for face in ((i, (i + 1) % 4, 4 + (i + 1) % 4), (i, 4 + (i + 1) % 4, 4 + i))]
    # The bevel fades from the front's normal to a tilted one: it shows as rounded.
    tilted = unit(np.column_stack([np.sign(outer), np.full(4, 0.7)]))
    return Mesh(points, np.array([(4, 5, 6), (4, 6, 7), *sides]), np.vstack([tilted, np.tile([0.0, 0.0, 1.0], (4, 1))]))


def tube(path, radius, segments, loop=False):
    """A pipe along a path in space, its ends closed by flat caps."""
    path = np.asarray(path, dtype=float)
    ahead = np.roll(path, -1, axis=0) - path if loop else np.vstack([np.diff(path, axis=0), path[-1:] - path[-2:-1]])
    behind = np.roll(ahead, 1, axis=0) if loop else np.vstack([ahead[:1], ahead[:-1]])
    tangents = unit(unit(ahead) + unit(behind))
    # The frame is carried along the path by projection, which adds no twist of its own.
    side = np.cross(tangents[0], np.eye(3)[np.argmin(np.abs(tangents[0]))])
    angles = np.arange(segments) * (2.0 * np.pi / segments)
    points, normals = [], []
    for centre, tangent in zip(path, tangents, strict=True):
        side = unit(side - tangent * (side @ tangent))
        ring = np.cos(angles)[:, None] * side + np.sin(angles)[:, None] * np.cross(tangent, side)
        points.append(centre + radius * ring)
        normals.append(ring)
    rings = np.arange(len(path) * segments).reshape(len(path), segments)
    if loop:
        rings = np.vstack([rings, rings[:1]])
    low, high = rings[:-1], rings[1:]
    right, above = np.roll(low, -1, axis=1), np.roll(high, -1, axis=1)
    faces = [
        np.stack([low, right, above], axis=-1).reshape(-1, 3),
        np.stack([low, above, high], axis=-1).reshape(-1, 3),
    ]
    mesh = Mesh(np.vstack(points), np.vstack(faces), np.vstack(normals))
    if loop:
        return mesh
    caps = []
    for ring, tangent, order in ((points[0], -tangents[0], -1), (points[-1], tangents[-1], 1)):
        fan = np.array([(0, i, i + 1) for i in range(1, segments - 1)])[:, ::order]
        caps.append(Mesh(ring, fan, np.tile(tangent, (segments, 1))))
    return join(mesh, *caps)


def heightfield(height, slope, low, high, cells, floor):
    """A closed block whose top is z = height(x, y), shaded by slope(x, y), and whose bottom lies at z = floor.

    Sides and bottom are separate from the top, so that its normals stay its own."""
    across, along = cells
    x, y = np.meshgrid(np.linspace(low[0], high[0], across + 1), np.linspace(low[1], high[1], along + 1), indexing="ij")
    index = np.arange(x.size).reshape(x.shape)
    a, b, c, d = index[:-1, :-1].ravel(), index[1:, :-1].ravel(), index[1:, 1:].ravel(), index[:-1, 1:].ravel()
    dx, dy = slope(x.ravel(), y.ravel())
    top = Mesh(
        np.column_stack([x.ravel(), y.ravel(), height(x.ravel(), y.ravel())]),
        np.vstack([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]),
        unit(np.column_stack([-dx, -dy, np.ones(x.size)])),
    )
    rim = np.concatenate([index[:-1, 0], index[-1, :-1], index[:0:-1, -1], index[0, :0:-1]])
    upper = top.points[rim]
    lower = upper * [1.0, 1.0, 0.0] + [0.0, 0.0, floor]
    count = len(rim)
    this, following = np.arange(count), np.roll(np.arange(count), -1)
    outward = unit((upper - np.mean(upper, axis=0)) * [1.0, 1.0, 0.0])
    wall_faces = [
        np.stack([this, this + count, following + count], axis=1),
        np.stack([this, following + count, following], axis=1),
    ]
    walls = Mesh(np.vstack([upper, lower]), np.vstack(wall_faces), np.vstack([outward, outward]))
    centre = np.array([[(low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0, floor]])
    fan = np.stack([np.full(count, count), following, this], axis=1)
    bottom = Mesh(np.vstack([lower, centre]), fan, np.tile([0.0, 0.0, -1.0], (count + 1, 1)))
    return join(top, walls, bottom)


def backdrop(profile, low, high):
    """A sheet that runs along x from low to high, through the points (y, z) of a profile. Open.

    It faces to the right of the profile's direction: drawn from the top of a wall down and forward over the floor, it
    faces the room."""
    profile = np.asarray(profile, dtype=float)
    count, facing = len(profile), curve_normals(profile)
    points = [np.column_stack([np.full(count, x), profile]) for x in (low, high)]
    start = np.arange(count - 1)
    faces = [np.stack([start, start + 1, start + 1 + count], axis=1)]
    faces += [np.stack([start, start + 1 + count, start + count], axis=1)]
    normals = np.column_stack([np.zeros(count), facing])
    return Mesh(np.vstack(points), np.vstack(faces), np.vstack([normals, normals]))
