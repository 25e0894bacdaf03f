"""`lampyris render` with counts=auto: what it says about the choice."""

from support.render_program import run, stats_of


def test_the_choice_is_told(program, scene, tmp_path):
    stats = tmp_path / "stats.json"
    done = run(program, scene, "-o", tmp_path / "a.pfm", "--integrator", "vcm:counts=auto", "--stats", stats)
    assert done.returncode == 0, done.stderr
    told = [line for line in done.stderr.splitlines() if line.startswith("note: counts=auto: ")]
    assert len(told) == 1
    found = stats_of(stats)
    chosen = found["chosen"]
    assert chosen.keys() == {"strategies", "light_paths", "connections", "merging"}
    assert chosen["strategies"] in told[0]
    assert (chosen["light_paths"] == 0) == (chosen["strategies"] == "no light paths")
    assert isinstance(chosen["merging"], bool)
    assert 0 < found["phases"]["pilot"] < found["wall_s"]
    assert found["counts"]["pilot_rays"] > 0


def test_nothing_is_told_where_nothing_is_chosen(program, scene, tmp_path):
    stats = tmp_path / "stats.json"
    done = run(program, scene, "-o", tmp_path / "a.pfm", "--integrator", "bdpt", "--stats", stats)
    assert "counts=auto" not in done.stderr
    assert stats_of(stats)["chosen"] is None
    done = run(program, scene, "-o", tmp_path / "a.pfm", "--integrator", "bdpt:counts=auto", "--quiet")
    assert done.returncode == 0
    assert done.stderr == ""


def test_counts_that_leave_no_choice_are_an_error(program, scene, tmp_path):
    settings = "bdpt:counts=auto,lightpaths=9,connections=2"
    done = run(program, scene, "-o", tmp_path / "a.pfm", "--integrator", settings)
    assert done.returncode == 1
    assert "lightpaths=9 and connections=2" in done.stderr
    assert "leave one of them at -1" in done.stderr


def test_given_light_paths_do_not_make_the_pilot_long(program, scene, tmp_path):
    stats = tmp_path / "stats.json"
    settings = "bdpt:counts=auto,lightpaths=1000000"
    done = run(program, scene, "-o", tmp_path / "a.pfm", "--integrator", settings, "--passes", "1", "--stats", stats)
    assert done.returncode == 0, done.stderr
    found = stats_of(stats)
    assert 0 < found["counts"]["pilot_rays"] < found["rays"]
