"""A photon map that is built outside of the tree against an installed Lampyris works with Lampyris's consumers, on
both backends."""

import json

import pytest

from support.plugin_project import EVERY, build, checked, configure, write_files


@pytest.fixture(scope="module")
def outside(installed, tmp_path_factory):
    folder = tmp_path_factory.mktemp("outside")
    write_files(folder / "every", EVERY)
    configure(folder / "every", installed, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release")
    build(folder / "every")
    return folder


def test_a_photon_map_from_outside_finds_the_same_photons(installed, outside):
    program = installed / "bin/lampyris"
    arguments = [
        "--structures",
        "every,sorted_grid",
        "--points",
        "2000",
        "--queries",
        "500",
        "--seconds",
        "0",
        "--json",
    ]
    for backend in ["cpu", "vulkan"]:
        done = checked(
            program,
            "bench",
            "photon-maps",
            "--plugin",
            outside / "every/build/every.so",
            "--backend",
            backend,
            *arguments,
        )
        every, sorted_grid = json.loads(done.stdout)["rows"]
        assert every["structure"] == "every"
        assert every["photons_found_mean"] == sorted_grid["photons_found_mean"] > 5
