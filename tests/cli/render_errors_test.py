"""`lampyris render`: errors and exit codes for scenes, the command line, files and the machine."""

import os
import subprocess
import threading
import time

import pytest

from support.render_program import SCENE, command, run, stats_of


def assert_refused(done, code, *parts):
    assert done.returncode == code, done.stderr
    assert done.stdout == ""
    assert "error:" in done.stderr
    for part in parts:
        assert part in done.stderr


def test_scene_errors_are_located_with_a_caret(program, scene, tmp_path):
    scene.write_text(SCENE.replace('"sphere"', '"shpere"').replace("LightSource", "LigtSource"))
    done = run(program, scene, "-o", tmp_path / "o.exr")
    assert_refused(done, 1, f"{scene}:8:1: error:", f"{scene}:10:7: error:", "sphere", "LightSource", "did you mean")
    lines = done.stderr.splitlines()
    line = next(i for i, text in enumerate(lines) if text.startswith(f"{scene}:10:7"))
    assert lines[line + 1].startswith('Shape "shpere"')
    assert lines[line + 2] == "      ^"
    assert not (tmp_path / "o.exr").exists()


@pytest.mark.parametrize(
    ("arguments", "part"),
    [
        (["--integrator", "pth"], "path"),
        (["--set", "integrator.maxdeth=3"], "maxdepth"),
        (["--set", "integrator.maxdepth=many"], "maxdepth"),
        (["--set", "maxdepth=3"], "SECTION.KEY=VALUE"),
        (["--set", "film.iso=3"], "film"),
        (["--integrator", "path:maxdepth"], "maxdepth"),
        (["--backend", "cuda"], "vulkan"),
        (["--spp", "0"], "--spp"),
        (["--spp", "-3"], "spp"),
        (["--spp", "many"], "spp"),
        (["--time", "soon"], "soon"),
        (["--target-error", "-1"], "--target-error"),
        (["--resolution", "0x5"], "--resolution"),
        (["--integrator", ""], "--integrator: is empty"),
        (["--photon-map", ""], "--photon-map: is empty"),
        (["--seed", ""], "--seed: is empty"),
        (["--exposure", ""], "--exposure: is empty"),
        (["--resolution", "wide"], "--resolution"),
        (["--crop", "0,0,99,5"], "24x16"),
        (["--crop", "3,3,3,5"], "3,3"),
        (["--crop", "1,2,3"], "--crop"),
        (["--replay", "24,0,0"], "24x16"),
        (["--replay", "0,0,-1"], "--replay"),
        (["--max-memory", "lots"], "lots"),
        (["--seed", "-1"], "seed"),
        (["--threads", "0"], "threads"),
        (["--plugin", "/no/such/plugin.so"], "plugin.so"),
        (["--reference", "/no/such/reference.exr"], "reference.exr"),
        (["--view", "Sepia"], "Sepia"),
        (["--no-such-option"], "no-such-option"),
        (["--integrater", "path"], 'did you mean "--integrator"?'),
        (["--integrator", "path:maxdepth=3,maxdepth=4"], '"maxdepth" is set twice'),
        (["--set", "backend.ray_query=on"], "backend cpu has no setting"),
        (["--max-memory", "0"], "amount of memory"),
        (["--exposure", "nan"], "--exposure"),
    ],
)
def test_wrong_arguments(program, scene, tmp_path, arguments, part):
    done = run(program, scene, "-o", tmp_path / "o.png", *arguments)
    assert_refused(done, 1, part)
    assert not (tmp_path / "o.png").exists()


def test_an_unknown_integrator_of_the_scene_is_located(program, scene, tmp_path):
    scene.write_text(SCENE.replace('Integrator "path"', 'Integrator "pathh"'))
    assert_refused(run(program, scene, "-o", tmp_path / "o.exr"), 1, f"{scene}:6:12: error:", "pathh", "path")
    # Another one on the command line renders the scene.
    assert run(program, scene, "-o", tmp_path / "o.exr", "--integrator", "path").returncode == 0


def test_what_pbrt_has_and_lampyris_has_not_can_be_skipped(program, scene, tmp_path):
    scene.write_text(
        SCENE.replace('Integrator "path"', 'Integrator "volpath" "bool regularize" true')
        .replace('Film "rgb"', 'Film "spectral" "integer nbuckets" 16')
        .replace('Camera "perspective"', 'Camera "spherical" "string mapping" "equalarea"')
    )
    parts = ["path regularization is not supported", 'film "spectral" is', 'camera "spherical" is']
    assert_refused(run(program, scene, "-o", tmp_path / "o.exr"), 1, *parts)
    stats = tmp_path / "stats.json"
    done = run(program, scene, "-o", tmp_path / "o.exr", "--skip-unsupported", "--stats", stats)
    assert done.returncode == 0, done.stderr
    assert len(stats_of(stats)["unsupported"]) == 3
    assert stats_of(stats)["integrator"]["name"] == "path"


