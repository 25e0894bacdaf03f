"""Ctrl-C and SIGTERM in every phase of `lampyris render`, and messages that nobody can read: neither loses an image."""

import os
import pty
import signal
import subprocess
import time

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
