"""Pipes and devices in place of files: an error, never a program that waits for ever."""

import os
import subprocess

import pytest

from support.render_program import run

SMALL = ["--resolution", "8x8", "--spp", "1", "--quiet"]


@pytest.fixture
def pipe(tmp_path):
    os.mkfifo(tmp_path / "pipe.exr")
    return tmp_path / "pipe.exr"


@pytest.mark.parametrize("name", ["pipe", "/dev/zero"])
@pytest.mark.parametrize("option", ["--reference", "--plugin"])
def test_nothing_is_read_from_them(program, scene, tmp_path, pipe, option, name):
    name = pipe if name == "pipe" else name
    done = run(program, scene, *SMALL, "-o", tmp_path / "a.exr", option, name, timeout=20)
    assert done.returncode == 1
    assert "it is not a regular file" in done.stderr
    assert not (tmp_path / "a.exr").exists()


def test_nothing_is_compared_with_them(program, scene, tmp_path, pipe):
    assert run(program, scene, *SMALL, "-o", tmp_path / "a.exr").returncode == 0
    for names in ([pipe, "a.exr"], ["a.exr", pipe], ["/dev/zero", "a.exr"]):
        arguments = [str(program), "compare", *map(str, names)]
        done = subprocess.run(arguments, capture_output=True, text=True, check=False, timeout=20, cwd=tmp_path)
        assert done.returncode == 1 and "it is not a regular file" in done.stderr


@pytest.mark.parametrize("option", ["-o", "--stats"])
def test_a_pipe_that_nobody_reads_is_an_error(program, scene, tmp_path, pipe, option):
    arguments = ["-o", pipe] if option == "-o" else ["-o", tmp_path / "a.exr", "--stats", pipe]
    done = run(program, scene, *SMALL, *arguments, timeout=20)
    assert done.returncode == 2
    assert "no program reads from this pipe" in done.stderr
