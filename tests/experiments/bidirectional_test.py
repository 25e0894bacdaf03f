"""The target of bidirectional on made-up outcomes: tables and verdicts are correct. Nothing is rendered."""

from bidirectional import every_scene
from lab.catalogue import EXPERIMENTS, Catalogue
from lab.equal_time import Case
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
