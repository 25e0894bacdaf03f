"""The program starts without OpenImageIO, which takes a quarter of a second, and loads it where an image needs it."""

import shutil
import subprocess

import pytest

from support.render_program import run

SMALL = ["--resolution", "8x8", "--spp", "1", "--quiet"]


def loaded(process_output):
    return [line.split()[-1] for line in process_output.splitlines() if "calling init" in line]


def test_openimageio_is_loaded_for_other_formats_only(program, scene, tmp_path):
    for name, expected in (("a.exr", False), ("a.pfm", False), ("a.png", True)):
        done = run(program, scene, *SMALL, "-o", tmp_path / name, env={"LD_DEBUG": "libs"})
        assert done.returncode == 0
        libraries = loaded(done.stderr)
        assert any("libembree" in library for library in libraries)
        assert any("libOpenImageIO" in library for library in libraries) == expected


@pytest.fixture
def without_formats(build_dir, tmp_path):
    """A copy of the program that lacks the library for other formats."""
    folder = tmp_path / "bin"
    folder.mkdir()
    for file in (build_dir / "lampyris", *build_dir.glob("liblampyris.so*")):
        shutil.copy2(file, folder, follow_symlinks=False)
    return folder


def test_a_library_that_is_missing_is_told_before_the_work(without_formats, scene, tmp_path):
    program, environment = without_formats / "lampyris", {"LD_LIBRARY_PATH": str(without_formats)}
    done = run(program, scene, *SMALL, "-o", tmp_path / "a.exr", env=environment)
    assert done.returncode == 0
    # 10^9 samples: they are not rendered first.
    done = run(
        program,
        scene,
        "--resolution",
        "8x8",
        "--spp",
        "1000000000",
        "-o",
        tmp_path / "a.png",
        env=environment,
        timeout=60,
    )
    assert done.returncode == 2
    assert "liblampyris_formats.so" in done.stderr
    compared = subprocess.run(
        [program, "compare", tmp_path / "a.exr", tmp_path / "a.exr"], capture_output=True, check=False, env=environment
    )
    assert compared.returncode == 0
