"""The accuracy experiment on made-up records, whose curves, forecasts and theory are known."""

import json
import math

import numpy as np
import pytest
from accuracy import curves, forecast, knobs, measured, slopes, summary, theory
from lab.catalogue import EXPERIMENTS, Catalogue, read_toml
from lab.images import ROOT
from lab.runs import Machine
from lab.target import Target

METHODS = """
[integrators]
path = {{ use = "path", bias = "none", label = "path tracing" }}
sppm = {{ use = "sppm:photonsperiteration={{photons}}", bias = "vanishes", structures = true, label = "SPPM" }}
{more}
[structures]
kd_tree = {{ use = "kd_tree" }}
stochastic_hash = {{ use = "stochastic_hash" }}
sorted_grid = {{ use = "sorted_grid" }}
"""
FORECAST = ("halving_s", "halving_low_s", "halving_high_s")


class Records:
    """A store whose records are computed from the run: `error_of` is the relMSE after a number of passes of 0.01 s."""

    def __init__(self, error_of):
        self.error_of = error_of
        self.keys = {}
        self.machine = Machine(ROOT, "", "0", "", "", "")

    def key(self, run):
        return self.keys.setdefault(run, f"{len(self.keys):020d}")

    def record(self, run):
        record = {"key": self.key(run), "command": ["lampyris"]}
        told = self.error_of(run)
        if isinstance(told, str):
            return record | {"failed": told}
        last = round(run.time_s / 0.01)
        passes = sorted({2**k for k in range(20) if 2**k < last} | {last})
        name, _, words = run.integrator.partition(":")
        photons = name != "path"
        entries = [{"wall_s": 0.01 * n, "passes": n, "relmse": told(n), "estimated_error": told(n)} for n in passes]
        for entry, more in zip(entries, getattr(told, "more", [{}] * len(entries)), strict=True):
            entry.update(more)
        parameters = {"alpha": 2 / 3} if photons else {}
        parameters |= dict(word.split("=") for word in words.split(",") if word)
        record["statistics"] = {
            "integrator": {"name": name, "parameters": {k: float(v) for k, v in parameters.items()}},
            "photon_map": {"name": "sorted_grid", "parameters": {"slots": 1.0}} if photons else None,
            "passes": last,
            "convergence": [*entries, entries[-1]],  # the program reports the last point twice
        }
        record["compare"] = {"relmse": told(last), "flip": 0.1}
        return record


@pytest.fixture
def planned(tmp_path):
    """Makes the plan of a target, with keys of its table replaced."""

    def make(name, more_methods="", **changes):
        path = tmp_path / "methods.toml"
        path.write_text(METHODS.format(more=more_methods))
        catalogue = Catalogue.read(path, EXPERIMENTS / "scenes.toml", False)
        table = read_toml(EXPERIMENTS / "accuracy" / "experiment.toml")["targets"][name]
        return Target("accuracy", name, table).plan(catalogue, ["cpu", "vulkan"], "", False, changes)

    return make


@pytest.fixture
def same_curves(planned, monkeypatch):
    """Makes `summary` and `forecast` use the runs of a small `curves`."""

    def make(name, **changes):
        plan = planned("curves", **changes)
        monkeypatch.setattr(f"accuracy.{name}.plan_of_curves", lambda _: plan)
        monkeypatch.setattr("accuracy.measured._floor", lambda *_: None)
        return planned(name)

    return make


def power(scale, exponent):
    return lambda n: scale * n**exponent


def by_integrator(path, photons):
    """Errors of path tracing, and of photon mapping; each seed is off by some per cent."""

    def error_of(run):
        law = path if run.integrator == "path" else photons
        return law if isinstance(law, str) else lambda n: law(n) * (1 + 0.02 * run.seed)

    return error_of


@pytest.fixture
def no_images(monkeypatch):
    monkeypatch.setattr("accuracy.curves.parts_of", lambda *_: None)
    monkeypatch.setattr("accuracy.measured._floor", lambda *_: None)


