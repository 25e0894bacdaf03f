"""The scenes of the photon-mapping paper: generated again, counted, and checked for what refraction requires."""

import gzip
import importlib.util
import json
import re
import subprocess
import sys

import numpy as np
import pytest

SCENES = ["box", "cognac", "kitchen", "pool", "torus"]
WRITTEN_ABOUT = {"box": 4000, "cognac": 16000, "pool": 122000, "kitchen": 44000}  # triangles, in the paper
# Surfaces closer than this coincide, for floats and rays: the smallest gap in the scenes is five
# times as wide (0.5 mm in a scene in metres, 0.1 mm in one in centimetres).
COINCIDENT = 1e-4
PARALLEL = 0.99  # cosine of the angle between surfaces that could be the same one; those that cross meet at more


def read_mesh(path):
    """Points, normals (or none) and faces of a PLY file as the generators write it."""
    header, data = gzip.decompress(path.read_bytes()).split(b"end_header\n", 1)
    vertices, faces = (int(count) for count in re.findall(rb"element \w+ (\d+)", header))
    width = header.count(b"property float")
    table = np.frombuffer(data, "<f4", vertices * width).reshape(vertices, width).astype(float)
    index = np.frombuffer(data, [("count", "u1"), ("index", "<i4", 3)], faces, vertices * width * 4)
    assert np.all(index["count"] == 3)
    return table[:, :3], table[:, 3:] if width == 6 else None, index["index"].astype(np.int64)


@pytest.fixture(scope="module", params=SCENES)
def folder(request, source_dir):
    return source_dir / "scenes" / request.param


@pytest.fixture(scope="module")
def meshes(folder):
    return {path.name.removesuffix(".ply.gz"): read_mesh(path) for path in sorted(folder.glob("*.ply.gz"))}


@pytest.fixture(scope="module")
def generator(folder):
    spec = importlib.util.spec_from_file_location(f"generate_{folder.name}", folder / "generate.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def welded(points):
    """For each point, a number that points at the same place share: creases keep a vertex for each normal."""
    return np.unique(points, axis=0, return_inverse=True)[1].ravel()


def edges(faces):
    return np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])


def test_generator_makes_the_same_files_again(folder, tmp_path):
    command = [sys.executable, folder / "generate.py", "--output", tmp_path]
    subprocess.run(command, check=True, timeout=300, stdout=subprocess.DEVNULL)
    names = sorted(path.name for path in folder.glob("*.ply.gz"))
    assert sorted(path.name for path in tmp_path.iterdir()) == names
    for name in names:
        made, kept = (tmp_path / name).read_bytes(), (folder / name).read_bytes()
        # The uncompressed data must agree to the byte; the compressed size depends on zlib's version.
        assert gzip.decompress(made) == gzip.decompress(kept), name
        assert made[4:8] == bytes(4), f"{name} holds the time when it was made"


def test_triangles_are_as_many_as_written(folder, meshes):
    count = sum(len(faces) for _, _, faces in meshes.values())
    stated = re.search(r"([\d,]+) triangles", (folder / "README.md").read_text())[1]
    assert int(stated.replace(",", "")) == count
    assert abs(count / WRITTEN_ABOUT.get(folder.name, count) - 1.0) < 0.1
    used = set(re.findall(r'"([\w-]+)\.ply\.gz"', (folder / "scene.pbrt").read_text()))
    assert used == set(meshes)


def test_bodies_are_closed(generator, meshes):
    assert set(generator.GLASS) <= {name for parts in generator.BODIES.values() for name in parts}
    for body, parts in generator.BODIES.items():
        starts = np.cumsum([0, *(len(meshes[name][0]) for name in parts)])
        points = np.vstack([meshes[name][0] for name in parts])
        faces = np.vstack(
            [meshes[name][2][:, ::side] + start for (name, side), start in zip(parts.items(), starts, strict=False)]
        )
        corners = points[faces]
        index = welded(points)[faces]
        directed = edges(index)
        # Each edge once in each direction: two triangles share it, and agree on which side is outside.
        forward = np.unique(directed, axis=0)
        assert len(forward) == len(directed), body
        assert np.array_equal(forward, np.unique(directed[:, ::-1], axis=0)), body
        volume = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6.0
        assert volume > 0.0, f"{body} is inside out"