def test_outputs_that_cannot_be_written_are_told_before_rendering(program, scene, tmp_path):
    started = time.monotonic()
    missing = tmp_path / "no-such-folder"
    done = run(program, scene, "-o", missing / "o.exr", "--time", "60s")
    assert done.returncode in (1, 2)
    assert "no-such-folder" in done.stderr
    done = run(program, scene, "-o", tmp_path / "o.gif", "--time", "60s")
    assert done.returncode == 1
    assert ".exr" in done.stderr
    done = run(program, scene, "-o", tmp_path / "o.exr", "--stats", missing / "s.json", "--time", "60s")
    assert done.returncode in (1, 2)
    assert "no-such-folder" in done.stderr
    done = run(program, scene, "-o", tmp_path, "--time", "60s")
    assert done.returncode in (1, 2)
    assert time.monotonic() - started < 30


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_no_permission_is_the_machines_fault(program, scene, tmp_path):
    folder = tmp_path / "closed"
    folder.mkdir(mode=0o500)
    assert_refused(run(program, scene, "-o", folder / "o.exr"), 2, "closed", "ermission")


def test_a_folder_that_takes_no_files_is_the_machines_fault(program, scene):
    assert run(program, scene, "-o", "/proc/o.exr").returncode == 2


def test_too_little_memory_is_the_machines_fault(program, scene, tmp_path):
    assert_refused(run(program, scene, "-o", tmp_path / "o.exr", "--max-memory", "1K"), 2, "--max-memory")
    assert run(program, scene, "-o", tmp_path / "o.exr", "--max-memory", "1G").returncode == 0
    done = run(program, scene, "-o", tmp_path / "o.exr", "--max-memory", "256M", "--resolution", "8000x8000")
    assert_refused(done, 2, "--max-memory", "film")


def test_a_device_that_does_not_exist_is_told(program, scene, tmp_path):
    for backend in ["vulkan", "cpu"]:
        done = run(program, scene, "-o", tmp_path / "o.exr", "--backend", backend, "--device", "99")
        assert_refused(done, 2, "99", "the backend cpu has" if backend == "cpu" else "Vulkan has")


def test_scenes_that_cannot_be_read(program, tmp_path):
    image = tmp_path / "o.exr"
    assert_refused(run(program, tmp_path / "missing.pbrt", "-o", image), 1, "missing.pbrt", "No such file")
    assert_refused(run(program, tmp_path, "-o", image), 1, str(tmp_path), "directory")
    binary = tmp_path / "binary.pbrt"
    binary.write_bytes(bytes(range(256)) * 10)
    assert_refused(run(program, binary, "-o", image), 1, "binary.pbrt:1:1")
    binary.write_bytes(b"")
    assert run(program, binary, "-o", image).returncode in (0, 1)
    assert run(program).returncode == 1


def test_a_pipe_is_told_and_does_not_hang(program, tmp_path):
    pipe = tmp_path / "pipe.pbrt"
    os.mkfifo(pipe)
    writer = threading.Thread(target=lambda: os.close(os.open(pipe, os.O_RDWR)), daemon=True)
    writer.start()
    assert_refused(run(program, pipe, "-o", tmp_path / "o.exr", timeout=20), 1, "pipe.pbrt", "not a regular file")


@pytest.mark.parametrize("name", ["with space.pbrt", "ümläut-光.pbrt", "quote'\".pbrt", "-dash.pbrt", "%s{}.pbrt"])
def test_odd_file_names(program, tmp_path, name):
    folder = tmp_path / name.removesuffix(".pbrt")
    folder.mkdir()
    (folder / name).write_text(SCENE)
    image, file = folder / name.replace("pbrt", "exr"), folder / name.replace("pbrt", "json")
    done = run(program, folder / name, "-o", image, "--stats", file)
    assert done.returncode == 0, done.stderr
    assert image.exists()
    assert stats_of(file)["scene"] == str(folder / name)
    (folder / name).write_text(SCENE.replace("Shape", "Shpe"))
    assert f"{folder / name}:10:1: error:" in run(program, folder / name, "-o", image).stderr


def test_a_full_disk_is_the_machines_fault(program, scene, tmp_path):
    with open("/dev/full", "w", encoding="utf-8") as full:
        done = subprocess.run(
            command(program, scene, "-o", tmp_path / "o.exr"),
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            timeout=60,
            check=False,
        )
    assert done.returncode == 2
    assert "No space left" in done.stderr
