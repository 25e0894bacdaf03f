"""What tests of the program share."""

import pytest

from support.plugin_project import checked
from support.render_program import SCENE


@pytest.fixture(scope="session")
def installed(build_dir, tmp_path_factory):
    """Where Lampyris is installed, for plugins to be built against."""
    prefix = tmp_path_factory.mktemp("an installation") / "lampyris"
    checked("cmake", "--install", build_dir, "--prefix", prefix)
    return prefix


@pytest.fixture
def scene(tmp_path):
    """A small scene's file, where a test may change it."""
    path = tmp_path / "scene.pbrt"
    path.write_text(SCENE)
    return path
