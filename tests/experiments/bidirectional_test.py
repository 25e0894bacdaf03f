"""The targets of bidirectional on made-up outcomes: tables and verdicts are correct. Nothing is rendered."""

import numpy as np
import OpenEXR
from bidirectional import every_scene, references, strategies
from lab.catalogue import EXPERIMENTS, Catalogue
from lab.equal_time import Case
from lab.statistics import Interval
from lab.target import all_targets

CATALOGUE = Catalogue.read(EXPERIMENTS / "methods.toml", EXPERIMENTS / "scenes.toml", full=False)


class Outcome:
    """The values of an outcome that tables and verdicts use."""

    def __init__(self, scene: str, method: str, error: float | None) -> None:
        self.case = Case(CATALOGUE.scene(scene), CATALOGUE.method(method), "cpu")
        self.key, self.value = f"{scene} {method}", error

    def error(self, _: str) -> float | None:
        return self.value


def outcomes(**errors: dict[str, float | None]) -> list[Outcome]:
    return [Outcome(scene, method, error) for scene, of in errors.items() for method, error in of.items()]


def plan():
    target = next(one for one in all_targets() if one.name == "every_scene")
    return target.plan(CATALOGUE, ["cpu"], "", False, {})


def test_methods_stand_beside_each_other():
    found = outcomes(slit={"path": 2.0, "bdpt": 0.5, "sppm": None}, coffee={"path": 0.1, "bdpt": 0.3})
    table = every_scene.table_of(plan(), found, "relmse")
    assert [one.key for one in table.columns] == ["scene", *CATALOGUE.integrators, "least"]
    slit, coffee = table.rows
    assert (slit["path"], slit["bdpt"], slit["sppm"], slit["least"]) == (2.0, 0.5, None, "bidirectional path tracing")
    assert coffee["least"] == "path tracing" and coffee["runs"] == ["coffee path", "coffee bdpt"]


def test_bidirectional_path_tracing_is_judged_where_lamps_are_hidden():
    found = outcomes(slit={"path": 2.0, "bdpt": 0.5}, coffee={"path": 0.1, "bdpt": 0.3})
    verdict = every_scene.hidden_verdict(found, ["slit"])
    assert verdict.holds == "yes" and "a lamp behind a slit: 0.25" in verdict.measured
    assert verdict.runs == ["slit bdpt", "slit path"]
    verdict = every_scene.hidden_verdict(found, ["slit", "coffee"])
    assert verdict.holds == "partly" and "Coffee maker" in verdict.why
    assert every_scene.hidden_verdict([], ["slit"]).holds == "not tested"


def test_vcm_is_measured_by_the_better_of_its_halves():
    found = outcomes(
        slit={"bdpt": 0.1, "sppm": 9.0, "vcm": 0.15},
        coffee={"bdpt": 9.0, "sppm": 0.1, "vcm": 0.3},
        cognac={"bdpt": 9.0, "sppm": 0.1, "vcm": None},
    )
    verdict = every_scene.robust_verdict(found)
    assert verdict.holds == "partly" and "a lamp behind a slit: 1.5; Coffee maker: 3" in verdict.measured
    assert verdict.why.endswith("it is more on Coffee maker")
    assert every_scene.robust_verdict(found[:3]).holds == "yes"
    assert every_scene.robust_verdict([]).holds == "not tested"


# ---- The strategies --------------------------------------------------------------------------------------------------


def made_up(s: int, t: int, weighted: float, alone: float) -> strategies.Strategy:
    return strategies.Strategy(s, t, *(np.full((2, 3, 3), value, np.float32) for value in (weighted, alone)))


