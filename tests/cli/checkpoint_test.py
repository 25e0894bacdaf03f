"""Checkpoints and images so far: a program that is killed at any moment loses at most what came after the last one."""

import random
import signal
import subprocess
import time

import pytest

from support.render_program import command, run, stats_of

PATH = ["--integrator", "path", "--resolution", "160x120"]
SPPM = ["--integrator", "sppm:photonsperiteration=20000", "--resolution", "96x64"]
FAMILIES = {
    "path": [*PATH, "--passes", "1500"],
    "sppm": [*SPPM, "--passes", "150"],
    "vcm": ["--integrator", "vcm", "--resolution", "64x48", "--photon-map", "stochastic_hash", "--passes", "500"],
    "mlt": ["--integrator", "mlt", "--resolution", "64x48", "--passes", "120"],
}


def killed_until_done(program, scene, folder, more, random_numbers, most):
    """Renders with a checkpoint, is killed at random moments, `most` times at most, and goes on to the end."""
    folder.mkdir()
    image = folder / "killed.pfm"
    arguments = [*more, "-o", image, "--checkpoint", folder / "state", "--every", "0.05s", "--resume", "--quiet"]
    killed = 0
    while killed < most:
        with subprocess.Popen(command(program, scene, *arguments), stderr=subprocess.PIPE, text=True) as process:
            try:
                _, errors = process.communicate(timeout=random_numbers.uniform(0.2, 1.2))
            except subprocess.TimeoutExpired:
                process.send_signal(signal.SIGKILL)
                killed += 1
            else:
                assert process.returncode == 0, errors
                break
    done = run(program, scene, *arguments)
    assert done.returncode == 0, done.stderr
    return image.read_bytes(), killed


def check_family(program, scene, folder, family, kills, backend="cpu"):
    """As many renderings as it takes to kill one so often."""
    whole = folder / "whole.pfm"
    more = [*FAMILIES[family], "--backend", backend]
    done = run(program, scene, *more, "-o", whole, timeout=300)
    assert done.returncode == 0, done.stderr
    random_numbers = random.Random(7)
    killed = turn = 0
    while killed < kills:
        turn += 1
        content, times = killed_until_done(program, scene, folder / str(turn), more, random_numbers, kills - killed)
        assert content == whole.read_bytes()
        killed += times
        assert turn <= kills, "renderings are done before they are killed"


@pytest.mark.parametrize("family", ["path", "sppm"])
def test_a_killed_rendering_goes_on_to_the_same_image(program, scene, tmp_path, family):
    check_family(program, scene, tmp_path, family, 5)


@pytest.mark.long
@pytest.mark.parametrize("backend", ["cpu", "cpu-bvh2", "vulkan"])
@pytest.mark.parametrize("family", FAMILIES)
def test_a_rendering_that_is_killed_fifty_times_goes_on(program, scene, tmp_path, family, backend):
    check_family(program, scene, tmp_path, family, 50, backend)


def test_the_image_so_far_is_written(program, scene, tmp_path):
    image, statistics = tmp_path / "so-far.pfm", tmp_path / "so-far.json"
    arguments = [*PATH, "-o", image, "--stats", statistics, "--time", "1h", "--every", "0.3s", "--quiet"]
    with subprocess.Popen(command(program, scene, *arguments), stderr=subprocess.PIPE, text=True) as process:
        deadline = time.monotonic() + 60
        seen = set()
        while len(seen) < 2:
            assert time.monotonic() < deadline and process.poll() is None
            time.sleep(0.05)
            if statistics.exists():
                seen.add(stats_of(statistics)["passes"])
        first = image.read_bytes()
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=60)
    assert process.returncode == 130
    assert len(image.read_bytes()) == len(first) > 160 * 120 * 12
    assert sorted(one.name for one in tmp_path.iterdir()) == ["scene.pbrt", "so-far.json", "so-far.pfm"]


def test_an_image_that_cannot_be_written_meanwhile_does_not_end_the_rendering(program, scene, tmp_path):
    folder = tmp_path / "gone"
    folder.mkdir()
    image = folder / "a.pfm"
    arguments = [*PATH, "-o", image, "--time", "4s", "--every", "0.2s"]
    with subprocess.Popen(command(program, scene, *arguments), stderr=subprocess.PIPE, text=True) as process:
        deadline = time.monotonic() + 60
        while not image.exists():
            assert time.monotonic() < deadline and process.poll() is None
            time.sleep(0.05)
        image.unlink()
        folder.rmdir()
        time.sleep(1.0)
        folder.mkdir()
        _, errors = process.communicate(timeout=60)
    assert process.returncode == 0, errors
    assert "the image so far is not written any more" in errors
    assert image.exists()


def test_a_checkpoint_is_not_overwritten_by_mistake(program, scene, tmp_path):
    state = tmp_path / "state"
    arguments = [*PATH, "-o", tmp_path / "a.pfm", "--checkpoint", state, "--passes", "2"]
    assert run(program, scene, *arguments).returncode == 0
    before = state.read_bytes()
    done = run(program, scene, *arguments)
    assert done.returncode == 1 and "--resume" in done.stderr
    assert state.read_bytes() == before
    done = run(program, scene, *arguments, "--resume", "--seed", "9")
    assert done.returncode == 1 and "its seed is" in done.stderr
    assert run(program, scene, "-o", tmp_path / "a.pfm", "--resume").returncode == 1


def test_more_passes_can_be_asked_for_later(program, scene, tmp_path):
    whole, later = tmp_path / "whole.pfm", tmp_path / "later.pfm"
    assert run(program, scene, *PATH, "-o", whole, "--passes", "9").returncode == 0
    state = ["--checkpoint", tmp_path / "state"]
    assert run(program, scene, *PATH, *state, "-o", later, "--passes", "4").returncode == 0
    statistics = tmp_path / "later.json"
    more = ["--passes", "9", "--resume", "--stats", statistics]
    assert run(program, scene, *PATH, *state, "-o", later, *more).returncode == 0
    assert later.read_bytes() == whole.read_bytes()
    told = stats_of(statistics)
    assert told["passes"] == 9
    passes = [point["passes"] for point in told["convergence"]]
    assert passes == sorted(set(passes)) and passes[0] == 1 and passes[-1] == 9


@pytest.mark.parametrize(
    "options",
    [["--checkpoint", "a.pfm"], ["--stats", "a.pfm"], ["-o", "./a.pfm"], ["--stats", "b", "--checkpoint", "b"]],
)
def test_files_that_would_replace_each_other_are_refused(program, scene, tmp_path, options):
    done = run(program, scene, *PATH, "-o", "a.pfm", *options, "--passes", "1", cwd=tmp_path)
    assert done.returncode == 1 and "are the same file" in done.stderr
    assert [one.name for one in tmp_path.iterdir()] == ["scene.pbrt"]
