"""The cost of each effect: every effect has a scene, and ratios, verdicts and tables follow from the runs' records."""

import csv
import json
import re
from pathlib import Path

import pytest
from effects import costs
from lab.catalogue import EXPERIMENTS, Catalogue
from lab.runs import ROOT, Machine
from lab.store import Store
from lab.target import all_targets


def plan_with(backends, **changes):
    target = next(one for one in all_targets() if one.id == "effects/costs")
    catalogue = Catalogue.read(EXPERIMENTS / "methods.toml", EXPERIMENTS / "scenes.toml", full=False)
    return target.plan(catalogue, backends, "", full=False, changes=changes)


VARIANTS = [
    {"name": "textures", "without": "base", "what": "a chequered floor"},
    {"name": "dielectric", "without": "base", "what": "a ball of glass"},
    {"name": "image-textures", "without": "textures", "what": "an image"},
]
EFFECTS = {
    "base": ["area-lights"],
    "textures": ["area-lights", "textures"],
    "dielectric": ["area-lights", "dielectric"],
    "image-textures": ["area-lights", "textures", "image-textures"],
}


@pytest.fixture
def plan():
    return plan_with(["cpu", "vulkan"], variants=VARIANTS, on_vulkan=["*"], repeats=3)


@pytest.fixture
def store(tmp_path):
    return Store(tmp_path, Machine(Path("lampyris"), "", "0", "hash", "a processor", "a device"))


def keep(store, run, ns, rays, spirv, failed=""):
    """A record as a run leaves it: 1000 samples of `ns` nanoseconds and `rays` rays each, repeats 1 % slower each."""
    name = Path(run.scene).stem
    record = {"command": ["lampyris"], "failed": failed}
    if not failed:
        record = {
            "command": ["lampyris"],
            "statistics": {
                "wall_s": 1000 * ns * 1e-9 * (1 + 0.01 * run.repeat),
                "samples": 1000,
                "rays": 1000 * rays,
                "spirv_bytes": {"path": spirv} if run.backend == "vulkan" else {},
                "setup_s": {"compile": 0.5},
                "effects": [{"name": one} for one in EFFECTS[name]],
                "resolution": [96, 96],
                "samples_per_pixel": 8,
                "device": "a device",
                "passes": 8,
                "photons_emitted": 0,
            },
        }
    place = store.place(store.key(run))
    place.mkdir(parents=True, exist_ok=True)
    (place / "run.json").write_text(json.dumps(record))


def keep_all(plan, store, **changes):
    """Glass: twice the rays at the same time each; textures: 20 % more time a ray; shaders grow."""
    values = {
        "base": (100, 4, 1000),
        "textures": (120, 4, 1100),
        "dielectric": (200, 8, 1500),
        "image-textures": (126, 4, 1200),
        **changes,
    }
    for run in costs.runs(plan):
        keep(store, run, *values[Path(run.scene).stem])


def test_every_effect_has_a_scene_and_all_files_are_there():
    known = re.findall(r'E\(EFFECT_\w+, \d+, "([\w-]+)"', (ROOT / "src/core/kernel/effects.h").read_text())
    assert len(known) > 20
    plan = plan_with(["cpu", "vulkan"])
    names = [one["name"] for one in plan["variants"]]
    assert set(known) - set(names) == {"area-lights"}  # which all of them have
    assert set(plan["on_vulkan"]) <= set(names)
    for one in [*names, *(one["without"] for one in plan["variants"])]:
        assert (ROOT / costs.SCENES / f"{one}.pbrt").is_file()


def test_runs_are_timed_repeated_and_made_once_each():
    plan = plan_with(["cpu", "vulkan"])
    runs = costs.runs(plan)
    assert len(set(runs)) == len(runs)
    assert all(run.measures_time for run in runs)
    on_cpu = [run for run in runs if run.backend == "cpu"]
    assert len(on_cpu) == plan["repeats"] * (len(plan["variants"]) + 1)
    # A variant is compared with a base measured on the same backend.
    pairs = {one["name"]: one["without"] for one in plan["variants"]}
    on_vulkan = {Path(run.scene).stem for run in runs if run.backend == "vulkan"}
    assert {pairs[name] for name in plan["on_vulkan"]} <= on_vulkan
    assert len(on_vulkan) < len(pairs)


