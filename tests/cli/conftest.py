"""Fixtures for tests of the program."""

import pytest

from support.plugin_project import checked
from support.render_program import SCENE


@pytest.fixture(scope="session")
def installed(build_dir, tmp_path_factory):
    """A folder where Lampyris is installed, for building plugins."""
    prefix = tmp_path_factory.mktemp("an installation") / "lampyris"
    checked("cmake", "--install", build_dir, "--prefix", prefix)
    return prefix


@pytest.fixture
def scene(tmp_path):
    """The file of a small scene, which a test may change."""
    path = tmp_path / "scene.pbrt"
    path.write_text(SCENE)
    return path
