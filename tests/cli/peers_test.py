"""bench/peers.py without the other renderer: its scenes, and its arithmetic."""

import importlib
import subprocess
import sys

import numpy
import pytest


@pytest.fixture(scope="module")
def peers(source_dir):
    # Benchmarks and tests both have a package `support`.
    with pytest.MonkeyPatch.context() as patch:
        for name in [name for name in sys.modules if name.split(".")[0] == "support"]:
            patch.delitem(sys.modules, name)
        patch.syspath_prepend(source_dir / "bench")
        yield importlib.import_module("peers")
        for name in [name for name in sys.modules if name.split(".")[0] in ("support", "peers")]:
            del sys.modules[name]


@pytest.fixture(scope="module")
def scenes(peers):
    return {scene.name: scene for scene in peers.peer_scenes() if "1000000" not in scene.name}


def test_lampyris_renders_every_scene(peers, scenes, program, tmp_path):
    for scene in scenes.values():
        for sampler in (peers.OURS, peers.INDEPENDENT):
            image = tmp_path / "image.pfm"
            command = [program, "render", scene.to_pbrt(sampler), "--spp", "1", "--resolution", "32x32", "-o", image]
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            assert done.returncode == 0, done.stderr
            assert "warning" not in done.stderr
            assert peers.read_pfm(image).mean() > 0.01


def test_mitsuba_gets_the_same_scene(scenes):
    for scene in scenes.values():
        theirs = scene.to_mitsuba()
        shapes = [value for name, value in theirs.items() if name.startswith("shape")]
        assert len(shapes) == len(scene.shapes)
        assert sum("emitter" in shape for shape in shapes) == 1
        assert theirs["integrator"]["max_depth"] == scene.maxdepth + 1  # edges, not vertices


def test_relmse_of_pairs_is_the_variance(peers):
    random = numpy.random.default_rng(1)
    reference = numpy.full((64, 64, 3), 2.0)
    images = [reference + random.normal(0, 0.2, reference.shape) for _ in range(4)]
    # The worst of a thousand numbers are left out: of a squared normal variable, these are 1.3 % of the sum.
    assert peers.relmse_of_pairs(images, reference) == pytest.approx(0.04 / 4.01, rel=0.04)


def test_other_scenes_are_noticed(peers):
    random = numpy.random.default_rng(2)
    ramp = numpy.repeat(numpy.linspace(1, 2, 64)[None, :, None], 64, axis=0).repeat(3, axis=2)

    def images(scene):
        return [scene + random.normal(0, 0.1, scene.shape) for _ in range(4)]

    assert peers.agreement(images(ramp), images(ramp))["blocks_off"] < 0.1
    assert peers.agreement(images(ramp), images(ramp[:, ::-1]))["blocks_off"] > 0.5
    assert peers.agreement(images(ramp), images(1.02 * ramp))["mean_ratio"] == pytest.approx(1.02, abs=0.003)
