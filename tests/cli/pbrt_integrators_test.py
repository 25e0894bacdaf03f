"""Scenes that name pbrt-v4's integrators render without --skip-unsupported, and a note explains differences."""

import json
import subprocess

import pytest

from support.render_program import SCENE, run, stats_of

# Every parameter of pbrt-v4 with a value that is not its default, and the integrator that renders.
INTEGRATORS = {
    "volpath": ("path", '"integer maxdepth" 2 "string lightsampler" "power" "bool regularize" false'),
    "simplepath": ("path", '"integer maxdepth" 2 "bool samplelights" false "bool samplebsdf" false'),
    "simplevolpath": ("path", '"integer maxdepth" 2'),
    "randomwalk": ("path", '"integer maxdepth" 2'),
    "lightpath": ("light", '"integer maxdepth" 2'),
    "function": (
        "path",
        '"string function" "disk" "string filename" "a" "string imagefilename" "b" "bool skipbad" false',
    ),
    "ambientocclusion": ("ao", '"bool cossample" false "float maxdistance" 0.5'),
    "bdpt": ("bdpt", '"integer maxdepth" 2 "bool visualizestrategies" true "bool visualizeweights" true'),
    "mlt": (
        "mlt",
        '"integer maxdepth" 2 "integer bootstrapsamples" 7 "integer chains" 7 "integer mutationsperpixel" 7'
        ' "float sigma" 0.5 "float largestepprobability" 0.5',
    ),
    "sppm": ("sppm", '"integer maxdepth" 2 "integer photonsperiteration" 1000 "float radius" 0.1 "integer seed" 7'),
}


def with_integrator(line):
    return SCENE.replace('Integrator "path" "integer maxdepth" 3', line)


@pytest.mark.parametrize("name", INTEGRATORS)
def test_pbrts_names_and_parameters_render(program, scene, tmp_path, name):
    ours, parameters = INTEGRATORS[name]
    scene.write_text(with_integrator(f'Integrator "{name}" {parameters}'))
    statistics = tmp_path / "s.json"
    done = run(program, scene, "-o", tmp_path / "o.pfm", "--stats", statistics, "--spp", 1)
    assert done.returncode == 0, done.stderr
    assert "warning" not in done.stderr
    result = stats_of(statistics)
    assert result["integrator"]["name"] == ours
    assert result["integrator"]["asked"] == name
    if "maxdepth" in parameters:
        assert result["integrator"]["parameters"]["maxdepth"] == 2
    if name == "ambientocclusion":
        assert result["integrator"]["parameters"]["distance"] == 0.5
    replaced = [note for note in result["notes"] if "renders instead of" in note]
    assert bool(replaced) == (name != ours)
    for note in replaced:
        assert note.startswith(f"{scene}:6:12: ") and f'"{ours}"' in note and f'"{name}"' in note
        assert f"note: {note}" in done.stderr
    # Parameters that are not at their default but have no effect are reported, each with its location.
    silent = {
        "maxdepth",
        "maxdistance",
        "photonsperiteration",
        "radius",
        "regularize",
        "bootstrapsamples",
        "chains",
        "mutationsperpixel",
        "sigma",
        "largestepprobability",
    }
    given = {word.split()[1] for word in parameters.split('"') if " " in word.strip() and word.strip().count(" ") == 1}
    told = {note.split('"')[1] for note in result["notes"] if "has no effect: " in note}
    assert told == given - silent


def test_defaults_are_not_told(program, scene, tmp_path):
    scene.write_text(
        with_integrator(
            'Integrator "mlt" "integer chains" 1000 "float sigma" 0.01 "float largestepprobability" 0.3'
            ' "bool regularize" false'
        )
    )
    done = run(program, scene, "-o", tmp_path / "o.pfm", "--spp", 1)
    assert done.returncode == 0, done.stderr
    assert "has no effect" not in done.stderr


