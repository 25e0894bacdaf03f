"""Ctrl-C and SIGTERM in every phase of `lampyris render`, and messages that nobody can read: neither loses an image."""

import os
import pty
import random
import signal
import subprocess
import time
from collections import Counter

import pytest

from support.render_program import command, read_pfm, run, stats_of

SIGNALS = [signal.SIGINT, signal.SIGTERM]
SECONDS = 2.0  # in which the program ends, of a machine that does nothing else
SLACK = 8.0  # for one that does


def wait_until_caught(process, signal_number):
    """Waits until the program handles the signal, which would otherwise kill it while it is loading."""
    deadline = time.monotonic() + 60
    caught = 0
    while not caught >> (signal_number - 1) & 1:
        assert time.monotonic() < deadline
        time.sleep(0.02)
        with open(f"/proc/{process.pid}/status") as status:
            caught = next((int(line.split()[1], 16) for line in status if line.startswith("SigCgt:")), 0)


def interrupted(arguments, signal_number, after):
    """What the program returned and said, and how long it took to end."""
    with subprocess.Popen(arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        wait_until_caught(process, signal_number)
        time.sleep(after)
        assert process.poll() is None
        start = time.monotonic()
        process.send_signal(signal_number)
        output, errors = process.communicate(timeout=60)
        return process.returncode, output, errors, time.monotonic() - start


@pytest.mark.parametrize("signal_number", SIGNALS)
@pytest.mark.parametrize("moment", ["loading", "photons", "first pass"])
def test_before_a_pass_is_done_the_older_image_stays(program, scene, tmp_path, moment, signal_number):
    image = tmp_path / "o.pfm"
    image.write_bytes(b"an older image")
    more = {
        "loading": ["--spp", "100000", "--resolution", "900x900"],
        "photons": ["--integrator", "photon_map:photons=20000000"],
        "first pass": ["--integrator", "sppm:photonsperiteration=20000000"],
    }[moment]
    arguments = command(program, scene, "-o", image, *more)
    code, output, errors, seconds = interrupted(arguments, signal_number, 0.0 if moment == "loading" else 1.0)
    assert code == 130, errors
    assert image.read_bytes() == b"an older image"
    assert "nothing is written" in errors
    assert f"'{image}' is left as it was" in errors
    assert "wrote" not in output
    assert seconds < SECONDS + SLACK


def test_a_shader_that_compiles_is_interrupted(program, scene, tmp_path):
    image = tmp_path / "o.pfm"
    image.write_bytes(b"an older image")
    text = scene.read_text().replace('"diffuse"', '"coateddiffuse" "float roughness" 0.1')
    scene.write_text(text)
    environment = {**os.environ, "MESA_SHADER_CACHE_DIR": str(tmp_path)}
    arguments = command(program, scene, "-o", image, "--backend", "vulkan", "--set", "backend.cache=off")
    with subprocess.Popen(arguments, stderr=subprocess.PIPE, text=True, env=environment) as process:
        said = process.stderr.readline()
        assert said.startswith("compiling kernel path for Vulkan, "), said
        start = time.monotonic()
        process.send_signal(signal.SIGINT)
        errors = process.communicate(timeout=60)[1]
        assert process.returncode == 130, errors
        assert time.monotonic() - start < SECONDS + SLACK
    assert "nothing is written" in errors
    assert image.read_bytes() == b"an older image"


@pytest.mark.parametrize("backend", ["cpu", "vulkan"])
def test_a_long_pass_is_cut_short(program, scene, tmp_path, backend):
    """The image of the passes before the signal is written."""
    image, file = tmp_path / "o.pfm", tmp_path / "stats.json"
    arguments = command(program, scene, "-o", image, "--stats", file, "--integrator", "path", "--time", "10min")
    arguments += ["--resolution", "1200x800", "--backend", backend]
    with subprocess.Popen(arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        while "pass" not in process.stderr.readline():
            assert process.poll() is None
        start = time.monotonic()
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)
        assert process.returncode == 130
        assert time.monotonic() - start < SECONDS + SLACK
    assert read_pfm(image)[:2] == (1200, 800)
    stats = stats_of(file)
    assert stats["interrupted"] is True
    assert stats["passes"] >= 1


# ---- Messages that do not arrive -------------------------------------------------------------------------------------


def broken_pipe():
    reading, writing = os.pipe()
    os.close(reading)
    return writing


def gone_terminal():
    leader, follower = pty.openpty()
    os.close(leader)
    return follower


SINKS = {
    "full": lambda: os.open("/dev/full", os.O_WRONLY),
    "broken pipe": broken_pipe,
    "gone terminal": gone_terminal,
}


@pytest.mark.parametrize("sink", SINKS)
def test_standard_error_that_takes_nothing(program, scene, tmp_path, sink):
    image = tmp_path / "o.pfm"
    stream = SINKS[sink]()
    try:
        done = subprocess.run(
            command(program, scene, "-o", image), stdout=subprocess.PIPE, stderr=stream, timeout=60, check=False
        )
    finally:
        os.close(stream)
    assert done.returncode == 0
    assert read_pfm(image)[:2] == (24, 16)


@pytest.mark.parametrize("closed", ["2>&-", ">&- 2>&-", "<&- >&- 2>&-"])
def test_closed_streams(program, scene, tmp_path, closed):
    """An image that is opened next must not get the descriptor of standard error."""
    image, right = tmp_path / "o.pfm", tmp_path / "right.pfm"
    assert run(program, scene, "-o", right).returncode == 0
    done = subprocess.run(f'"{program}" render "{scene}" -o "{image}" {closed}', shell=True, timeout=60, check=False)
    assert done.returncode == (2 if ">&- 2" in closed else 0)  # the text for standard output is lost
    assert image.read_bytes() == right.read_bytes()


def test_an_error_is_an_error_whoever_reads_it(program, tmp_path):
    for closed in ["2>&-", "2>/dev/full"]:
        text = f'"{program}" render "{tmp_path}/missing.pbrt" -o "{tmp_path}/o.pfm" {closed}'
        assert subprocess.run(text, shell=True, timeout=60, check=False).returncode == 1


# ---- A rendering that hangs or fails in its second pass --------------------------------------------------------------


@pytest.fixture
def hangs(program, build_dir, scene, tmp_path):
    """Starts the integrator of tests/plugins/hangs.cpp, which is done with one pass."""

    def start(what, *more):
        arguments = command(program, scene, "-o", tmp_path / "o.pfm", "--stats", tmp_path / "stats.json")
        arguments += ["--plugin", str(build_dir / "test_plugins/hangs.so"), "--integrator", "hangs", "--passes", "9"]
        environment = {**os.environ, "HANGS": what}
        return subprocess.Popen([*arguments, *map(str, more)], stderr=subprocess.PIPE, text=True, env=environment)

    return start


def test_what_is_done_is_written_while_a_pass_hangs(hangs, tmp_path):
    checkpoint = tmp_path / "c.ckpt"
    with hangs("for ever", "--checkpoint", checkpoint) as process:
        assert "1 pass" in process.stderr.readline()
        start = time.monotonic()
        process.send_signal(signal.SIGTERM)
        errors = process.communicate(timeout=60)[1]
        assert time.monotonic() - start < SECONDS + SLACK
    assert process.returncode == 130
    assert "the pass does not end: what there was after 1 pass is written" in errors
    assert read_pfm(tmp_path / "o.pfm")[:2] == (24, 16)
    stats = stats_of(tmp_path / "stats.json")
    assert stats["interrupted"] is True
    assert stats["passes"] == 1
    with hangs("", "--checkpoint", checkpoint, "--resume") as process:
        process.communicate(timeout=60)
    assert process.returncode == 0
    assert stats_of(tmp_path / "stats.json")["passes"] == 9


def test_a_second_signal_ends_at_once(hangs, tmp_path):
    with hangs("for ever") as process:
        assert "1 pass" in process.stderr.readline()
        process.send_signal(signal.SIGTERM)
        assert "what is done is written" in process.stderr.readline()
        start = time.monotonic()
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=60)
        assert time.monotonic() - start < 1.0 + SLACK
    assert process.returncode == 130
    assert not (tmp_path / "o.pfm").exists()