SMALL = {"scenes": ["diffuse"], "methods": ["*"], "backends": ["cpu"], "more": [], "time_s": 2, "seeds": 3}


def test_all_targets_are_declared_and_ask_for_runs(planned):
    for name in read_toml(EXPERIMENTS / "accuracy" / "experiment.toml")["targets"]:
        target = Target("accuracy", name, {})
        assert target.module().runs(planned(name)), name


def test_summary_and_forecast_ask_for_the_runs_of_curves(planned):
    expected = set(curves.runs(planned("curves")))
    assert set(summary.runs(planned("summary"))) == expected
    assert set(forecast.runs(planned("forecast"))) == expected


def test_a_new_line_of_methods_joins(planned):
    before = curves.runs(planned("curves"))
    after = curves.runs(planned("curves", 'bdpt = { use = "bdpt", label = "BDPT" }'))
    new = [run for run in after if run.integrator == "bdpt"]
    assert set(before) | set(new) == set(after)
    assert {run.scene for run in new} == {run.scene for run in before}


def test_curves_find_the_slopes_that_records_have(planned, no_images, tmp_path):
    store = Records(by_integrator(power(1.0, -1.0), power(0.05, -0.6)))
    section = curves.report(planned("curves", **SMALL), store, tmp_path)
    assert [verdict.holds for verdict in section.verdicts] == ["yes", "yes"]
    rows = {row["method"]: row for row in section.tables[0].rows}
    assert rows["path tracing"]["by_passes"].startswith("-1.00 ")
    assert rows["SPPM"]["time"].startswith("-0.60 ")
    assert all(keys for plot in section.plots for one in plot.series if one.style == "line" for keys in one.runs)
    assert (tmp_path / "curves.pdf").exists()
    assert len((tmp_path / "curves.csv").read_text().splitlines()) == 1 + 2 * 3 * 9


@pytest.mark.parametrize(("path", "photons", "holds"), [(-0.5, -0.6, ["no", "yes"]), (-1.0, -0.05, ["yes", "no"])])
def test_slopes_that_contradict_theory_are_told(planned, no_images, tmp_path, path, photons, holds):
    store = Records(by_integrator(power(1.0, path), power(0.05, photons)))
    section = curves.report(planned("curves", **SMALL), store, tmp_path)
    assert [verdict.holds for verdict in section.verdicts] == holds


def test_levels_beyond_a_run_are_censored_and_failures_told(planned, no_images, tmp_path):
    store = Records(by_integrator(power(1.0, -1.0), "the device has 2 GB"))
    section = curves.report(planned("curves", **SMALL), store, tmp_path)
    tables = {table.id: {row["method"]: row for row in table.rows} for table in section.tables}
    assert tables["times"]["path tracing"]["level_0"].startswith("0.104 (")
    assert tables["times"]["path tracing"]["level_2"] == tables["times"]["path tracing"]["level_3"] == "> 2"
    assert "3 of 3 runs failed: the device has 2 GB" in tables["slopes"]["SPPM"]["note"]
    assert tables["times"]["SPPM"]["level_0"] == "no run"
    assert tables["prices"]["path tracing"]["ratio"] == pytest.approx(2.0)


def test_looks_near_the_references_own_error_are_no_slope(planned, monkeypatch):
    """1/n + 0.01: the reference's error flattens the curve, and the fit stays away from it."""
    plan = planned("curves", **SMALL)
    case = measured.cases(plan)[0]
    store = Records(lambda run: lambda n: 1 / n + 0.01)
    monkeypatch.setattr("accuracy.measured._floor", lambda *_: 0.01)
    with_floor = measured.curve_of(plan, store, case)
    monkeypatch.setattr("accuracy.measured._floor", lambda *_: None)
    without = measured.curve_of(plan, store, case)
    assert with_floor.near_reference() and not without.near_reference()
    assert with_floor.slope(100).value == pytest.approx(-1.0)
    assert without.slope(100).value > -0.8
    assert math.isnan(with_floor.slope(2).value)


