"""Options of the Python tests: --regex selects by name, like `ctest -R`; `long` marks tests that only --long runs."""

import os
import re
import subprocess
from pathlib import Path

import pytest

SOURCE_DIR = Path(__file__).resolve().parent.parent


def pytest_addoption(parser):
    parser.addoption("--regex", default="", help="run only tests whose name (file::test) matches")


def pytest_configure(config):
    config.addinivalue_line("markers", "long: takes minutes; ./dev test --long runs it")


def pytest_collection_modifyitems(config, items):
    regex = re.compile(config.getoption("--regex"))
    chosen = [item for item in items if regex.search(item.nodeid)]
    config.hook.pytest_deselected(items=[item for item in items if item not in chosen])
    items[:] = chosen


@pytest.fixture(scope="session")
def source_dir():
    return SOURCE_DIR


@pytest.fixture(scope="session")
def build_dir():
    """The CMake build tree under test, set by ./dev test."""
    return Path(os.environ.get("LAMPYRIS_BUILD_DIR", SOURCE_DIR / "build/release"))


@pytest.fixture(scope="session", autouse=True)
def patience(build_dir):
    """With sanitizers, programs get five times the time that a test gives them, as in tests/CMakeLists.txt."""
    cache = build_dir / "CMakeCache.txt"
    if not cache.exists() or not re.search(r"^LAMPYRIS_SANITIZE:\w+=.", cache.read_text(), flags=re.MULTILINE):
        yield
        return
    communicate = subprocess.Popen.communicate  # subprocess.run waits here, too

    def wait_longer(process, input=None, timeout=None):
        return communicate(process, input, timeout and 5 * timeout)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(subprocess.Popen, "communicate", wait_longer)
        yield


@pytest.fixture(scope="session")
def program(build_dir):
    return build_dir / "lampyris"
