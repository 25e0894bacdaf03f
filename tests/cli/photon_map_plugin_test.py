"""The guide to photon maps, followed to the letter: its map is built outside of the tree against an installed Lampyris,
and finds what brute_force finds with Lampyris' consumers, on every backend."""

import json

import pytest

from support.plugin_project import QUICK, build, check_example, checked, configure, guide_files, write_files

SCENE = """
LookAt 0 1 -4  0 0.5 0  0 1 0
Camera "perspective" "float fov" 45
Film "rgb" "integer xresolution" 24 "integer yresolution" 16
WorldBegin
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 9 9 9 ]
  Translate 0 3 0
  Rotate 90 1 0 0
  Shape "disk" "float radius" 0.5
AttributeEnd
Material "diffuse" "rgb reflectance" [ 0.6 0.5 0.4 ]
Shape "trianglemesh" "point3 P" [ -4 0 -4  4 0 -4  4 0 4  -4 0 4 ] "integer indices" [ 0 1 2 0 2 3 ]
Translate 0 0.6 0
Shape "sphere" "float radius" 0.6
"""


def test_the_guide_shows_the_example(source_dir):
    check_example(source_dir, "photon-map-guide.md", "slabs")


@pytest.fixture(scope="module")
def outside(source_dir, installed, tmp_path_factory):
    folder = tmp_path_factory.mktemp("outside")
    write_files(folder / "slabs", guide_files(source_dir, "photon-map-guide.md", "slabs"))
    (folder / "scene.pbrt").write_text(SCENE)
    configure(folder / "slabs", installed, "-G", "Ninja", *QUICK)
    build(folder / "slabs")
    return folder


@pytest.mark.parametrize("backend", ["cpu", "cpu-bvh2", "vulkan"])
def test_it_finds_what_brute_force_finds(installed, outside, backend):
    images = []
    for choice in ["brute_force", "slabs", "slabs:slabs=1", "slabs:slabs=4096"]:
        image = outside / "image.pfm"
        arguments = [
            "--backend",
            backend,
            "--integrator",
            "photon_map:photons=2000,nearest=40,radius=0.5",
            "--passes",
            "2",
        ]
        plugin = ["--plugin", outside / "slabs/build/slabs.so", "--photon-map", choice]
        checked(installed / "bin/lampyris", "render", outside / "scene.pbrt", "-o", image, *arguments, *plugin)
        images.append(image.read_bytes())
    assert len(set(images[0][-24 * 16 * 12 :])) > 50  # there is a picture
    assert all(image == images[0] for image in images)


def test_the_benchmark_takes_it(installed, outside):
    arguments = [
        "--structures",
        "slabs,sorted_grid",
        "--points",
        "2000",
        "--queries",
        "500",
        "--seconds",
        "0",
        "--json",
    ]
    plugin = ["--plugin", outside / "slabs/build/slabs.so"]
    for backend in ["cpu", "vulkan"]:
        done = checked(installed / "bin/lampyris", "bench", "photon-maps", *plugin, "--backend", backend, *arguments)
        slabs, sorted_grid = json.loads(done.stdout)["rows"]
        assert slabs["structure"] == "slabs"
        assert slabs["photons_found_mean"] == sorted_grid["photons_found_mean"] > 5