def test_one_look_makes_no_curve(planned, no_images, tmp_path):
    section = curves.report(planned("curves", **SMALL | {"time_s": 0.01}), Records(lambda run: power(1, -1)), tmp_path)
    assert section.plots == []
    assert [verdict.holds for verdict in section.verdicts] == ["not tested", "not tested"]


def test_the_summary_picks_the_fastest_and_names_ties(same_curves, tmp_path):
    """Photon mapping is first to 0.01; path tracing catches up at 0.001, where the seeds' spreads meet."""
    plan = same_curves("summary", **SMALL | {"levels": [1e-1, 1e-2, 2e-3, 1e-4], "time_s": 20})
    store = Records(by_integrator(power(1.0, -1.0), power(0.08, -0.6)))
    section = summary.report(plan, store, tmp_path)
    rows = section.tables[0].rows
    assert [row["method"] for row in rows] == ["SPPM", "SPPM", "SPPM", "none"]
    assert rows[0]["time"] == "< 0.01"
    assert rows[1]["next"].startswith("path tracing 1.0")
    assert rows[2]["ties"] == "path tracing 5.2"
    assert rows[3] | {"time": "> 20", "left": "all"} == rows[3]


def test_spreads_that_overlap_are_ties(same_curves, tmp_path):
    plan = same_curves("summary", **SMALL)
    store = Records(by_integrator(power(1.0, -1.0), power(1.01, -1.0)))
    row = summary.report(plan, store, tmp_path).tables[0].rows[0]
    assert row["method"] == "path tracing"
    assert row["ties"].startswith("SPPM ")


def forecasting(factor, unstable=False):
    """Error 1/n and halvings that take as long again, forecast as `factor` times that, within a fifth."""

    def error_of(run):
        def law(n):
            return 1.0 / n

        last = round(run.time_s / 0.01)
        passes = sorted({2**k for k in range(20) if 2**k < last} | {last})
        walls = [0.01 * n * factor for n in passes]
        law.more = [
            dict(zip(FORECAST, (wall, 0.8 * wall, 1.2 * wall), strict=True)) | {"estimate_unstable": unstable}
            for wall in walls
        ]
        return law

    return error_of


@pytest.mark.parametrize(("factor", "holds"), [(1.0, "yes"), (4.0, "no"), (0.25, "no")])
def test_coverage_tells_good_forecasts_from_bad_ones(same_curves, tmp_path, factor, holds):
    section = forecast.report(same_curves("forecast", **SMALL), Records(forecasting(factor)), tmp_path)
    assert section.verdicts[0].holds == holds
    # After 1, 2, ..., 64 passes it halves before the end, at 200; after 128 it does not. 3 seeds, 2 methods.
    outcomes = [line.split(",")[-1] for line in (tmp_path / "forecast.csv").read_text().splitlines()[1:]]
    assert (outcomes.count("right"), len(outcomes)) == ({1.0: 48, 4.0: 6, 0.25: 0}[factor], 48)


def test_forecasts_called_unstable_do_not_count(same_curves, tmp_path):
    section = forecast.report(same_curves("forecast", **SMALL), Records(forecasting(4.0, unstable=True)), tmp_path)
    assert section.verdicts[0].holds == "not tested"


def test_a_program_without_forecasts_is_not_judged(same_curves, tmp_path):
    section = forecast.report(same_curves("forecast", **SMALL), Records(lambda run: power(1.0, -1.0)), tmp_path)
    assert [verdict.holds for verdict in section.verdicts] == ["not tested", "not tested"]
    halving = [row["actual"] for row in section.tables[1].rows]
    assert halving == pytest.approx([1.0, 1.0])


