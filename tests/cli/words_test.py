"""Terms that newcomers know from other renderers, help, limits and plurals."""

import re
import subprocess

import pytest

from support.render_program import run


def say(program, *words):
    return subprocess.run([program, *words], capture_output=True, text=True, timeout=60, check=False)


@pytest.mark.parametrize(
    ("words", "ours"),
    [
        (["--outfile", "a.exr"], "-o IMAGE"),
        (["--outfile=a.exr"], "-o IMAGE"),
        (["--nthreads", "2"], "--threads N"),
        (["--gpu"], "--backend vulkan"),
        (["--mse-reference-image", "r.exr"], "--reference REF.exr"),
        (["--pixel", "1,2"], "--crop x,y,x+1,y+1"),
        (["--pixelbounds", "0,1,0,1"], "--crop x0,y0,x1,y1"),
        (["-m", "scalar_rgb"], "--backend NAME; there are no variants"),
        (["-D", "spp=3"], "--set SECTION.KEY=VALUE"),
    ],
)
def test_options_of_other_renderers_lead_to_ours(program, scene, words, ours):
    done = say(program, "render", scene, *words)
    assert done.returncode == 1
    assert re.search(r"what \w+ calls .* is here: " + re.escape(ours), done.stderr), done.stderr


def test_what_is_named_as_ours_exists(program, source_dir):
    """Every option that the table of words recommends is one of `render`."""
    table = (source_dir / "src/commands/foreign_words.cpp").read_text()
    known = set(re.findall(r"--[a-z-]+", say(program, "render", "--help").stdout))
    rows = re.findall(r'Option\{"[^"]+", "[^"]+", "([^"]+)"\}', table)
    assert len(rows) > 20
    assert set(re.findall(r"--[a-z-]+", " ".join(rows))) <= known


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["light", "area"], 'what Mitsuba calls so is listed by: lampyris plugins "area light"'),
        (["light", "diffuse"], 'what pbrt calls so is listed by: lampyris plugins "area light"'),
        (["bsdf"], "what Mitsuba calls so is listed by: lampyris plugins material"),
        (["integrator", "sphere"], '"sphere" is a plugin of: shape'),
        (["sphere"], '"sphere" is a plugin of: shape'),
    ],
)
def test_plugins_of_other_renderers_lead_to_ours(program, words, said):
    done = say(program, "plugins", *words)
    assert done.returncode == 1
    assert said in done.stderr
    for listed in re.findall(r'lampyris plugins ("area light"|\w+)$', done.stderr.strip()):
        assert say(program, "plugins", listed.strip('"')).returncode == 0


def test_help_is_a_command(program):
    assert say(program, "help").stdout == say(program, "--help").stdout
    for words in (["render"], ["bench"], ["bench", "photon-maps"]):
        done = say(program, "help", *words)
        assert done.returncode == 0
        assert done.stdout == say(program, *words, "--help").stdout
    done = say(program, "help", "rendre")
    assert done.returncode == 1
    assert 'did you mean "render"?' in done.stderr or "render" in done.stderr


def test_commands_are_described_in_one_mood(program):
    commands = re.findall(r"^  ([a-z]+) +([A-Z]\w+)", say(program, "--help").stdout, re.MULTILINE)
    assert len(commands) >= 6
    verbs = {"Render", "Show", "Compare", "List", "Measure"}
    assert {verb for _, verb in commands} <= verbs, commands


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--resolution", "32769x10"], "--resolution 32769x10: sides are 1 to 32768 pixels"),
        (["--resolution", "10x0"], "--resolution 10x0: sides are 1 to 32768 pixels"),
        (["--spp", "1073741825"], "--spp 1073741825: expected 1 to 1073741824"),
        (["--passes", "0"], "--passes 0: expected 1 to 1073741824"),
    ],
)
def test_options_have_the_limits_of_scenes(program, scene, tmp_path, words, said):
    done = run(program, scene, "-o", tmp_path / "o.exr", *words)
    assert done.returncode == 1
    assert said in done.stderr


def test_scenes_tell_the_same_limits_in_digits(program, scene, tmp_path):
    text = scene.read_text()
    for old, new, said in [
        ('"integer xresolution" 24', '"integer xresolution" 32769', "1 to 32768"),
        ('"integer pixelsamples" 4', '"integer pixelsamples" 1073741825', "1 to 1073741824"),
    ]:
        scene.write_text(text.replace(old, new))
        done = run(program, scene, "-o", tmp_path / "o.exr")
        assert done.returncode == 1
        assert said in done.stderr
        assert "e+0" not in done.stderr


def test_one_is_singular(program, scene, tmp_path):
    done = run(program, scene, "-o", tmp_path / "o.exr", "--spp", "1")
    assert ": path, 1 pass, " in done.stdout
    assert " 1 pass  " in done.stderr
    done = run(program, scene, "-o", tmp_path / "o.exr", "--spp", "2")
    assert ": path, 2 passes, " in done.stdout


@pytest.mark.parametrize("backend", ["cpu", "cpu-bvh2", "vulkan"])
def test_a_device_that_is_not_there_lists_those_that_are(program, scene, tmp_path, backend):
    done = run(program, scene, "-o", tmp_path / "o.exr", "--backend", backend, "--device", "77")
    assert done.returncode == 2
    assert re.search(r"--device 77: (Vulkan|the backend \S+) has no such device; it has 0 \S", done.stderr)
