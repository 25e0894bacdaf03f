"""`lampyris render`: images, statistics, budgets, interruption, as users and scripts see them."""

import itertools
import json
import signal
import struct
import subprocess
import time

import pytest

from support.render_program import SCENE, command, exr_channels, read_exr_header, read_pfm, run, stats_of

# The keys of shared schema lampyris.stats/1 that scripts may rely on (docs/stats.md).
STATS_KEYS = {
    "schema", "scene", "integrator", "photon_map", "backend", "device", "threads", "seed", "resolution", "passes",
    "samples_per_pixel", "wall_s", "phases", "setup_s", "rays", "photons_emitted", "photons_stored",
    "peak_memory_bytes", "device_memory_bytes", "effects", "radius", "bucket_load", "version", "scene_hash",
    "non_finite_samples", "unsupported", "convergence", "interrupted",
}  # fmt: skip


# ---- Images ----------------------------------------------------------------------------------------------------------


def test_every_format_is_written_and_holds_the_same_picture(program, scene, tmp_path):
    exr, pfm, png = (tmp_path / f"out.{kind}" for kind in ["exr", "pfm", "png"])
    done = run(program, scene, "-o", exr, "-o", pfm, "-o", png)
    assert done.returncode == 0, done.stderr
    for path in [exr, pfm, png]:
        assert str(path) in done.stdout
    width, height, rows = read_pfm(pfm)
    assert (width, height) == (24, 16)
    assert rows[0][:3] == pytest.approx((0.5, 0.6, 0.7))  # the corner sees the sky
    assert rows[8][36] == pytest.approx(0.8 * 0.5, rel=0.3)  # the middle sees the sphere
    compared = subprocess.run(
        [program, "compare", exr, pfm, "--json"], capture_output=True, text=True, check=False, timeout=60
    )
    assert json.loads(compared.stdout)["mse"] == 0
    assert png.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    assert struct.unpack(">II", png.read_bytes()[16:24]) == (24, 16)


def test_light_beyond_a_float_is_warned_of(program, tmp_path):
    scene = tmp_path / "bright.pbrt"
    scene.write_text(
        'Film "rgb" "integer xresolution" 4 "integer yresolution" 4\nCamera "perspective"\nWorldBegin\n'
        'LightSource "infinite" "rgb L" [ 1e38 1e38 1e38 ]\n'
    )
    pfm, stats_file = tmp_path / "out.pfm", tmp_path / "stats.json"
    limits = ["--passes", "16", "--target-error", "1"]
    done = run(program, scene, "-o", pfm, "--stats", stats_file, *limits)
    assert done.returncode == 0, done.stderr
    assert "warning: left out 208 samples that were not finite, or too large to be added to the others" in done.stderr
    assert "warning: the error of 16 pixels is not known" in done.stderr
    stats = json.loads(stats_file.read_text())
    assert stats["non_finite_samples"] == 16 * 13  # the fourth sample of each pixel, and those after it
    assert stats["estimated_error"] is None
    assert stats["passes"] == 16  # an unknown error reaches no target
    for row in read_pfm(pfm)[2]:
        assert row == pytest.approx([1e38] * 12, rel=1e-6)


def test_exr_holds_the_parameters_of_the_photon_map(program, scene, tmp_path):
    exr = tmp_path / "out.exr"
    choice = "stochastic_hash:slots=2,table_size=0.5"
    done = run(program, scene, "-o", exr, "--integrator", "sppm", "--photon-map", choice, "--passes", "1")
    assert done.returncode == 0, done.stderr
    header = read_exr_header(exr)
    assert header["lampyris.photon_map"].decode() == "stochastic_hash"
    parameters = header["lampyris.photon_map_parameters"].decode().split(",")
    assert {"slots=2", "table_size=0.5"} <= set(parameters)


def test_exr_holds_features_and_provenance(program, scene, tmp_path):
    exr = tmp_path / "out.exr"
    assert run(program, scene, "-o", exr, "--seed", "77", "--set", "integrator.maxdepth=2").returncode == 0
    header = read_exr_header(exr)
    assert {"R", "G", "B", "albedo.R", "normal.X", "depth.Z", "variance.G", "samples"} <= set(exr_channels(header))
    ours = "lampyris."
    text = {name.removeprefix(ours): value.decode() for name, value in header.items() if name.startswith(ours)}
    assert text["seed"] == "77"
    assert text["passes"] == "4"
    assert text["integrator"] == "path"
    assert "maxdepth=2" in text["parameters"]
    assert text["backend"] == "cpu"
    assert text["device"]
    version = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout.split()[1]
    assert text["version"] == version
    assert text["scene"].endswith("scene.pbrt")
    assert len(text["scene_hash"]) == 16


