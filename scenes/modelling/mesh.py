"""Triangle meshes: joined, moved, turned inside out, and written as PLY."""

import gzip
from dataclasses import dataclass
from pathlib import Path

import numpy as np

# What positions (in scene units) and normals are rounded to: powers of two, so that rounding is exact, floats end in
# zero bits (which gzip likes), and the last bit of a machine's sine does not reach the file.
POSITION_STEP = 2.0**-16
NORMAL_STEP = 2.0**-12


def unit(vectors):
    """Vectors divided by their lengths, along the last axis."""
    vectors = np.asarray(vectors, dtype=float)
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-300)


@dataclass(frozen=True)
class Mesh:
    """Faces are counter-clockwise as seen from outside. Without normals a mesh is shaded flat."""

    points: np.ndarray
    faces: np.ndarray
    normals: np.ndarray | None = None

    def moved(self, x=0.0, y=0.0, z=0.0):
        return Mesh(self.points + [x, y, z], self.faces, self.normals)

    def scaled(self, factor):
        return Mesh(self.points * factor, self.faces, self.normals)

    def turned(self, degrees, axis="z"):
        """Rotated about an axis through the origin, counter-clockwise as seen from its tip."""
        first, second = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
        cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        matrix = np.eye(3)
        matrix[[first, first, second, second], [first, second, first, second]] = cos, -sin, sin, cos
        normals = None if self.normals is None else self.normals @ matrix.T
        return Mesh(self.points @ matrix.T, self.faces, normals)

    def aligned(self, direction):
        """Rotated so that what pointed along +z points along the direction."""
        direction = unit(direction)
        tilt = np.degrees(np.arccos(np.clip(direction[2], -1.0, 1.0)))
        return self.turned(tilt, "y").turned(np.degrees(np.arctan2(direction[1], direction[0])), "z")

    def flipped(self):
        """Inside out: the inner wall of a shell faces the hollow."""
        return Mesh(self.points, self.faces[:, ::-1], None if self.normals is None else -self.normals)

    def write(self, path):
        """A binary PLY file, compressed if it is called .gz; the same mesh gives the same bytes."""
        columns = [np.round(self.points / POSITION_STEP) * POSITION_STEP + 0.0]  # + 0.0: no negative zeros
        names = ["x", "y", "z"]
        if self.normals is not None:
            columns.append(np.round(unit(self.normals) / NORMAL_STEP) * NORMAL_STEP + 0.0)
            names += ["nx", "ny", "nz"]
        faces = np.empty(len(self.faces), dtype=[("count", "u1"), ("index", "<i4", 3)])
        faces["count"], faces["index"] = 3, self.faces
        header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(self.points)}"]
        header += [f"property float {name}" for name in names]
        header += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header", ""]
        data = "\n".join(header).encode() + np.hstack(columns).astype("<f4").tobytes() + faces.tobytes()
        Path(path).write_bytes(gzip.compress(data, 9, mtime=0) if str(path).endswith(".gz") else data)


def join(*meshes):
    """One mesh of several; either all have normals or none has."""
    starts = np.cumsum([0] + [len(mesh.points) for mesh in meshes[:-1]])
    smooth = meshes[0].normals is not None
    return Mesh(
        np.vstack([mesh.points for mesh in meshes]),
        np.vstack([mesh.faces + start for mesh, start in zip(meshes, starts, strict=True)]),
        np.vstack([mesh.normals for mesh in meshes]) if smooth else None,
    )


def shell(outer, inner):
    """A hollow body's two walls."""
    return join(outer, inner.flipped())