def test_normals_point_out_of_their_faces(meshes):
    for name, (points, normals, faces) in meshes.items():
        corners = points[faces]
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        assert np.linalg.norm(across, axis=1).min() > 0.0, f"{name} has a triangle without area"
        if normals is not None:
            assert np.einsum("ij,ikj->ik", across, normals[faces]).min() > 0.0, name


def near_pairs(places, low, high, cell):
    """Pairs (point, box) where the point lies in a grid cell that the box touches."""
    first, last = (np.floor(corner / cell).astype(np.int64) for corner in (low, high))
    spans = last - first + 1
    counts = spans.prod(axis=1)
    box = np.repeat(np.arange(len(low)), counts)
    step = np.arange(len(box)) - np.repeat(np.cumsum(counts) - counts, counts)
    ny, nz = spans[box, 1], spans[box, 2]
    at = first[box] + np.stack([step // (ny * nz), step // nz % ny, step % nz], axis=1)
    primes = np.array([73856093, 19349663, 83492791])  # cells that share a hash only make more pairs
    keys, wanted = (at * primes).sum(axis=1), (np.floor(places / cell).astype(np.int64) * primes).sum(axis=1)
    order = np.argsort(keys, kind="stable")
    start, end = (np.searchsorted(keys[order], wanted, side=side) for side in ("left", "right"))
    place = np.repeat(np.arange(len(places)), end - start)
    step = np.arange(len(place)) - np.repeat(np.cumsum(end - start) - (end - start), end - start)
    return place, box[order[start[place] + step]]


def test_no_interface_coincides_with_another_surface(generator, meshes):
    names = list(meshes)
    corners = np.vstack([points[faces] for points, _, faces in meshes.values()])
    vertices = welded(corners.reshape(-1, 3)).reshape(-1, 3)
    glass = np.concatenate([np.full(len(meshes[name][2]), name in generator.GLASS) for name in names])
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    centres = corners[glass].mean(axis=1)
    size = np.median(np.ptp(corners[glass], axis=1).max(axis=1))
    low, high = corners.min(axis=1) - COINCIDENT, corners.max(axis=1) + COINCIDENT
    large = np.ceil((high - low) / size + 1.0).prod(axis=1) > 20000.0  # such would fill the grid; they are few
    place, other = near_pairs(centres, low[~large], high[~large], size)
    big = np.flatnonzero(large)
    place = np.concatenate([place, np.repeat(np.arange(len(centres)), len(big))])
    other = np.concatenate([np.flatnonzero(~large)[other], np.tile(big, len(centres))])

    mine = np.flatnonzero(glass)[place]
    facing = np.abs(np.einsum("ij,ij->i", normals[mine], normals[other])) > PARALLEL
    place, other, mine = place[facing], other[facing], mine[facing]
    close = np.abs(np.einsum("ij,ij->i", normals[other], centres[place] - corners[other, 0])) < COINCIDENT
    apart = ~(vertices[mine][:, :, None] == vertices[other][:, None, :]).any(axis=(1, 2))
    same = np.sort(vertices[mine], axis=1) == np.sort(vertices[other], axis=1)
    twins = (mine != other) & same.all(axis=1)
    assert not twins.any(), f"{twins.sum() // 2} triangles are there twice"
    place, other = place[close & apart], other[close & apart]
    inside = np.ones(len(place), dtype=bool)
    for i in range(3):
        start, end = corners[other, i], corners[other, (i + 1) % 3]
        inside &= np.einsum("ij,ij->i", np.cross(end - start, centres[place] - start), normals[other]) > 0.0
    assert not inside.any(), f"{inside.sum()} triangles lie on others, near {centres[place[inside]][:3]}"


def test_program_reads_the_scene(program, folder, meshes):
    # Without --skip-unsupported if media are supported; otherwise only media are left out.
    command = [program, "describe", folder / "scene.pbrt", "--json", "--skip-unsupported"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr
    result = json.loads(done.stdout)
    assert result["triangles"] == sum(len(faces) for _, _, faces in meshes.values())
    assert all(what.startswith("participating medium") for what in result["unsupported"])
