"""Keys depend on all inputs, results are complete or absent, and a damaged one is detected."""

import json
import shutil
from pathlib import Path

import pytest
from lab.runs import ROOT, Machine, Run, file_hash, from_plain, key_of, scene_hash, to_plain
from lab.store import RunFailedError, Store

SCENE = "scenes/reference/diffuse.pbrt"


@pytest.fixture(scope="module")
def machine(program):
    return Machine.ask(program)


def a_run(**changes):
    return Run(**{"scene": SCENE, "resolution": "16x16", "integrator": "path", "spp": 2, **changes})


@pytest.mark.parametrize(
    "changes",
    [
        {"scene": "scenes/reference/textures.pbrt"},
        {"integrator": "path:maxdepth=3"},
        {"seed": 2},
        {"resolution": "16x17"},
        {"spp": 3},
        {"backend": "vulkan"},
        {"settings": ("integrator.maxdepth=3",)},
        {"reference": "scenes/reference/diffuse.exr"},
        {"reference": a_run(seed=3)},
        {"measures_time": True},
        {"repeat": 1},
    ],
)
def test_whatever_a_result_depends_on_is_in_its_key(machine, changes):
    assert key_of(a_run(), machine) == key_of(a_run(), machine)
    assert key_of(a_run(**changes), machine) != key_of(a_run(), machine)


def test_the_device_is_in_the_key_of_what_ran_on_it(machine):
    other = Machine.from_plain({**machine.plain(), "vulkan": "another GPU", "processor": "another processor"})
    assert key_of(a_run(), machine) == key_of(a_run(), other)  # the CPU's image is the same everywhere
    for run in [a_run(backend="vulkan"), a_run(measures_time=True)]:
        assert key_of(run, machine) != key_of(run, other)


def test_the_reference_of_a_reference_is_in_the_key(machine):
    deep = a_run(reference=a_run(seed=3, reference=a_run(seed=4)))
    deeper = a_run(reference=a_run(seed=3, reference=a_run(seed=5)))
    assert key_of(deep, machine) != key_of(deeper, machine)


def test_a_file_that_a_scene_names_is_part_of_the_scene(tmp_path):
    folder = tmp_path / "scene"
    shutil.copytree(ROOT / "scenes/box", folder)
    before = scene_hash(folder / "scene.pbrt")
    scene_hash.cache_clear()
    (folder / "README.md").write_text("not named by the scene")
    assert scene_hash(folder / "scene.pbrt") == before
    for forget in (scene_hash, file_hash):
        forget.cache_clear()
    with (folder / "ball.ply.gz").open("ab") as mesh:
        mesh.write(b"\n")
    assert scene_hash(folder / "scene.pbrt") != before


def test_a_run_survives_being_written():
    run = a_run(settings=("integrator.maxdepth=3",), reference=a_run(seed=7), plugins=("a.so",))
    assert from_plain(json.loads(json.dumps(to_plain(run)))) == run


@pytest.fixture(scope="module")
def made(machine, tmp_path_factory):
    """A store with one result, its run and key."""
    store = Store(tmp_path_factory.mktemp("store"), machine)
    run = a_run(reference="scenes/reference/diffuse.exr", resolution="128x128")
    store.make(run)
    return store, run, store.key(run)


def test_a_result_has_all_that_made_it(made):
    store, run, key = made
    record = store.record(run)
    assert record["schema"] == "lampyris.run/1"
    assert record["statistics"]["samples_per_pixel"] == 2
    assert record["compare"]["relmse"] > 0.0
    assert record["command"][1:3] == ["render", SCENE]
    assert store.image(run).exists()
    assert store.damage(key) == ""
    assert not list((store.folder / "unfinished").iterdir())


def spoil_image(place):
    data = bytearray((place / "image.exr").read_bytes())
    data[len(data) // 2] ^= 1
    (place / "image.exr").write_bytes(data)


def spoil_number(place):
    text = (place / "run.json").read_text()
    (place / "run.json").write_text(text.replace('"seed": 1', '"seed": 2'))


@pytest.mark.parametrize(
    "spoil",
    [
        spoil_image,
        spoil_number,
        lambda place: (place / "image.exr").unlink(),
        lambda place: (place / "run.json").write_text(""),
        lambda place: (place / "run.json").write_text("[]"),
        lambda place: (place / "run.json").unlink(),
    ],
)
def test_a_damaged_result_is_found_and_removed(made, tmp_path, spoil):
    store, _, key = made
    copy = Store(tmp_path, store.machine)
    shutil.copytree(store.place(key), copy.place(key))
    assert copy.remove_damaged([key, "0123456789"]) == []
    spoil(copy.place(key))
    told = copy.remove_damaged([key])
    assert len(told) == 1
    assert "made again" in told[0]
    assert not copy.place(key).exists()


def test_a_wrong_run_says_what_the_program_said(machine, tmp_path):
    store = Store(tmp_path, machine)
    with pytest.raises(RunFailedError, match="no integrator|unknown integrator"):
        store.make(a_run(integrator="frobnicate"))
    assert not (tmp_path / "runs").exists()


def test_what_the_machine_cannot_do_is_a_result(machine, tmp_path):
    store = Store(tmp_path, machine)
    run = a_run(resolution="32768x32768")
    record = store.make(run)
    assert "needs" in record["failed"]
    assert "memory" in record["failed"]
    assert store.damage(store.key(run)) == ""
    assert Path(store.place(store.key(run)) / "run.json").exists()
