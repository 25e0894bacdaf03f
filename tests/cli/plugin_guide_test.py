"""The plugin guide, followed to the letter: its files are built outside the tree against an installed Lampyris, loaded
with --plugin, and give the image whose answer the scene's comment derives, on every backend."""

import os

import numpy as np
import pytest

from support.plugin_project import build, check_example, configure, guide_files, run, write_files

FACING_MEAN = 2.0 / 3.0  # of sqrt(1 - r^2) over the unit disc
FACING_SQUARED_MEAN = 1.0 / 2.0


def read_pfm(path):
    with open(path, "rb") as file:
        kind, size, scale = (file.readline().split() for _ in range(3))
        width, height = int(size[0]), int(size[1])
        values = np.frombuffer(file.read(), dtype="<f4" if float(scale[0]) < 0 else ">f4")
    return values.reshape(height, width, 3 if kind == [b"PF"] else 1)[::-1].astype(np.float64)


def test_the_guide_shows_the_example(source_dir):
    check_example(source_dir, "plugin-guide.md", "facing")


@pytest.fixture(scope="module")
def outside(source_dir, installed, tmp_path_factory):
    """The guide's plugin, built against an installed Lampyris with nothing of this tree but the guide."""
    folder = tmp_path_factory.mktemp("outside")
    (folder / "lampyris").symlink_to(installed)
    write_files(folder / "facing", guide_files(source_dir, "plugin-guide.md", "facing"))
    configure(folder / "facing", installed, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release")
    build(folder / "facing")
    return folder


def render(outside, image, *options, environment=None):
    program = outside / "lampyris/bin/lampyris"
    environment = os.environ | (environment or {})
    return run(program, "render", "facing/sphere.pbrt", "-o", image, *options, cwd=outside, env=environment)


@pytest.mark.parametrize(
    ("options", "mean"), [([], FACING_MEAN), (["--integrator", "facing:power=2"], FACING_SQUARED_MEAN)]
)
def test_both_backends_give_the_derived_answer(outside, options, mean):
    images = {}
    for backend in ["cpu", "vulkan"]:
        done = render(outside, f"{backend}.pfm", "--plugin", "facing/build/facing.so", "--backend", backend, *options)
        assert done.returncode == 0, done.stderr
        images[backend] = read_pfm(outside / f"{backend}.pfm")
        # 16 samples of 100 x 100 pixels over a window of 2.5 x 2.5, half of them on the disc: the standard deviation of
        # the mean is below 0.4 / sqrt(160000) = 0.001; five of those, so one run in two million fails by chance.
        disc = images[backend].mean() * 2.5**2 / np.pi
        assert disc == pytest.approx(mean, abs=0.005)
        assert np.all(images[backend][0, :] == 0.0)
    different = np.mean(np.any(images["cpu"] != images["vulkan"], axis=2))
    assert different <= 0.001  # design: at least 99.9 % of pixels equal to the bit


def test_the_plugin_path_names_files_and_folders(outside):
    for path in ["facing/build", "facing/build/facing.so"]:
        done = render(outside, "path.pfm", "--quiet", environment={"LAMPYRIS_PLUGIN_PATH": path})
        assert done.returncode == 0, done.stderr


def test_without_the_plugin_its_name_is_unknown(outside):
    done = render(outside, "none.pfm")
    assert done.returncode == 1
    assert 'unknown integrator "facing"' in done.stderr
    assert "sphere.pbrt:3:" in done.stderr


def test_a_wrong_parameter_is_told_as_for_a_built_in_integrator(outside):
    plugin = ["--plugin", "facing/build/facing.so"]
    done = render(outside, "none.pfm", *plugin, "--integrator", "facing:powr=2")
    assert done.returncode == 1
    assert "powr" in done.stderr
    assert "power" in done.stderr
    done = render(outside, "none.pfm", *plugin, "--integrator", "facing:power=-1")
    assert done.returncode == 1
    assert "0 to 100" in done.stderr


def test_a_plugin_that_is_none_is_refused(outside):
    done = render(outside, "none.pfm", "--plugin", outside / "lampyris/lib/liblampyris.so")
    assert done.returncode == 1
    assert "is no Lampyris plugin" in done.stderr