def test_messages_that_nobody_reads_do_not_keep_it(program, scene, tmp_path):
    """Standard error is a full pipe: the first signal's message waits, and the second signal ends the program."""
    reading, writing = os.pipe()
    arguments = command(program, scene, "-o", tmp_path / "o.pfm", "--time", "10min", "--quiet")
    try:
        process = subprocess.Popen(arguments, stderr=writing)
        os.set_blocking(writing, False)
        with pytest.raises(BlockingIOError):
            while True:
                os.write(writing, b" " * 4096)
        os.set_blocking(writing, True)
        wait_until_caught(process, signal.SIGTERM)
        for _ in range(2):
            time.sleep(0.5)
            process.send_signal(signal.SIGTERM)
        assert process.wait(timeout=SECONDS + SLACK) == 130
    finally:
        process.kill()
        process.wait()
        os.close(reading)
        os.close(writing)


def test_nobody_reads_anything(program, scene, tmp_path):
    """Both streams are a full pipe: after the signal, the image is written, and the program ends."""
    reading, writing = os.pipe()
    arguments = command(program, scene, "-o", tmp_path / "o.pfm", "--time", "10min")
    try:
        os.set_blocking(writing, False)
        with pytest.raises(BlockingIOError):
            while True:
                os.write(writing, b" " * 4096)
        os.set_blocking(writing, True)
        process = subprocess.Popen(arguments, stdout=writing, stderr=writing)
        wait_until_caught(process, signal.SIGTERM)
        time.sleep(1.0)
        process.send_signal(signal.SIGTERM)
        assert process.wait(timeout=SECONDS + SLACK) == 130
        assert read_pfm(tmp_path / "o.pfm")[:2] == (24, 16)
    finally:
        process.kill()
        process.wait()
        os.close(reading)
        os.close(writing)