def layered(path, maxdepth: int) -> dict[str, float]:
    """An EXR with the layers of the program: each is a constant of its own."""
    values = {}
    for k in range(maxdepth + 1):
        for s in range(k + 2 if k else 1):
            for layer, factor in (("strategy", 1.0), ("alone", 100.0)):
                values[f"{layer}.s{s}t{k + 2 - s}"] = factor * (1 + 10 * k + s)
    planes = {
        f"{name}.{channel}": np.full((2, 3), value, np.float32) for name, value in values.items() for channel in "RGB"
    }
    with OpenEXR.File({"type": OpenEXR.scanlineimage}, planes) as file:
        file.write(str(path))
    return values


def test_layers_are_read_by_strategy(tmp_path):
    values = layered(tmp_path / "layers.exr", 2)
    found = strategies.read_strategies(tmp_path / "layers.exr", 2)
    assert [(one.s, one.t) for one in found] == [(0, 2), (0, 3), (1, 2), (2, 1), (0, 4), (1, 3), (2, 2), (3, 1)]
    for one in found:
        assert (one.weighted == values[f"strategy.s{one.s}t{one.t}"]).all()
        assert (one.alone == values[f"alone.s{one.s}t{one.t}"]).all() and one.alone.shape == (2, 3, 3)
    assert found[-1].scattering == 2


def test_weighted_strategies_must_add_up():
    found = [made_up(0, 2, 1.0, 5.0), made_up(1, 2, 0.5, 0.7)]
    picture = np.full((2, 3, 3), 1.5, np.float32)
    assert strategies.sum_difference(picture, found) == 0.0
    assert abs(strategies.sum_difference(2 * picture, found) - 0.5) < 1e-6
    assert strategies.sum_verdict({"a": (0.0005, "1"), "b": (0.5, "2")}).holds == "partly"
    assert strategies.sum_verdict({}).holds == "not tested"
    rows = strategies.rows_of(CATALOGUE.scene("slit"), "key", picture, found)
    assert abs(rows[0]["weighted"] - 1 / 1.5) < 1e-6 and abs(rows[1]["alone"] - 0.7 / 1.5) < 1e-6
    assert (rows[1]["scattering"], rows[1]["s"], rows[1]["t"]) == (1, 1, 2)


def test_strategies_are_kept_for_short_paths():
    target = next(one for one in all_targets() if one.name == "strategies")
    plan = target.plan(CATALOGUE, ["cpu"], "", False, {})
    made = strategies.runs(plan)
    assert [run.scene for run in made] == [scene.file for scene in plan.scenes]
    for run in made:
        assert "integrator.strategies=on" in run.settings and f"integrator.maxdepth={plan['maxdepth']}" in run.settings
        assert not any("maxdepth=24" in setting for setting in run.settings)


# ---- References ------------------------------------------------------------------------------------------------------


def agreement(value: float, low: float, high: float) -> references.Agreement:
    return references.Agreement(CATALOGUE.scene("box"), "path", "path tracing", Interval(value, low, high), ["key"])


def test_references_are_judged_by_intervals_of_means():
    right, close, wrong = agreement(1.02, 0.99, 1.05), agreement(0.985, 0.98, 0.995), agreement(1.1, 1.05, 1.15)
    assert right.agrees and close.agrees and not wrong.agrees
    assert references.verdict_of([right, close]).holds == "yes"
    verdict = references.verdict_of([right, wrong])
    assert verdict.holds == "partly" and "path tracing on Box" in verdict.why and verdict.runs == ["key"]
    assert references.verdict_of([]).holds == "not tested"
    assert references.rows_of([right])[0]["low"] == 0.99


def test_references_are_compared_over_seeds():
    target = next(one for one in all_targets() if one.name == "references")
    plan = target.plan(CATALOGUE, ["cpu"], "", False, {})
    made = references.runs(plan)
    of_box = [run for run in made if run.scene == CATALOGUE.scene("box").file]
    assert len(of_box) == 1 + len(plan.methods) * plan["seeds"] and of_box[0].seed == 9001
    assert len({(run.integrator, run.seed) for run in of_box}) == len(of_box)