def test_the_scene_names_the_image_where_the_command_does_not(program, scene, tmp_path):
    assert run(program, scene, cwd=tmp_path).returncode == 0
    assert (tmp_path / "named.exr").exists()
    scene.write_text(SCENE.replace(' "string filename" "named.exr"', ""))
    done = run(program, scene, cwd=tmp_path)
    assert done.returncode in (0, 1)
    assert done.returncode == 0 or "-o" in done.stderr


def test_resolution_and_crop(program, scene, tmp_path):
    whole, part, exr = tmp_path / "whole.pfm", tmp_path / "part.pfm", tmp_path / "part.exr"
    assert run(program, scene, "-o", whole, "--resolution", "30x20").returncode == 0
    assert run(program, scene, "-o", part, "-o", exr, "--resolution", "30x20", "--crop", "4,5,19,17").returncode == 0
    width, height, rows = read_pfm(whole)
    assert (width, height) == (30, 20)
    width, height, cropped = read_pfm(part)
    assert (width, height) == (15, 12)
    assert cropped == [row[3 * 4 : 3 * 19] for row in rows[5:17]]
    header = read_exr_header(exr)
    assert struct.unpack("<4i", header["dataWindow"]) == (4, 5, 18, 16)
    assert struct.unpack("<4i", header["displayWindow"]) == (0, 0, 29, 19)


def test_seeds_and_replay(program, scene, tmp_path):
    images = []
    for seed in [5, 5, 6]:
        path = tmp_path / f"{len(images)}.pfm"
        assert run(program, scene, "-o", path, "--seed", seed, "--spp", "1").returncode == 0
        images.append(read_pfm(path)[2])
    assert images[0] == images[1]
    assert images[0] != images[2]
    done = run(program, scene, "--replay", "12,8,0", "--seed", "5")
    assert done.returncode == 0
    replay = json.loads(done.stdout)
    assert replay["radiance"] == list(images[0][8][36:39])
    assert replay["pixel"] == [12, 8]
    assert replay["rays"] >= 2


# ---- Statistics ------------------------------------------------------------------------------------------------------


def test_statistics_have_the_keys_of_the_contract(program, scene, tmp_path):
    file = tmp_path / "stats.json"
    done = run(program, scene, "-o", tmp_path / "o.exr", "--stats", file, "--threads", "2", "--seed", "9", "--spp", "8")
    assert done.returncode == 0, done.stderr
    stats = stats_of(file)
    assert set(stats) >= STATS_KEYS, STATS_KEYS - set(stats)
    assert stats["schema"] == "lampyris.stats/1"
    assert stats["scene"] == str(scene)
    assert stats["integrator"]["name"] == "path"
    assert stats["integrator"]["parameters"]["maxdepth"] == 3
    assert stats["photon_map"] is None
    assert (stats["backend"], stats["threads"], stats["seed"]) == ("cpu", 2, 9)
    assert stats["resolution"] == [24, 16]
    assert (stats["passes"], stats["samples_per_pixel"]) == (8, 8)
    assert stats["rays"] >= 24 * 16 * 8
    assert 0 < stats["wall_s"] < 60
    assert set(stats["setup_s"]) >= {"parse", "build", "compile"}
    assert all(seconds >= 0 for seconds in stats["setup_s"].values())
    assert 1e6 < stats["peak_memory_bytes"] < 1e10
    assert 24 * 16 * 16 < stats["device_memory_bytes"] < 1e9
    assert stats["non_finite_samples"] == 0
    assert stats["photons_emitted"] == stats["photons_stored"] == 0
    assert stats["interrupted"] is False
    assert stats["unsupported"] == []
    effects = {effect["name"]: effect for effect in stats["effects"]}
    assert "quadrics" in effects
    assert f"{scene}:10" in effects["quadrics"]["asked_by"]
    assert effects["quadrics"]["simulated"] is True
    convergence = stats["convergence"]
    assert [point["passes"] for point in convergence] == [1, 2, 4, 8]
    assert convergence[0]["estimated_error"] is None  # one sample has no variance
    assert convergence[-1]["estimated_error"] > 0
    assert all(a["wall_s"] <= b["wall_s"] for a, b in itertools.pairwise(convergence))
    assert "mse" not in convergence[0]


def test_a_reference_gives_the_error_over_time(program, scene, tmp_path):
    reference, file = tmp_path / "reference.exr", tmp_path / "stats.json"
    assert run(program, scene, "-o", reference, "--spp", "1024", "--seed", "1").returncode == 0
    image = tmp_path / "o.exr"
    done = run(program, scene, "-o", image, "--reference", reference, "--stats", file, "--spp", "64", "--seed", "2")
    assert done.returncode == 0, done.stderr
    convergence = stats_of(file)["convergence"]
    assert all({"mse", "relmse"} <= set(point) for point in convergence)
    assert convergence[-1]["mse"] < convergence[0]["mse"] / 8
    # The estimate from the variance agrees with the reference, and compare with render.
    assert convergence[-1]["estimated_error"] == pytest.approx(convergence[-1]["relmse"], rel=0.4)
    compared = subprocess.run(
        [program, "compare", image, reference, "--json"], capture_output=True, text=True, check=False, timeout=60
    )
    assert json.loads(compared.stdout)["relmse"] == pytest.approx(convergence[-1]["relmse"], rel=1e-4)
    other = run(program, scene, "-o", image, "--reference", reference, "--resolution", "10x10")
    assert other.returncode == 1
    assert "24x16" in other.stderr
    assert "10x10" in other.stderr


