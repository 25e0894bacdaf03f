"""What tests of `lampyris render` share."""

import pytest

from support.render_program import SCENE


@pytest.fixture
def scene(tmp_path):
    """A small scene's file, where a test may change it."""
    path = tmp_path / "scene.pbrt"
    path.write_text(SCENE)
    return path
