"""`lampyris render` says what the next halving of the error takes, and where the estimate cannot be trusted."""

import re

from support.render_program import run, stats_of

KEYS = ["halving_s", "halving_low_s", "halving_high_s", "estimate_unstable"]


def test_statistics_and_last_lines_have_the_forecast(program, scene, tmp_path):
    file = tmp_path / "stats.json"
    done = run(program, scene, "-o", tmp_path / "o.exr", "--stats", file, "--spp", "64")
    assert done.returncode == 0, done.stderr
    stats = stats_of(file)
    first, last = stats["convergence"][0], stats["convergence"][-1]
    assert [first[key] for key in KEYS] == [None, None, None, True]  # one sample tells nothing
    assert [stats[key] for key in KEYS] == [last[key] for key in KEYS]
    assert 0 < last["halving_low_s"] < last["halving_s"] < last["halving_high_s"]
    # Samples are averaged: about as much work as was done, whatever the machine.
    assert last["halving_low_s"] < 3 * stats["wall_s"]
    assert last["halving_high_s"] > stats["wall_s"] / 3
    assert last["estimate_unstable"] is False
    said = r"estimated relMSE \d\.\d\de-\d\d, halving it takes \S+ m?s to \S+ m?s more \(90 %\)"
    assert re.search(f"^{said}$", done.stdout, re.MULTILINE)
    assert re.search(said, done.stderr)  # the progress line
    assert "unstable" not in done.stdout


def test_an_estimate_that_misses_light_is_said_to_be_unstable(program, source_dir, tmp_path):
    # A lamp in a bulb of glass: path tracing meets it in one path of some thousand, and its variance tells nothing yet.
    file, image = tmp_path / "stats.json", tmp_path / "o.exr"
    lamp = source_dir / "scenes/reference/sds-lamp.pbrt"
    small = ["--resolution", "32x32", "--stats", file]
    done = run(program, lamp, "-o", image, "--integrator", "path", "--spp", "32", *small)
    assert done.returncode == 0, done.stderr
    assert stats_of(file)["estimate_unstable"] is True
    assert re.search(
        r"^the error estimate is unstable.*: \d+ % of the surfaces in sight have no light yet$", done.stdout, re.M
    )
    done = run(program, lamp, "-o", image, "--integrator", "sppm:photonsperiteration=20000", "--passes", "32", *small)
    assert done.returncode == 0, done.stderr
    assert stats_of(file)["estimate_unstable"] is False
    assert "unstable" not in done.stdout


def test_what_all_passes_share_is_told(program, source_dir, tmp_path):
    # The variance between passes says nothing of photons and hit points that stay.
    diffuse = source_dir / "scenes/reference/diffuse.pbrt"
    file = tmp_path / "stats.json"
    base = [program, diffuse, "-o", tmp_path / "o.exr", "--resolution", "32x32", "--passes", "20", "--stats", file]
    for options, said in [
        (["--integrator", "ppm:photonsperiteration=2000"], "all passes share one eye sample of a pixel"),
        (["--integrator", "ppm:photonsperiteration=2000", "--spp", "4"], "all passes share 4 eye samples of a pixel"),
        (["--integrator", "photon_map:photons=2000"], "all passes look the same photons up"),
    ]:
        done = run(*base, *options)
        assert done.returncode == 0, done.stderr
        assert f"the error estimate is unstable, the true error may be much larger: {said}" in done.stdout
        assert stats_of(file)["estimate_unstable"] is True
    done = run(*base, "--integrator", "ppm:photonsperiteration=2000", "--spp", "16")
    assert done.returncode == 0, done.stderr
    assert "all passes share" not in done.stdout