@pytest.mark.parametrize(("unstable", "holds"), [(True, "yes"), (False, "no")])
def test_estimates_that_are_far_off_should_be_called_unstable(same_curves, tmp_path, unstable, holds):
    def error_of(run):
        law = forecasting(1.0, unstable)(run)
        law.more = [one | {"estimated_error": 1e-4 / 2**i} for i, one in enumerate(law.more)]
        return law

    section = forecast.report(same_curves("forecast", **SMALL), Records(error_of), tmp_path)
    assert section.verdicts[1].holds == holds


def test_images_of_known_bias_and_variance_are_taken_apart(planned, monkeypatch, tmp_path):
    """Noise of exactly theory's variance, and theory's bias: verdicts agree. A bias that does not fall is reported."""
    count, shape = 12, (16, 16)
    plan = planned("slopes", seeds=count, alphas=[0.7])
    distance = slopes.distances(shape, plan["smooth"]["foot"]).ravel()
    bias, variance = theory.point_light_parts(distance, plan["passes"], 0.7, 0.4, 0.9, 5000)
    size_of = {n: [b, v] for n, b, v in zip(plan["passes"], bias, variance, strict=True)}
    noise_of = {n: _standard_noise(n, count, shape) for n in [*plan["passes"], *plan["whole"]["passes"]]}

    def image_of(run):
        if run.integrator.startswith("path"):
            return np.ones((*shape, 3))
        bias, variance = size_of.get(run.passes, (0.01, 1e-4))
        # The mean of the seeds is exact, so what is subtracted for its noise has to be there.
        offset = math.sqrt(bias + variance / count)
        image = 1 + offset + math.sqrt(variance) * noise_of[run.passes][(run.seed - 1) % count]
        return np.repeat(image[..., None], 3, axis=-1)

    class Images(Records):
        def image(self, run):
            return run

        def record(self, run):
            return {"statistics": {"estimated_error": 1e-6}}

    monkeypatch.setattr("accuracy.slopes.read_exr", image_of)
    section = slopes.report(plan, Images(None), tmp_path)
    assert [verdict.holds for verdict in section.verdicts[:2]] == ["yes", "yes"]
    told = json.loads((tmp_path / "slopes.json").read_text())[0]
    assert told["parts"]["bias_squared"] == pytest.approx(told["expected"]["bias_squared"], rel=1e-6)
    assert told["parts"]["variance"] == pytest.approx(told["expected"]["variance"], rel=1e-6)
    for sizes in size_of.values():
        sizes[0] = 0.01
    section = slopes.report(plan, Images(None), tmp_path)
    assert [verdict.holds for verdict in section.verdicts[:2]] == ["partly", "no"]
    assert "bias^2, SPPM" in section.verdicts[0].why


def _standard_noise(seed, count, shape):
    """Noise whose mean over seeds is 0 and whose variance is 1 at every pixel, exactly."""
    noise = np.random.default_rng(seed).normal(size=(count, *shape))
    noise -= noise.mean(axis=0)
    return noise / noise.std(axis=0, ddof=1)


def test_knobs_are_turned_one_at_a_time(planned):
    plan = planned("knobs", methods=["sppm+kd_tree"])
    found = knobs.runs(plan)
    default = found[0]
    assert default.integrator == "sppm:photonsperiteration=60000"
    assert knobs.runs(planned("knobs", methods=["sppm+kd_tree"])) == found
    assert any(run.integrator == "sppm:photonsperiteration=15000" for run in found)
    assert any(run.photon_map == "kd_tree:slots=4" and run.integrator == default.integrator for run in found)
    assert all(run.time_s == plan["time_s"] and run.measures_time for run in found)


