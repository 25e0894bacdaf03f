"""A small reproduction: no run is repeated, a kill costs one run, damage is repaired, and one line adds a method."""

import fcntl
import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from support.plugin_project import QUICK

TARGET = "robustness"
SMALL = [
    "--backends=cpu",
    f"--set={TARGET}.scenes=['sds-lamp']",
    f"--set={TARGET}.time_s=0.2",
]
METHODS = """
[integrators]
path = { use = "path", label = "path tracing" }
ppm = { use = "ppm:photonsperiteration={photons}", structures = true, label = "PPM" }
sppm = { use = "sppm:photonsperiteration={photons}", structures = true, label = "SPPM" }
LINE
[structures]
stochastic_hash = { use = "stochastic_hash" }
"""


@pytest.fixture(scope="module")
def reproduction(source_dir, program, tmp_path_factory):
    """The folder of this file's reproduction, and the command that makes it."""
    folder = tmp_path_factory.mktemp("reproduce")
    methods = folder / "methods.toml"
    methods.write_text(METHODS.replace("LINE\n", ""))
    command = [sys.executable, source_dir / "experiments/reproduce.py", TARGET, *SMALL]
    command += ["--program", program, "--folder", folder / "out", "--methods", methods]
    return folder / "out", [str(word) for word in command]


def call(command, **options):
    return subprocess.run(command, capture_output=True, text=True, timeout=300, check=False, **options)


def made_at(folder):
    """When each result was written: the date of each run.json."""
    return {path.parent.name: path.stat().st_mtime_ns for path in folder.glob("runs/*/run.json")}


def test_a_killed_reproduction_loses_one_run_at_most(reproduction):
    folder, command = reproduction
    started = subprocess.Popen(
        command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True, text=True
    )
    deadline = time.monotonic() + 200
    while len(made_at(folder)) < 2:
        assert started.poll() is None, "it ended before it could be killed"
        assert time.monotonic() < deadline
        time.sleep(0.02)
    os.killpg(started.pid, signal.SIGKILL)
    started.wait()
    before = made_at(folder)
    assert 2 <= len(before) < 4
    done = call(command)
    assert done.returncode == 0, done.stdout + done.stderr
    after = made_at(folder)
    assert len(after) == 4
    assert {key: after[key] for key in before} == before  # finished runs are unchanged
    assert "4 runs, " in done.stdout
    assert (folder / "index.html").exists()


def test_a_second_call_makes_nothing(reproduction):
    folder, command = reproduction
    runs, page = made_at(folder), (folder / "index.html").stat().st_mtime_ns
    sections = {path: path.stat().st_mtime_ns for path in folder.glob("targets/*/*/section.json")}
    assert len(runs) == 4
    assert len(sections) == 1
    done = call(command)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "0 of them still to do" in done.stdout
    assert made_at(folder) == runs
    assert (folder / "index.html").stat().st_mtime_ns == page
    assert {path: path.stat().st_mtime_ns for path in folder.glob("targets/*/*/section.json")} == sections


def test_a_damaged_result_is_made_again(reproduction):
    folder, command = reproduction
    before = made_at(folder)
    victim = sorted(before)[1]
    image = folder / "runs" / victim / "image.exr"
    image.write_bytes(image.read_bytes()[:-100])
    done = call(command)
    assert done.returncode == 0, done.stdout + done.stderr
    assert f"{victim}: image.exr is not what was written" in done.stderr
    assert "1 of them still to do" in done.stdout
    changed = {key for key, date in made_at(folder).items() if date != before[key]}
    assert changed == {victim}


def test_two_reproductions_do_not_share_a_folder(reproduction):
    folder, command = reproduction
    with (folder / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        done = call(command)
    assert done.returncode == 1
    assert f"another reproduction runs in {folder}" in done.stderr


@pytest.fixture(scope="module")
def plugin(source_dir, build_dir, tmp_path_factory):
    """The plugin of the plugin guide, built outside of the tree."""
    folder = tmp_path_factory.mktemp("plugin")
    for words in [
        ["cmake", "--install", build_dir, "--prefix", folder / "lampyris"],
        ["cmake", "-S", source_dir / "examples/facing", "-B", folder / "build", "-G", "Ninja"]
        + [*QUICK, f"-DCMAKE_PREFIX_PATH={folder / 'lampyris'}"],
        ["cmake", "--build", folder / "build"],
    ]:
        done = call([str(word) for word in words])
        assert done.returncode == 0, done.stdout + done.stderr
    return next((folder / "build").rglob("*.so"))


def test_one_line_adds_an_integrator_to_plots_and_page(reproduction, plugin):
    folder, command = reproduction
    before = made_at(folder)
    methods = Path(command[command.index("--methods") + 1])
    methods.write_text(
        METHODS.replace("LINE", f'facing = {{ use = "facing", plugin = "{plugin}", label = "what faces the eye" }}')
    )
    done = call(command)
    assert done.returncode == 0, done.stdout + done.stderr
    after = made_at(folder)
    assert len(after) == len(before) + 1
    assert before.items() <= after.items()  # the others are used as they are
    section = json.loads((folder / f"targets/parallel_ppm_2010/{TARGET}/section.json").read_text())
    assert any(one["method"] == "facing" for viewer in section["viewers"] for one in viewer["images"])
    assert any(one["method"] == "facing" for plot in section["plots"] for one in plot["series"])
    assert any("what faces the eye" in map(str, row.values()) for table in section["tables"] for row in table["rows"])
    page = (folder / "index.html").read_text()
    assert "what faces the eye" in page
    assert str(plugin) in (folder / "page/data.js").read_text()  # the command behind its image


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["frobnicate"], "no target is called 'frobnicate'; there are: scenes"),
        (["--backends", "gpu"], "--backends: 'gpu'; there are: cpu, vulkan"),
        (["--device", "no such device"], "no Vulkan device matches 'no such device'"),
        (["--set", "robustness"], "expected TARGET.KEY=VALUE"),
        (["--set", "frobnicate.x=1"], "expected TARGET.KEY=VALUE"),
        (["--set", "robustness.times=1"], "robustness has no 'times'; it has: against"),
        (["--set", "robustness.time_s=soon"], "expected a value such as 4"),
        (["--set", "additional_noise.passes=4"], "expected a value such as [4, 16]"),
        (["--methods", "/no/such.toml"], "/no/such.toml does not exist"),
        (["--half"], "unrecognized arguments: --half"),
    ],
)
def test_wrong_words_are_told_in_a_line(source_dir, program, tmp_path, words, said):
    script = source_dir / "experiments/reproduce.py"
    done = call([sys.executable, script, "--folder", tmp_path, "--program", program, *words])
    assert done.returncode == 1
    assert said in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1


def test_targets_are_listed(source_dir):
    done = call([sys.executable, source_dir / "experiments/reproduce.py", "--list"])
    assert done.returncode == 0
    for target in [
        "scenes",
        "random_points",
        "time_vs_tree",
        "time_vs_cpu",
        "additional_noise",
        "robustness",
        "opening",
    ]:
        assert re.search(rf"^{target} ", done.stdout, flags=re.MULTILINE)
