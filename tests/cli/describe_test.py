"""`lampyris describe` and `lampyris plugins`: their output, their errors, and their exit codes."""

import json
import subprocess

import pytest

SCENE = """Camera "perspective" "float lensradius" 0.1
Film "rgb" "integer xresolution" 20 "integer yresolution" 10
Sampler "halton" "integer pixelsamples" 7
WorldBegin
LightSource "point"
Material "dielectric"
Shape "sphere"
"""


def run(program, *arguments):
    return subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, timeout=60, check=False)


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "scene.pbrt"
    path.write_text(SCENE)
    return path


def test_describe_names_who_asks(program, scene):
    done = run(program, "describe", scene, "--json")
    assert done.returncode == 0, done.stderr
    result = json.loads(done.stdout)
    assert result["schema"] == "lampyris.describe/1"
    assert result["resolution"] == [20, 10]
    assert result["samples_per_pixel"] == 7
    assert result["sampler"] == "sobol"
    assert result["quadrics"] == 1
    assert result["lights"] == 1
    asked = {effect["name"]: effect["asked_by"] for effect in result["effects"] if effect["simulated"]}
    assert asked == {
        "quadrics": f'{scene}:7:1 (Shape "sphere")',
        "dielectric": f'{scene}:6:1 (Material "dielectric")',
        "point-and-spot-lights": f'{scene}:5:1 (LightSource "point")',
        "depth-of-field": f'{scene}:1:1 (Camera "perspective")',
    }
    assert any("halton" in note for note in result["notes"])


def test_describe_names_the_medium_that_absorbs(program, scene):
    tea = (
        'MakeNamedMedium "tea" "string type" "homogeneous" "rgb sigma_s" [ 0 0 0 ] "rgb sigma_a" [ 0 1 2 ]\n'
        'MediumInterface "tea" ""\n'
    )
    scene.write_text(SCENE.replace('Shape "sphere"', tea + 'Shape "sphere"'))
    done = run(program, "describe", scene, "--json")
    assert done.returncode == 0, done.stderr
    effects = {effect["name"]: effect for effect in json.loads(done.stdout)["effects"]}
    assert effects["medium-absorption"]["asked_by"] == f'{scene}:7:1 (MakeNamedMedium "homogeneous")'
    assert effects["medium-absorption"]["simulated"]
    assert not effects["interface"]["simulated"]


def test_describe_prints_a_table(program, scene):
    done = run(program, "describe", scene)
    assert done.returncode == 0, done.stderr
    row = next(line for line in done.stdout.splitlines() if line.startswith("dielectric"))
    assert "yes" in row
    assert "scene.pbrt:6:1" in row
    assert "not needed by this scene: smooth-normals" in done.stdout


def test_describe_reports_all_errors_with_their_places(program, scene):
    scene.write_text(SCENE.replace('"sphere"', '"spher"').replace('"point"', '"pont"'))
    done = run(program, "describe", scene)
    assert done.returncode == 1
    assert f'{scene}:7:7: error: unknown shape "spher" (did you mean "sphere"?)' in done.stderr
    assert f'{scene}:5:13: error: unknown light "pont"' in done.stderr
    assert done.stdout == ""


def test_skip_unsupported_lists_what_is_left_out(program, scene):
    scene.write_text(SCENE.replace('"dielectric"', '"dielectric" "spectrum eta" "glass-BK7"'))
    done = run(program, "describe", scene)
    assert done.returncode == 1
    assert ":6:38: error: dispersion" in done.stderr
    done = run(program, "describe", scene, "--json", "--skip-unsupported")
    assert done.returncode == 0, done.stderr
    (left_out,) = json.loads(done.stdout)["unsupported"]
    assert "dispersion" in left_out
    assert "scene.pbrt:6" in left_out


def test_plugins_come_from_registrations(program):
    done = run(program, "plugins", "--json")
    assert done.returncode == 0, done.stderr
    result = json.loads(done.stdout)
    assert result["schema"] == "lampyris.plugins/1"
    kinds = {kind["kind"]: {plugin["name"] for plugin in kind["plugins"]} for kind in result["kinds"]}
    assert {
        "shape",
        "material",
        "texture",
        "light",
        "area light",
        "camera",
        "film",
        "filter",
        "sampler",
    } <= kinds.keys()
    assert {"path", "ao"} <= kinds["integrator"]
    assert {"trianglemesh", "plymesh", "loopsubdiv", "bilinearmesh", "sphere", "disk", "cylinder"} <= kinds["shape"]
    # Every parameter is documented.
    for kind in result["kinds"]:
        for plugin in kind["plugins"]:
            assert plugin["summary"]
            assert all(parameter["doc"] for parameter in plugin["parameters"]), plugin["name"]


def test_plugins_tells_one(program):
    done = run(program, "plugins", "shape", "sphere")
    assert done.returncode == 0, done.stderr
    assert "phimax" in done.stdout
    assert "degrees" in done.stdout
    done = run(program, "plugins", "shape", "sphre")
    assert done.returncode == 1
    assert 'did you mean "sphere"?' in done.stderr