def test_more_rays_and_dearer_rays_are_told_apart(plan, store, tmp_path):
    keep_all(plan, store)
    section = costs.report(plan, store, tmp_path)
    rows = {row["effect"]: row for row in section.tables[0].rows}
    assert rows["dielectric"]["sample_ratio"] == pytest.approx(2.0)
    assert rows["dielectric"]["rays_ratio"] == pytest.approx(2.0)
    assert rows["dielectric"]["ray_ratio"] == pytest.approx(1.0)
    assert rows["textures"]["ray_ratio"] == pytest.approx(1.2)
    assert rows["image-textures"]["sample_ratio"] == pytest.approx(1.05)
    assert rows["textures"]["sample_ns"] == pytest.approx(121.2)  # the median of 120, 121.2 and 122.4
    assert rows["textures"]["sample_spread"] == "1.18 to 1.22"
    assert len(rows["textures"]["runs"]) == 2 * plan["repeats"]
    vulkan = {row["effect"]: row for row in section.tables[1].rows}
    assert vulkan["dielectric"]["spirv_more_kb"] == pytest.approx(0.5)
    assert [verdict.holds for verdict in section.verdicts] == ["yes", "yes", "yes"]
    assert {plot.id for plot in section.plots} == {"ratios-cpu", "ratios-vulkan"}
    assert section.plots[0].series[0].x[0] == "dielectric"  # the costliest first
    for download in section.downloads:
        assert (tmp_path / download.file).stat().st_size > 0
    lines = list(csv.DictReader((tmp_path / "costs.csv").open()))
    assert len(lines) == 6
    assert float(lines[1]["rays_ratio"]) == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("changes", "holds"),
    [
        ({"textures": (120, 4, 1000)}, "partly"),  # one effect adds no code
        ({"base": (100, 4, 1450)}, "partly"),  # the base's is not the smallest
        ({"textures": (120, 4, 900), "dielectric": (200, 8, 900), "image-textures": (126, 4, 800)}, "no"),
    ],
)
def test_shaders_that_do_not_grow_are_told(plan, store, tmp_path, changes, holds):
    keep_all(plan, store, **changes)
    verdict = costs.report(plan, store, tmp_path).verdicts[0]
    assert verdict.holds == holds
    assert verdict.why


def test_an_effect_that_makes_rays_faster_is_told(plan, store, tmp_path):
    keep_all(plan, store, dielectric=(100, 8, 1500))
    verdict = costs.report(plan, store, tmp_path).verdicts[1]
    assert verdict.holds == "no"  # one of three is more than a fifth
    assert "dielectric (x 0.50)" in verdict.why


def test_what_could_not_be_measured_is_told(plan, store, tmp_path):
    keep_all(plan, store, dielectric=(0, 0, 0, "error: the device has too little memory"))
    section = costs.report(plan, store, tmp_path)
    row = next(row for row in section.tables[1].rows if row["effect"] == "dielectric")
    assert row["besides"] == "not measured: error: the device has too little memory"
    assert "sample_ns" not in row
    assert [len(series.x) for series in section.plots[0].series] == [2, 2, 2]


def test_without_vulkan_there_is_no_shader_to_judge(store, tmp_path):
    plan = plan_with(["cpu"], variants=VARIANTS)
    keep_all(plan, store)
    section = costs.report(plan, store, tmp_path)
    assert [verdict.holds for verdict in section.verdicts] == ["not tested", "yes"]
    assert len(section.tables) == len(section.plots) == 1


def test_one_repeat_does_not_judge_times(store, tmp_path):
    plan = plan_with(["cpu"], variants=VARIANTS, repeats=1)
    keep_all(plan, store)
    verdict = costs.report(plan, store, tmp_path).verdicts[1]
    assert (verdict.holds, verdict.measured) == ("not tested", "one repeat has no spread")
