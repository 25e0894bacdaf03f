"""The targets of parallel_ppm_2010 on made-up records: tables and verdicts are correct. Nothing is rendered."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from lab import noise
from lab.catalogue import EXPERIMENTS, Catalogue
from lab.figures import tikz_grid
from lab.reports import judge, what_failed
from lab.runs import Machine
from lab.store import Store
from lab.target import all_targets
from parallel_ppm_2010 import additional_noise, kernel_lines, opening, random_points, scenes, time_vs_cpu, time_vs_tree
from parallel_ppm_2010.common import is_software, timing_of, with_parameters
from parallel_ppm_2010.robustness import better_verdict, list_verdict

GPU, SOFTWARE = "GeForce GTX 480", "llvmpipe (LLVM 19.1.7, 256 bits)"


def plan_of(name: str, declared: Path = EXPERIMENTS / "methods.toml", full: bool = False, **changes):
    """The plan of a target as it is declared, with changes."""
    target = next(one for one in all_targets() if one.id == f"parallel_ppm_2010/{name}")
    catalogue = Catalogue.read(declared, EXPERIMENTS / "scenes.toml", full)
    return target.plan(catalogue, ["cpu", "vulkan"], "", full, changes)


@pytest.fixture
def store(tmp_path):
    """A store without a program: every record that is read must have been added before."""
    return Store(tmp_path, Machine(Path("lampyris"), "", "0", "hash", "a processor", SOFTWARE))


def put(store: Store, run, **content) -> str:
    """Make up the record of a run; returns its key."""
    key = store.key(run)
    store.place(key).mkdir(parents=True, exist_ok=True)
    record = {"key": key, "command": ["lampyris"], **content}
    (store.place(key) / "run.json").write_text(json.dumps(record))
    return key


def statistics(step_seconds: dict[str, float], passes: int = 2, device: str = "a processor") -> dict:
    """Statistics of a render whose phases took this long."""
    return {"phases": step_seconds, "passes": passes, "wall_s": sum(step_seconds.values()), "device": device}


def phases(tracing: float, construction: float, gathering: float, rest: float = 0.2) -> dict[str, float]:
    return {
        "photon_tracing": tracing,
        "construction": construction,
        "gathering": gathering,
        "eye_pass": rest / 2,
        "resolve": rest / 2,
    }


def test_every_target_plans_runs_and_full_ones_are_larger():
    for target in all_targets():
        if target.experiment == "parallel_ppm_2010":
            small, full = (target.module().runs(plan_of(target.name, full=one)) for one in (False, True))
            assert len(small) == len(set(small)) > 0
            assert full and set(full) != set(small)


def test_targets_ask_for_no_backend_that_was_not_asked_for():
    catalogue = Catalogue.read(EXPERIMENTS / "methods.toml", EXPERIMENTS / "scenes.toml", False)
    for target in all_targets():
        if target.experiment == "parallel_ppm_2010":
            found = target.module().runs(target.plan(catalogue, ["vulkan"], "1", False, {}))
            assert {(run.backend, run.device) for run in found} <= {("vulkan", "1")}


@pytest.mark.parametrize(("passed", "holds"), [([], "not tested"), ([1, 1], "yes"), ([1, 0], "partly"), ([0, 0], "no")])
def test_verdicts_follow_their_criteria(passed, holds):
    assert judge(map(bool, passed)) == holds


def test_parameters_are_added_whether_or_not_there_are_some():
    assert with_parameters("sppm", alpha=0.7) == "sppm:alpha=0.7"
    assert (
        with_parameters("sppm:radius=1", alpha=0.7, schedule="memoryless")
        == "sppm:radius=1,alpha=0.7,schedule=memoryless"
    )


def test_software_devices_are_known_by_their_names():
    assert is_software(SOFTWARE) and not is_software(GPU) and not is_software("")


def test_timing_is_the_median_of_repeats_and_tolerates_what_is_missing(store):
    plan = plan_of("time_vs_tree")
    run = time_vs_tree.cases(plan)[0].runs(plan)[0]
    repeats = [run.but(repeat=i) for i in range(4)]
    for one, construction in zip(repeats, [0.2, 0.6, 0.4], strict=False):
        put(store, one, statistics=statistics(phases(2.0, construction, 1.0)))
    put(store, repeats[3], failed="what it said\nout of memory")
    timing = timing_of(store, repeats)
    assert timing.steps["construction"] == pytest.approx((0.2, 0.1, 0.3))
    assert timing.median("total") == pytest.approx((2.0 + 0.4 + 1.0 + 0.2) / 2)
    assert timing.failed == "out of memory" and len(timing.runs) == 4
    put(store, repeats[0], statistics={"phases": None, "passes": 2, "wall_s": 1.0, "device": "x"})
    assert timing_of(store, repeats[:1]).steps == {} and timing_of(store, repeats[:1]).median("total") == 0.5
    assert what_failed({"failed": ""}) == ""


def fill_tree(store, plan, construction: dict[str, float]) -> list:
    """Records of all cases of time_vs_tree; construction takes as long as its structure says."""
    for case in time_vs_tree.cases(plan):
        seconds = construction.get(case.method.name.partition("+")[2], 1.0)
        for run in case.runs(plan):
            put(store, run, statistics=statistics(phases(5.0, seconds, seconds)))
    return [(case, timing_of(store, case.runs(plan))) for case in time_vs_tree.cases(plan)]


@pytest.mark.parametrize(
    ("stochastic", "kd_tree", "bvh", "holds"),
    [(1.0, 2.0, 3.0, "yes"), (2.0, 1.0, 3.0, "partly"), (4.0, 2.0, 3.0, "no")],
)
def test_trees_are_compared_in_every_scene(store, stochastic, kd_tree, bvh, holds):
    plan = plan_of("time_vs_tree")
    measured = fill_tree(store, plan, {"stochastic_hash": stochastic, "kd_tree": kd_tree, "bvh": bvh})
    verdicts = time_vs_tree.verdicts_of(measured, plan["shown"], plan["trees"])
    assert len(verdicts) == 4
    assert {one.holds for one in verdicts} == {holds}
    assert f"kd_tree, construction: {kd_tree / stochastic:.3g} times" in verdicts[0].measured
    assert verdicts[0].runs


def test_a_new_structure_is_timed_and_drawn_with_the_others(store, tmp_path):
    methods = tmp_path / "methods.toml"
    declared = (EXPERIMENTS / "methods.toml").read_text()
    methods.write_text(declared + 'mine = { use = "mine:size=2", plugin = "pyproject.toml", kernels = "nowhere" }\n')
    plan = plan_of("time_vs_tree", methods)
    measured = fill_tree(store, plan, {})
    assert "mine" in {row["structure"] for row in time_vs_tree.rows_of(measured)}
    assert "mine" in time_vs_tree.plots_of(plan, measured)[0].series[0].x
    found = [run for run in random_points.runs(plan_of("random_points", methods)) if "mine:size=2" in run.arguments]
    assert len(found) == 2 and all("--plugin" in run.arguments for run in found)
    lines = {row["structure"]: row["lines"] for row in kernel_lines.kernel_rows(plan.catalogue.structures)}
    assert lines["mine"] is None and lines["stochastic_hash"] > 0


def cpu_rows(slow: float, fast: float) -> list[dict]:
    """Ratios of a serial build in `slow` seconds and a Vulkan build in `fast` ones; passes take ten times as long."""
    step = {"construction": (slow, fast), "total": (10 * slow, 10 * fast)}
    sides = [("sppm+hash_list", time_vs_cpu.SERIAL), ("sppm+stochastic_hash", time_vs_cpu.VULKAN)]
    measured = {}
    for i, side in enumerate(sides):
        seconds = {name: (pair[i],) * 3 for name, pair in step.items()}
        timing = time_vs_cpu.Timing(
            [f"run{i}"], total=seconds["total"], steps={"construction": seconds["construction"]}
        )
        measured["box", *side] = timing
    return time_vs_cpu.ratio_rows(measured, {"box": "Box"}, "sppm+hash_list", "sppm+stochastic_hash")


def test_ratios_against_the_cpu_are_judged_on_a_gpu_alone():
    paper = {"construction": 30, "total": 5}
    rows = cpu_rows(slow=6.0, fast=1.0)
    assert [row["comparison"] for row in rows] == ["the paper's"]
    assert rows[0]["construction"] == pytest.approx(6.0) and rows[0]["photon tracing"] is None
    on_gpu = time_vs_cpu.verdicts_of(rows, GPU, paper)
    assert [one.holds for one in on_gpu] == ["partly", "yes"] and on_gpu[0].runs == ["run0", "run1"]
    on_processor = time_vs_cpu.verdicts_of(rows, SOFTWARE, paper)
    assert [one.holds for one in on_processor] == ["not tested", "not tested"]
    assert "6 times" in on_processor[0].measured and "processor itself" in on_processor[0].why
    assert [one.holds for one in time_vs_cpu.verdicts_of(cpu_rows(1.0, 2.0), GPU, paper)] == ["no", "no"]
    assert [one.holds for one in time_vs_cpu.verdicts_of([], "", paper)] == ["not tested", "not tested"]


def bench_rows(ns_of: dict[str, list[float]]) -> list[dict]:
    """Rows of random_points: ns a point of each structure at 10^3, 10^4, ... points."""
    rows = []
    for name, values in ns_of.items():
        for i, ns in enumerate(values):
            row = {"structure": name, "backend": "cpu", "points": 10 ** (3 + i), "total_s": 10 ** (3 + i) * ns * 1e-9}
            row |= {"construction_ns_per_point": ns, "floor_ns_per_point": ns / 2, "query_ns": 50.0}
            rows.append({**row, "told": "", "runs": [f"{name}-cpu"]})
    return rows


@pytest.mark.parametrize(
    ("mine", "holds"),
    [([90, 5, 5, 5], "yes"), ([90, 5, 10, 20], "no"), ([90, 8, 8, 8], "partly"), ([90, 1, 2, 4], "partly")],
)
def test_construction_is_fastest_and_linear(mine, holds):
    rows = bench_rows({"stochastic_hash": mine, "kd_tree": [90, 7, 7, 7], "splat": [1, 1, 1, 1]})
    rows.append({"structure": "kd_tree", "backend": "cpu", "points": None, "told": "out of memory", "runs": ["k"]})
    summary = random_points.summary_of(rows)
    tree = next(row for row in summary if row["structure"] == "kd_tree")
    assert tree["points"] == 10**6 and tree["over_floor"] == 2.0 and tree["told"] == "out of memory"
    (verdict,) = random_points.verdicts_of(summary, "stochastic_hash", ["splat"])
    assert verdict.holds == holds
    assert verdict.runs == ["stochastic_hash-cpu", "kd_tree-cpu"]


def test_growth_is_the_exponent_of_the_time():
    points = [1e3, 1e4, 1e5, 1e6]
    slope, error = random_points.growth(points, [7.0, *(n**1.25 for n in points[1:])])
    assert slope == pytest.approx(1.25) and error == pytest.approx(0.0, abs=1e-9)
    assert random_points.growth(points[:2], [1.0, 2.0]) is None


def test_bench_records_become_rows_and_failures_are_told(store):
    plan = plan_of("random_points", backends=["cpu"], methods=["sppm+kd_tree", "sppm+bvh"])
    measured = {"construction_ns_per_point": 8.0, "floor_ns_per_point": 4.0, "query_ns": 9.0, "bytes_per_point": 1.0}
    measured |= {"photons_found_mean": 10.0, "points": 1000}
    tree, bvh = random_points.runs(plan)
    put(store, tree, bench={"rows": [measured], "failed": [{"structure": "kd_tree", "error": "too many"}]})
    put(store, bvh, failed="no memory")
    rows = random_points.rows_of(plan, store)
    assert [row["points"] for row in rows] == [1000, None, None]
    assert rows[0]["total_s"] == pytest.approx(8e-6)
    assert "too many" in rows[1]["told"] and rows[2]["told"] == "no memory"
    assert [plot.id for plot in random_points.plots_of(rows)] == [
        "construction_ns_per_point"[:12] + "-cpu",
        "query-cpu",
    ]


def test_triangles_hold_within_a_twentieth():
    rows = [{"scene": "Box", "triangles": 4164, "paper": 4000, "runs": ["a"]}]
    assert scenes.verdict_of(rows).holds == "yes"
    rows.append({"scene": "Pool", "triangles": 61_000, "paper": 122_000, "runs": ["b"]})
    verdict = scenes.verdict_of(rows)
    assert verdict.holds == "partly" and verdict.runs == ["a", "b"] and "61,000" in verdict.measured
    assert scenes.verdict_of(rows[1:]).holds == "no" and scenes.verdict_of([]).holds == "not tested"


@pytest.mark.parametrize(("cells", "known"), [(4, 4.36), (3, 2.21), (2, 0.770), (1.5, 0.340), (1, 0.104), (0.5, 0.013)])
def test_kappa_is_what_was_found_by_simulation(cells, known):
    assert noise.kappa(cells) == pytest.approx(known, abs=0.006)


def test_memoryless_passes_share_one_formula():
    squared = noise.memoryless_shrinking(3, 0.5)
    assert squared == pytest.approx([1.0, 1.5 / 2.0, 1.5 / 2.0 * 2.5 / 3.0])
    assert noise.harmonic_share(3, 0.5) == pytest.approx(3.0 / np.sum(1.0 / squared))
    assert noise.noise_of_passes(3, 0.5) == pytest.approx(np.mean(1.0 / squared) / 3.0)
    assert noise.harmonic_share(5, 1.0) == pytest.approx(1.0)


def stochastic_images(chance, seeds: int, in_disc: float, passes: int, slots_of: float | None) -> np.ndarray:
    """Means of Poisson counts; with `slots_of`, one photon a bucket survives, for itself and that many on average."""
    counts = chance.poisson(in_disc, (seeds, passes, 12, 12))
    if slots_of is not None:
        # A photon shares its bucket with others, Poisson in number: the survivor stands for all of them.
        found = np.zeros(counts.shape)
        for i in range(counts.max()):
            others = 1 + chance.poisson(slots_of, counts.shape)
            found += np.where(i < counts, others * (chance.random(counts.shape) * others < 1.0), 0.0)
        counts = found
    return counts.mean(axis=1)


def found_like(images: np.ndarray, name: str, table_size: float | None, passes: int) -> additional_noise.Found:
    kind = additional_noise.Kind(name, name, name, table_size)
    parameters = {"statistics": {"photon_map": {"parameters": {"cell_size": 0.01}}}}
    return additional_noise.Found(kind, passes, [name], "", [parameters] * len(images), images)


def test_noise_of_a_simulated_table_is_what_the_model_predicts():
    chance = np.random.default_rng(4)
    full = found_like(stochastic_images(chance, 40, 5.0, 4, None), "full list", None, 4)
    table = found_like(stochastic_images(chance, 40, 5.0, 4, 8.0), "table 1:8", 1 / 8, 4)
    listed, row = additional_noise.noise_rows([full, table], [0, 0, 12, 12], alpha=1.0)
    assert listed["in_disc"] == pytest.approx(5.0, rel=0.05)
    assert listed["variance"] == pytest.approx(listed["predicted_variance"])
    assert row["collisions"] == 8.0 and row["cells"] < 0.001
    assert row["measured"] == pytest.approx(9.0, rel=0.1) and row["low"] < row["measured"] < row["high"]
    more, model, _ = additional_noise.verdicts_of([listed, row], [])
    assert more.holds == "yes" and model.holds == "yes" and model.runs == ["full list", "table 1:8"]


def test_noise_that_is_not_the_models_is_said():
    chance = np.random.default_rng(5)
    full = found_like(stochastic_images(chance, 40, 5.0, 4, None), "full list", None, 4)
    wrong = found_like(stochastic_images(chance, 40, 5.0, 4, 8.0), "table 1:64", 1 / 64, 4)
    alike = found_like(stochastic_images(chance, 40, 5.0, 4, None), "table 1:1", 1.0, 4)
    more, model, easy = additional_noise.verdicts_of(
        additional_noise.noise_rows([full, alike, wrong], [0, 0, 12, 12], alpha=1.0), []
    )
    assert model.holds == "no" and more.holds == "partly" and easy.holds == "not tested"


def test_curves_keep_the_passes_that_every_seed_noted():
    def record(errors: dict[int, float]) -> dict:
        points = [{"passes": n, "relmse_trimmed": error, "wall_s": 0.5 * n} for n, error in errors.items()]
        return {"statistics": {"convergence": points}}

    found = found_like(np.zeros((3, 2, 2)), "full list", None, 4)
    found.records = [record({1: 0.3, 4: 0.1}), record({1: 0.1, 3: 9.0, 4: 0.2}), record({1: 0.2, 4: 0.3})]
    rows = additional_noise.curves([found])
    assert [(row["passes"], row["seconds"]) for row in rows] == [(1, 0.5), (4, 2.0)]
    assert [row["error"] for row in rows] == pytest.approx([0.2, 0.2])


def test_lines_of_code_leave_out_comments_and_blanks():
    text = "// a\nint a;  // b\n\n/* c\n d */ int b;\n/* e */\nint c; /* f\n*/\n"
    assert kernel_lines.code_lines(text) == 3


def test_lines_of_kernels_follow_includes_of_other_structures():
    rows = {row["structure"]: row for row in kernel_lines.kernel_rows({"hash_list": {"use": "hash_list"}})}
    names = {file.name for file in kernel_lines.kernel_files(EXPERIMENTS.parent / "src/accel/photons/hash_list")}
    assert any(name.startswith("linked_list") for name in names)
    assert rows["hash_list"]["files"] == len(names)
    assert rows["hash_list"]["lines"] == sum(rows["hash_list"][one] for one in ("construction", "gathering", "shared"))


@pytest.mark.parametrize(("counts", "holds"), [((50, 60, 70), "yes"), ((65, 60, 70), "partly"), ((90, 60, 70), "no")])
def test_the_shortest_structure_is_the_easiest(counts, holds):
    lines = [{"structure": name, "lines": n} for name, n in zip(["stochastic_hash", "a", "b"], counts, strict=True)]
    lines += [{"structure": "stochastic_hash_4", "lines": 1}, {"structure": "unknown", "lines": None}]
    assert additional_noise.easy(lines).holds == holds


class Outcome:
    """The values of an outcome that verdicts on equal time use."""

    def __init__(self, scene: str, method: str, **errors) -> None:
        plan = plan_of("robustness")
        case = opening.equal_time.Case(plan.catalogue.scene(scene), plan.catalogue.method(method), "cpu")
        self.case, self.key, self.errors = case, f"{scene} {method}", errors

    def error(self, word: str):
        return self.errors.get(word)


def test_progressive_methods_are_compared_with_path_tracing_by_both_measures():
    found = [
        Outcome("sds-lamp", "path", relmse_trimmed=2.0, flip=0.5),
        Outcome("sds-lamp", "sppm", relmse_trimmed=0.5, flip=0.1),
        Outcome("pool", "path", relmse_trimmed=1.0, flip=0.2),
        Outcome("pool", "sppm", relmse_trimmed=0.5, flip=0.1),
        Outcome("pool", "ppm"),  # could not be made
    ]
    verdict = better_verdict(found, ["sppm", "ppm", "nobody"], ["path"], "it does")
    assert verdict.holds == "yes" and verdict.why == ""
    assert "a lamp inside a bulb of glass, trimmed relMSE: 0.25 of path's" in verdict.measured
    found[3].errors["flip"] = 0.4
    verdict = better_verdict(found, ["sppm"], ["path"], "it does")
    assert verdict.holds == "partly" and "Pool" in verdict.why
    found.append(Outcome("pool", "mlt", relmse_trimmed=0.4, flip=0.9))
    verdict = better_verdict(found, ["sppm"], ["path", "mlt"], "it does")
    assert "Pool, trimmed relMSE: 0.5 of path's, 1.2 of mlt's" in verdict.measured
    assert "SPPM has more relmse_trimmed on Pool than mlt" in verdict.why
    assert better_verdict([], ["sppm"], ["path"], "it does").holds == "not tested"


def test_one_photon_a_bucket_is_compared_with_all():
    found = [
        Outcome("sds-lamp", "sppm", relmse_trimmed=0.1),
        Outcome("sds-lamp", "sppm+stochastic_hash", relmse_trimmed=0.15),
        Outcome("pool", "sppm", relmse_trimmed=0.1),
        Outcome("pool", "sppm+stochastic_hash", relmse_trimmed=0.35),
    ]
    assert list_verdict(found[:2], "sppm", "sppm+stochastic_hash").holds == "yes"
    verdict = list_verdict(found, "sppm", "sppm+stochastic_hash")
    assert verdict.holds == "partly" and "Pool: 3.5" in verdict.measured and "Pool" in verdict.why


def test_crops_are_shares_of_the_picture():
    assert opening.crop_pixels([0.25, 0.5, 0.5, 1.0], 120, 160) == (40, 60, 80, 120)


def test_a_grid_for_latex_lies_beside_its_pictures(tmp_path):
    picture = np.linspace(0.0, 1.0, 4 * 6 * 3).reshape(4, 6, 3)
    told = tikz_grid(tmp_path, "grid", ["one", "two"], [[picture, picture]], 8.0)
    text = (tmp_path / told.file).read_text()
    included = re.findall(r"\\detokenize\{([^}]+\.png)\}", text)
    assert len(included) == 2
    assert all((tmp_path / "grid-tikz" / name).is_file() for name in included)
    assert "one" in text
