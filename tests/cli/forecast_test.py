"""`lampyris render` predicts the next halving of the error, and reports an estimate that cannot be trusted."""

import re
import signal
import subprocess

import pytest

from support.render_program import command, run, stats_of

KEYS = ["halving_s", "halving_low_s", "halving_high_s", "estimate_unstable"]


def test_statistics_and_last_lines_have_the_forecast(program, scene, tmp_path):
    file = tmp_path / "stats.json"
    done = run(program, scene, "-o", tmp_path / "o.exr", "--stats", file, "--spp", "64")
    assert done.returncode == 0, done.stderr
    stats = stats_of(file)
    first, last = stats["convergence"][0], stats["convergence"][-1]
    assert [first[key] for key in KEYS] == [None, None, None, True]  # one sample has no variance
    assert [stats[key] for key in KEYS] == [last[key] for key in KEYS]
    assert 0 < last["halving_low_s"] < last["halving_s"] < last["halving_high_s"]
    # Samples are averaged: halving takes about as much work as was done, on any machine.
    assert last["halving_low_s"] < 3 * stats["wall_s"]
    assert last["halving_high_s"] > stats["wall_s"] / 3
    assert last["estimate_unstable"] is False
    said = r"estimated relMSE \d\.\d\de-\d\d, halving takes \S+ m?s to \S+ m?s more \(90 %\)"
    assert re.search(f"^{said}$", done.stdout, re.MULTILINE)
    assert re.search(said, done.stderr)  # the progress line
    assert "unstable" not in done.stdout


def test_an_estimate_that_misses_light_is_said_to_be_unstable(program, source_dir, tmp_path):
    # A lamp in a bulb of glass: one in thousands of paths finds it, so the variance is not meaningful yet.
    file, image = tmp_path / "stats.json", tmp_path / "o.exr"
    lamp = source_dir / "scenes/reference/sds-lamp.pbrt"
    small = ["--resolution", "32x32", "--stats", file]
    done = run(program, lamp, "-o", image, "--integrator", "path", "--spp", "16", *small)
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
    # The variance between passes does not include the error of photons and hit points that are kept.
    diffuse = source_dir / "scenes/reference/diffuse.pbrt"
    file = tmp_path / "stats.json"
    base = [program, diffuse, "-o", tmp_path / "o.exr", "--resolution", "32x32", "--passes", "20", "--stats", file]
    for options, said in [
        (["--integrator", "ppm:photonsperiteration=2000"], "all passes share one eye sample of a pixel"),
        (["--integrator", "ppm:photonsperiteration=2000", "--spp", "4"], "all passes share 4 eye samples of a pixel"),
        (["--integrator", "photon_map:photons=2000"], "all passes use the same photons"),
    ]:
        done = run(*base, *options)
        assert done.returncode == 0, done.stderr
        assert f"the error estimate is unstable, the true error may be much larger: {said}" in done.stdout
        assert stats_of(file)["estimate_unstable"] is True
    done = run(*base, "--integrator", "ppm:photonsperiteration=2000", "--spp", "16")
    assert done.returncode == 0, done.stderr
    assert "all passes share" not in done.stdout


@pytest.mark.parametrize(
    ("name", "options", "looks", "seed"),
    [
        # Caustics of a smooth ball, which paths find by chance: the means of fireflies in the denominators made
        # the estimate 6 to 29 times too low.
        ("reference/conductor-smooth", ["--integrator", "path"], 6, 3),
        ("reference/dielectric-smooth", ["--integrator", "path"], 6, 3),
        # At six seeds of ten, fireflies take some point below the limit here.
        ("demo/scene", ["--crop", "40,160,168,256"], 5, 8),
        # Nothing hides here.
        ("reference/diffuse", ["--integrator", "path"], 5, 3),
    ],
)
def test_the_estimate_is_the_error_against_the_reference(program, source_dir, tmp_path, name, options, looks, seed):
    # From 2 samples on the error is 0.5 to 1.2 times the estimate in the reference scenes, at one seed and another.
    file, scene = tmp_path / "stats.json", source_dir / "scenes" / f"{name}.pbrt"
    reference = scene.parent / "reference.exr" if name.startswith("demo") else scene.with_suffix(".exr")
    base = [program, scene, "-o", tmp_path / "o.exr", "--reference", reference, "--stats", file, "--seed", seed]
    done = run(*base, "--spp", str(2 ** (looks - 1)), *options)
    assert done.returncode == 0, done.stderr
    points = [point for point in stats_of(file)["convergence"] if point["passes"] >= 2]
    assert len(points) >= looks - 1
    for point in points:
        assert 1 / 3 < point["relmse"] / point["estimated_error"] < 2.5, point


