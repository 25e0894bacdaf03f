"""`lampyris render --replay`: what it prints of a pixel's paths."""

import json

import pytest

from support.render_program import run

ROOM = """LookAt 0 1 4  0 0.8 0  0 1 0
Camera "perspective" "float fov" 45
Film "rgb" "integer xresolution" 24 "integer yresolution" 16
PixelFilter "box" "float xradius" 0.5 "float yradius" 0.5
WorldBegin
LightSource "infinite" "rgb L" [ 0.2 0.3 0.4 ]
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 9 8 7 ]
Shape "trianglemesh" "point3 P" [ -0.5 2 -0.5 0.5 2 -0.5 0.5 2 0.5 -0.5 2 0.5 ] "integer indices" [ 0 1 2 0 2 3 ]
AttributeEnd
Material "diffuse" "rgb reflectance" [ 0.7 0.6 0.5 ]
Shape "trianglemesh" "point3 P" [ -3 0 -3 -3 0 3 3 0 3 3 0 -3 ] "integer indices" [ 0 1 2 0 2 3 ]
"""
INTEGRATORS = [
    "path",
    "light:lightpaths=40000",
    "bdpt",
    "vcm:radius=0.2,lightpaths=4000",
    "bpm:radius=0.2,lightpaths=4000",
    "sppm:radius=0.2,photonsperiteration=4000",
    "ppm:radius=0.2,photonsperiteration=4000",
    "mlt:mutationsperpixel=2",
]


@pytest.fixture
def room(tmp_path):
    path = tmp_path / "room.pbrt"
    path.write_text(ROOM)
    return path


def replay_of(program, scene, *arguments):
    done = run(program, scene, "--replay", "12,11,0", "--seed", "3", *arguments)
    assert done.returncode == 0, done.stderr
    return done.stdout


def added(replay):
    return [event for path in replay["paths"] for event in path["events"] if "added" in event]


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_contributions_are_weighed_and_add_up_to_the_pixel(program, room, integrator):
    replay = json.loads(replay_of(program, room, "--integrator", integrator))
    assert replay["schema"] == "lampyris.replay/1"
    events = added(replay)
    assert events
    for event in events:
        assert 0 <= event["weight"] <= 1
        assert event["added"] == pytest.approx([event["weight"] * x for x in event["unweighted"]], rel=1e-6)
    sums = [sum(event["added"][c] for event in events) for c in range(3)]
    assert sums == pytest.approx(replay["radiance"], rel=1e-4, abs=1e-6)
    assert replay["sum_of_events"] == pytest.approx(sums, rel=1e-5, abs=1e-7)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_threads_do_not_show(program, room, integrator):
    one, two = (replay_of(program, room, "--integrator", integrator, "--threads", n) for n in ["1", "2"])
    assert one == two


def test_a_path_tells_its_vertices(program, room):
    text = replay_of(program, room, "--integrator", "path")
    replay = json.loads(text)
    (path,) = replay["paths"]
    assert (path["path"], path["number"]) == ("camera", 0)
    events = path["events"]
    assert [event["event"] for event in events[:2]] == ["start", "vertex"]
    assert events[0]["position"] == pytest.approx([0, 1, 4])
    vertex = events[1]
    assert vertex["material"] == "diffuse"
    assert vertex["position"][1] == pytest.approx(0, abs=1e-5)
    assert vertex["normal"] == pytest.approx([0, 1, 0])
    assert vertex["distance"] == pytest.approx(replay["depth"])
    light = next(event for event in events if event["event"] == "light")
    assert (light["vertex"], light["s"], light["t"]) == (1, 1, 2)
    assert light["seen"] in ("clearly", "occluded", "not scattered")
    for line in text.splitlines():  # an event a line
        assert line.count('"event":') <= 1


def test_strategies_have_the_sums_of_their_events(program, room):
    arguments = ["--integrator", "bdpt:maxdepth=3", "--set", "integrator.strategies=on"]
    replay = json.loads(replay_of(program, room, *arguments))
    sums = {}
    for event in added(replay):
        name = f"s{event['s']}t{event['t']}"
        sums[name] = sums.get(name, 0) + event["added"][0]
    strategies = {entry["strategy"]: entry["radiance"][0] for entry in replay["strategies"]}
    for name, radiance in strategies.items():
        assert sums.pop(name, 0) == pytest.approx(radiance, rel=1e-4, abs=1e-6), name
    assert not any(sums.values())


def test_a_sum_is_null_if_only_vertices_are_logged(program, room):
    replay = json.loads(replay_of(program, room, "--integrator", "ao"))
    assert any(replay["radiance"])
    assert replay["sum_of_events"] is None


def test_a_sum_is_null_if_events_are_missing(program, tmp_path):
    """A path in a closed white sphere has more events than the log."""
    scene = tmp_path / "white.pbrt"
    white = 'Material "diffuse" "rgb reflectance" [ 1 1 1 ]\nReverseOrientation\nShape "sphere" "float radius" 9\n'
    scene.write_text(ROOM.replace("0.7 0.6 0.5", "1 1 1") + white)
    replay = json.loads(replay_of(program, scene, "--integrator", "path:maxdepth=60000,rrdepth=100000"))
    assert replay["events_missing"] > 0
    assert replay["sum_of_events"] is None
    # The record that closes the path has a place of its own, so that the events that are there have values.
    assert replay["paths"][0]["events"][-1]["event"] == "sample"
    assert len(added(replay)) > 1000 and any(event["added"][0] > 0 for event in added(replay))


def test_options_without_effect_are_told(program, room, tmp_path):
    out, stats = tmp_path / "a.pfm", tmp_path / "a.json"
    arguments = ["-o", out, "--stats", stats, "--crop", "0,0,2,2", "--passes", "3", "--time", "1s"]
    done = run(program, room, "--replay", "5,9,0", *arguments, "--target-error", "0.1")
    assert done.returncode == 0
    for option in ("--output", "--stats", "--crop", "--passes", "--time", "--target-error"):
        assert f"note: {option} has no effect" in done.stderr
    assert not out.exists() and not stats.exists()


@pytest.mark.parametrize("text", ["", "1,2", "1,2,4294967296", "-1,0,0", "a,b,c"])
def test_pixels_that_are_none_are_errors(program, room, text):
    done = run(program, room, "--replay", text)
    assert done.returncode == 1
    assert "--replay" in done.stderr
