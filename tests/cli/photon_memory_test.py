"""The memory of photon mapping does not depend on the number of passes."""

import json
import subprocess

import pytest


def statistics(program, folder, photons, passes):
    """Statistics of a small picture with this many photons per pass."""
    scene = folder / "scene.pbrt"
    scene.write_text(
        """
        LookAt 0 -1.9 0  0 2 0  0 0 1
        Camera "perspective" "float fov" 150
        Film "rgb" "integer xresolution" 64 "integer yresolution" 64
        WorldBegin
        LightSource "point" "rgb I" [ 1 1 1 ]
        Material "diffuse" "rgb reflectance" [ 0.5 0.5 0.5 ]
        Shape "sphere" "float radius" 2
        """
    )
    stats = folder / "stats.json"
    command = [program, "render", scene, "-o", folder / "image.pfm", "--stats", stats, "--passes", str(passes), "-q"]
    integrator = f"sppm:photonsperiteration={photons},direct=photons,radius=0.02"
    done = subprocess.run([*command, "--integrator", integrator], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(stats.read_text())


def grown(program, folder, photons, passes):
    """Memory after all passes over that after three, and the photons that were emitted."""
    few = statistics(program, folder, photons, 3)
    many = statistics(program, folder, photons, passes)
    assert many["photons_emitted"] == photons * passes
    assert many["photons_stored"] > many["photons_emitted"]
    return many["peak_memory_bytes"] / few["peak_memory_bytes"], many


def test_memory_does_not_grow_with_passes(program, tmp_path):
    ratio, many = grown(program, tmp_path, 100_000, 60)
    # Memory of a pass: 32 bytes per stored photon plus the map's share, and a few hundred bytes per pixel.
    assert ratio < 1.03, many["peak_memory_bytes"]


@pytest.mark.long
def test_a_hundred_million_photons(program, tmp_path):
    ratio, many = grown(program, tmp_path, 1_000_000, 100)
    assert many["photons_emitted"] == 100_000_000
    assert ratio < 1.03, many["peak_memory_bytes"]
    print(f"{many['photons_stored']} photons stored, {many['peak_memory_bytes'] / 1e6:.0f} MB")