def test_unsupported_parts_are_errors_or_listed(program, scene, tmp_path):
    scene.write_text(SCENE.replace("Shape", 'Material "measured" "string filename" "x.bsdf"\nShape'))
    done = run(program, scene, "-o", tmp_path / "o.exr")
    assert done.returncode == 1
    assert f"{scene}:10:" in done.stderr
    file = tmp_path / "stats.json"
    done = run(program, scene, "-o", tmp_path / "o.exr", "--skip-unsupported", "--stats", file)
    assert done.returncode == 0, done.stderr
    assert "warning" in done.stderr
    stats = stats_of(file)
    assert len(stats["unsupported"]) == 1
    assert "scene.pbrt:10" in stats["unsupported"][0]
    assert [effect for effect in stats["effects"] if not effect["simulated"]]


# ---- Budgets ---------------------------------------------------------------------------------------------------------


def test_target_error_stops(program, scene, tmp_path):
    file = tmp_path / "stats.json"
    done = run(program, scene, "-o", tmp_path / "o.exr", "--target-error", "1e-4", "--stats", file)
    assert done.returncode == 0
    stats = stats_of(file)
    assert stats["convergence"][-1]["estimated_error"] <= 1e-4
    assert stats["convergence"][-2]["estimated_error"] > 1e-4
    # The first limit reached stops.
    limits = ["--target-error", "1e-9", "--spp", "16"]
    assert run(program, scene, "-o", tmp_path / "o.exr", *limits, "--stats", file).returncode == 0
    assert stats_of(file)["passes"] == 16


def test_time_stops(program, scene, tmp_path):
    file = tmp_path / "stats.json"
    done = run(program, scene, "-o", tmp_path / "o.exr", "--time", "2s", "--stats", file, "--resolution", "64x48")
    assert done.returncode == 0
    stats = stats_of(file)
    assert 1.5 < stats["wall_s"] < 3.0
    assert stats["passes"] > 4  # time replaces the scene's number of samples
    assert stats["interrupted"] is False


def test_passes_and_spp(program, scene, tmp_path):
    file = tmp_path / "stats.json"
    cases = [(["--spp", "3"], 3), (["--passes", "5"], 5), (["--passes", "5", "--spp", "2"], 2), ([], 4)]
    for arguments, passes in cases:
        assert run(program, scene, "-o", tmp_path / "o.exr", "--stats", file, *arguments).returncode == 0
        assert stats_of(file)["passes"] == passes


def wait_until_caught(process, signal_number):
    """Waits until the program handles the signal, which would otherwise kill it while it starts."""
    deadline = time.monotonic() + 60
    caught = 0
    while not caught >> (signal_number - 1) & 1:
        assert time.monotonic() < deadline
        time.sleep(0.05)
        with open(f"/proc/{process.pid}/status") as status:
            caught = next(int(line.split()[1], 16) for line in status if line.startswith("SigCgt:"))


@pytest.mark.parametrize("signal_number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_writes_what_is_done(program, scene, tmp_path, signal_number):
    image, file = tmp_path / "o.pfm", tmp_path / "stats.json"
    arguments = command(program, scene, "-o", image, "--stats", file, "--time", "10min", "--resolution", "64x48")
    with subprocess.Popen(arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        wait_until_caught(process, signal_number)
        time.sleep(2.0)
        process.send_signal(signal_number)
        output, errors = process.communicate(timeout=60)
        assert process.returncode == 130, errors
    assert str(image) in output
    width, height, rows = read_pfm(image)
    assert (width, height) == (64, 48)
    assert rows[0][:3] == pytest.approx((0.5, 0.6, 0.7))
    stats = stats_of(file)
    assert stats["interrupted"] is True
    assert stats["passes"] >= 1
    assert stats["convergence"]


# ---- What is printed -------------------------------------------------------------------------------------------------


def test_quiet_prints_nothing(program, scene, tmp_path):
    done = run(program, scene, "-o", tmp_path / "o.exr", "--quiet")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    done = run(program, tmp_path / "missing.pbrt", "-o", tmp_path / "o.exr", "--quiet")
    assert done.returncode == 1
    assert "missing.pbrt" in done.stderr  # errors are still reported


def test_results_and_progress_go_to_different_streams(program, scene, tmp_path):
    done = run(program, scene, "-o", tmp_path / "o.exr")
    assert "o.exr" in done.stdout
    assert "Mrays/s" in done.stdout
    assert "passes" in done.stderr
    assert "\r" not in done.stderr  # no progress bar in a log