@pytest.mark.parametrize(
    ("line", "parts"),
    [
        ('Integrator "volpath" "integer maxdeth" 3', ["6:22: error:", '"maxdeth" is unknown', "maxdepth"]),
        ('Integrator "volpath" "float maxdepth" 3', ["6:22: error:", "maxdepth", "integer"]),
        ('Integrator "mlt" "float chains" 3', ["6:18: error:", "chains", "integer"]),
        ('Integrator "volpath" "bool regularize" true', ["6:22: error:", "path regularization", "--skip-unsupported"]),
        ('Integrator "volpth"', ["6:12: error:", "unknown integrator"]),
        ('Integrator "path" "string media" "maybe"', ["6:34: error:", "on, off"]),
    ],
)
def test_what_is_wrong_is_still_told(program, scene, tmp_path, line, parts):
    scene.write_text(with_integrator(line))
    done = run(program, scene, "-o", tmp_path / "o.pfm")
    assert done.returncode == 1
    for part in parts:
        assert part in done.stderr


def test_skipping_keeps_the_depth(program, scene, tmp_path):
    scene.write_text(with_integrator('Integrator "volpath" "integer maxdepth" 50 "bool regularize" true'))
    statistics = tmp_path / "s.json"
    done = run(program, scene, "-o", tmp_path / "o.pfm", "--stats", statistics, "--skip-unsupported", "--spp", 1)
    assert done.returncode == 0, done.stderr
    assert stats_of(statistics)["integrator"]["parameters"]["maxdepth"] == 50


def test_a_scene_without_an_integrator_asks_for_none(program, scene, tmp_path):
    scene.write_text(with_integrator(""))
    statistics = tmp_path / "s.json"
    assert run(program, scene, "-o", tmp_path / "o.pfm", "--stats", statistics, "--spp", 1).returncode == 0
    integrator = stats_of(statistics)["integrator"]
    assert (integrator["name"], integrator["asked"]) == ("path", None)


def test_the_command_line_takes_our_names(program, scene, tmp_path):
    done = run(program, scene, "-o", tmp_path / "o.pfm", "--integrator", "volpath")
    assert done.returncode == 1
    assert '"volpath"' in done.stderr and 'rendered with "path"' in done.stderr


def test_path_says_that_it_absorbs_and_how_to_choose(program, scene, tmp_path):
    tea = (
        'MakeNamedMedium "tea" "string type" "homogeneous" "rgb sigma_s" [ 0 0 0 ] "rgb sigma_a" [ 1 1 1 ]\n'
        'MediumInterface "" "tea"\n'
    )
    scene.write_text(tea + SCENE)
    image, statistics = tmp_path / "o.pfm", tmp_path / "s.json"

    def notes(*arguments):
        done = run(program, scene, "-o", image, "--stats", statistics, "--spp", 1, *arguments)
        assert done.returncode == 0, done.stderr
        return [note for note in stats_of(statistics)["notes"] if "pbrt-v4" in note], image.read_bytes()

    told, absorbed = notes()
    assert len(told) == 1
    assert told[0].startswith(f"{scene}:8:12: ") and "integrator.media=off" in told[0]
    told, clear = notes("--set", "integrator.media=off")
    assert told == [] and clear != absorbed
    assert stats_of(statistics)["integrator"]["parameters"]["media"] == "off"
    scene.write_text(tea + SCENE.replace('"path"', '"path" "string media" "off"'))
    assert notes() == ([], clear)
    assert notes("--integrator", "path:media=on")[1] == absorbed
    # volpath simulates absorption, so there is no note about media.
    scene.write_text(tea + SCENE.replace('"path"', '"volpath"'))
    told, image_of_volpath = notes()
    assert len(told) == 1 and "renders instead of" in told[0] and image_of_volpath == absorbed
    done = run(program, scene, "-o", image, "--set", "integrator.media=some")
    assert done.returncode == 1 and "on or off" in done.stderr


def test_describe_says_what_renders(program, scene):
    scene.write_text(with_integrator('Integrator "ambientocclusion"'))
    done = subprocess.run(
        [program, "describe", scene, "--json"], capture_output=True, text=True, timeout=60, check=True
    )
    result = json.loads(done.stdout)
    assert (result["integrator"], result["rendered_by"]) == ("ambientocclusion", "ao")
    assert any("renders instead of" in note for note in result["notes"])