@pytest.mark.parametrize("what, message", [("device lost", "the device was lost"), ("no memory", "memory")])
def test_what_is_done_is_written_before_the_program_fails(hangs, tmp_path, what, message):
    checkpoint = tmp_path / "c.ckpt"
    with hangs(what, "--checkpoint", checkpoint) as process:
        errors = process.communicate(timeout=60)[1]
    assert process.returncode == 2
    assert message in errors
    assert "the rendering failed: what there was after 1 pass is written" in errors
    assert read_pfm(tmp_path / "o.pfm")[:2] == (24, 16)
    assert stats_of(tmp_path / "stats.json")["passes"] == 1
    with hangs("", "--checkpoint", checkpoint, "--resume") as process:
        process.communicate(timeout=60)
    assert process.returncode == 0
    assert stats_of(tmp_path / "stats.json")["passes"] == 9


# ---- Any moment ------------------------------------------------------------------------------------------------------

KINDS = [
    ["--integrator", "path", "--resolution", "800x600"],
    ["--integrator", "sppm:photonsperiteration=2000000", "--resolution", "200x150"],
    ["--integrator", "vcm", "--resolution", "300x200"],
    ["--integrator", "mlt", "--resolution", "300x200"],
    ["--integrator", "photon_map:photons=2000000", "--resolution", "200x150"],
]


def check_moments(program, scene, tmp_path, moments, slack):
    """SIGTERM at random moments: the image is the older one, or a new one that is not black."""
    random_numbers = random.Random(11)
    image = tmp_path / "o.pfm"
    outcomes = Counter()
    for turn in range(moments):
        image.write_bytes(b"an older image")
        arguments = command(program, scene, "-o", image, *KINDS[turn % len(KINDS)], "--time", "10min")
        with subprocess.Popen(arguments, stderr=subprocess.PIPE, text=True) as process:
            wait_until_caught(process, signal.SIGTERM)
            time.sleep(random_numbers.choice([0.0, 0.1, random_numbers.uniform(0.0, 4.0)]))
            start = time.monotonic()
            process.send_signal(signal.SIGTERM)
            errors = process.communicate(timeout=60)[1]
            seconds = time.monotonic() - start
        assert process.returncode == 130, errors
        assert seconds < SECONDS + slack, f"{seconds} s: {arguments}"
        if image.read_bytes() == b"an older image":
            assert "nothing is written" in errors
            outcomes["older"] += 1
        else:
            rows = read_pfm(image)[2]
            assert sum(map(sum, rows)) / sum(map(len, rows)) > 0.1
            outcomes["new"] += 1
    assert min(outcomes["older"], outcomes["new"]) > 0


def test_at_a_few_moments(program, scene, tmp_path):
    check_moments(program, scene, tmp_path, 2 * len(KINDS), SLACK)


@pytest.mark.long
def test_at_a_hundred_moments(program, scene, tmp_path):
    check_moments(program, scene, tmp_path, 100, 0.5)