def test_the_best_value_of_a_knob_is_told_beyond_the_spread(planned, monkeypatch, tmp_path):
    def error_of(run):
        scale = 0.5 if "alpha=0.8" in run.integrator else 1.0
        return lambda n: scale / n * (1 + 0.02 * run.seed)

    row = {"of": "integrator", "key": "alpha", "title": "alpha", "values": [0.5, 0.8]}
    plan = planned("knobs", methods=["sppm"], knobs=[row])
    section = knobs.report(plan, Records(error_of), tmp_path)
    told = section.tables[0].rows[0]
    assert told["default"] == pytest.approx(2 / 3)
    assert (told["best"], told["told"]) == (0.8, "better by a factor of 2")
    assert [point for point in section.plots[0].series[0].x] == pytest.approx([0.5, 2 / 3, 0.8])


@pytest.mark.parametrize(
    ("bias", "holds"),
    [
        ('bias = "stays", ', ["yes", "yes"]),
        ('bias = "vanishes", ', ["yes", "partly"]),  # according to its alpha, it should be faster
        ("", ["yes", "yes"]),
        ('bias = "none", ', ["partly", "yes"]),  # a claim that is checked
    ],
)
def test_a_biased_method_spoils_no_verdict(planned, no_images, tmp_path, bias, holds):
    laws = {"path": power(1.0, -1.0), "mine": power(0.3, -0.05)}

    def error_of(run):
        law = laws.get(run.integrator, power(0.05, -0.6))
        return lambda n: law(n) * (1 + 0.02 * run.seed)

    plan = planned("curves", f'mine = {{ use = "mine", {bias}label = "mine" }}', **SMALL)
    section = curves.report(plan, Records(error_of), tmp_path)
    assert [verdict.holds for verdict in section.verdicts] == holds
    told = {row["method"]: row["theory"] for row in section.tables[0].rows}
    assert told["path tracing"] == "-1.00"
    assert bias or "methods.toml does not tell its bias" in told["mine"]


def test_pairs_see_what_spreads_hide(same_curves, tmp_path):
    """Errors differ by 1.2 from seed to seed, and methods by 1.05 for each seed: only pairs can distinguish them."""
    plan = same_curves("summary", **SMALL | {"seeds": 6})
    scale = {1: 0.7, 2: 1.0, 3: 1.3, 4: 0.8, 5: 1.2, 6: 1.1}

    def error_of(run):
        own = (1.0 if run.integrator == "path" else 1.05) * scale[run.seed] * (1 + 0.001 * run.seed)
        return lambda n: own / n

    section = summary.report(plan, Records(error_of), tmp_path)
    (row,) = next(table for table in section.tables if table.id == "paired").rows
    assert (row["method"], row["best"], row["seeds"]) == ("SPPM", "path tracing", 6)
    assert row["difference"] == "0.05 [0.05, 0.05]"  # ln 1.05
    assert row["factor"] == "1.05 [1.05, 1.05]"
    assert row["told"] == "worse"
    noisy = {("path", 1): 1.1, ("path", 4): 0.9, ("path", 5): 1.2, ("path", 6): 0.8}
    section = summary.report(
        plan,
        Records(lambda run: lambda n: noisy.get((run.integrator.split(":")[0], run.seed), 1.0) / n),
        tmp_path,
    )
    (row,) = next(table for table in section.tables if table.id == "paired").rows
    assert row["told"] == "no difference shown"


def test_the_answer_names_the_pick_of_each_level(same_curves, tmp_path):
    plan = same_curves("summary", **SMALL | {"levels": [1e-1, 1e-2, 2e-3, 1e-4], "time_s": 20})
    store = Records(by_integrator(power(1.0, -1.0), power(0.08, -0.6)))
    answer = summary.report(plan, store, tmp_path).answer
    assert [column.title for column in answer.columns][2:] == [
        f"relMSE {level}" for level in ("0.1", "0.01", "0.002", "0.0001")
    ]
    (row,) = answer.rows
    assert row["level_0"] == "SPPM: < 0.01\N{NO-BREAK SPACE}s"
    assert row["level_2"].startswith("SPPM = path tracing: ")
    assert row["level_3"] == "none within 20\N{NO-BREAK SPACE}s"