def test_an_unstable_estimate_reaches_no_target(program, source_dir, tmp_path):
    # A point light behind glass: no path finds it, the picture is black, and the estimate is 0.
    file, scene = tmp_path / "stats.json", source_dir / "scenes/reference/sds-point.pbrt"
    base = [program, scene, "-o", tmp_path / "o.exr", "--resolution", "32x32", "--integrator", "path", "--stats", file]
    done = run(*base, "--target-error", "0.06", "--spp", "64")
    assert done.returncode == 0, done.stderr
    stats = stats_of(file)
    assert (stats["passes"], stats["target_reached"], stats["estimate_unstable"]) == (64, False, True)
    assert "the target error was not reached: the estimate is below it, but unstable\n" in done.stdout
    begins = r"^note: after 8 passes the estimated error is 0.00e\+00, below --target-error, but unstable: 100 % of "
    notes = re.findall(begins + ".*$", done.stderr, re.MULTILINE)
    assert len(notes) == 1
    assert notes[0].endswith("or until another limit; --accept-unstable would have stopped here")
    done = run(*base, "--target-error", "0.06", "--accept-unstable")
    assert done.returncode == 0, done.stderr
    stats = stats_of(file)
    assert (stats["passes"], stats["target_reached"], stats["estimate_unstable"]) == (8, True, True)
    assert "the target error was reached by an unstable estimate\n" in done.stdout


def test_a_target_above_the_error_is_not_reached(program, scene, tmp_path):
    file = tmp_path / "stats.json"
    done = run(program, scene, "-o", tmp_path / "o.exr", "--target-error", "1e-9", "--spp", "16", "--stats", file)
    assert stats_of(file)["target_reached"] is False
    assert "the target error was not reached\n" in done.stdout
    done = run(program, scene, "-o", tmp_path / "o.exr", "--target-error", "1", "--stats", file)
    assert stats_of(file)["target_reached"] is True
    assert "the target error was reached\n" in done.stdout
    done = run(program, scene, "-o", tmp_path / "o.exr", "--spp", "4", "--stats", file)
    assert stats_of(file)["target_reached"] is None
    assert "target error" not in done.stdout


def test_a_target_that_can_never_be_trusted_needs_another_limit(program, source_dir, tmp_path):
    diffuse = source_dir / "scenes/reference/diffuse.pbrt"
    base = [program, diffuse, "-o", tmp_path / "o.exr", "--resolution", "16x16", "--target-error", "10"]
    for integrator in ["ppm:photonsperiteration=500", "photon_map:photons=500"]:
        name = integrator.split(":")[0]
        done = run(*base, "--integrator", integrator)
        assert done.returncode == 1
        assert f'--target-error alone would never stop: with integrator "{name}"' in done.stderr
        assert "--accept-unstable" in done.stderr
        done = run(*base, "--integrator", integrator, "--accept-unstable")
        assert done.returncode == 0, done.stderr
        assert "reached by an unstable estimate" in done.stdout
        done = run(*base, "--integrator", integrator, "--passes", "12")
        assert done.returncode == 0, done.stderr
        assert "not reached: the estimate is below it, but unstable" in done.stdout
    # Enough eye samples that what they share is small.
    done = run(*base, "--integrator", "ppm:photonsperiteration=500", "--spp", "16")
    assert done.returncode == 0, done.stderr
    assert "the target error was reached\n" in done.stdout


def test_endless_rendering_says_so_even_where_it_is_to_be_quiet(program, source_dir, tmp_path):
    scene = source_dir / "scenes/reference/sds-point.pbrt"
    base = [
        "-o",
        tmp_path / "o.exr",
        "--resolution",
        "16x16",
        "--integrator",
        "path",
        "--target-error",
        "0.1",
        "--quiet",
    ]
    with subprocess.Popen(command(program, scene, *base), stderr=subprocess.PIPE, text=True) as process:
        line = process.stderr.readline()
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=30)
    assert line.startswith("note: after 8 passes the estimated error is 0.00e+00, below --target-error, but unstable")
    assert "or until Ctrl-C, which writes the image" in line
    assert process.returncode == 130
