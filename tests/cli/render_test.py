"""`lampyris render`: images, statistics, budgets, interruption, errors and exit codes, as a user or a script meets them."""

import json
import os
import signal
import struct
import subprocess
import threading
import time

import pytest

# The keys of shared schema lampyris.stats/1 that scripts may rely on (docs/stats.md).
STATS_KEYS = {
    "schema", "scene", "integrator", "photon_map", "backend", "device", "threads", "seed", "resolution", "passes",
    "samples_per_pixel", "wall_s", "phases", "setup_s", "rays", "photons_emitted", "photons_stored", "peak_memory_bytes",
    "device_memory_bytes", "effects", "radius", "bucket_load", "version", "scene_hash", "non_finite_samples", "unsupported",
    "convergence", "interrupted",
}  # fmt: skip

SCENE = """LookAt 0 0 -4  0 0 0  0 1 0
Camera "perspective" "float fov" 40
Sampler "independent" "integer pixelsamples" 4
PixelFilter "box" "float xradius" 0.5 "float yradius" 0.5
Film "rgb" "integer xresolution" 24 "integer yresolution" 16 "string filename" "named.exr"
Integrator "path" "integer maxdepth" 3
WorldBegin
LightSource "infinite" "rgb L" [ 0.5 0.6 0.7 ]
Material "diffuse" "rgb reflectance" [ 0.8 0.5 0.2 ]
Shape "sphere" "float radius" 1
"""


def command(program, *arguments):
    return [str(program), "render", *map(str, arguments)]


def run(program, *arguments, **options):
    options.setdefault("timeout", 60)
    return subprocess.run(command(program, *arguments), capture_output=True, text=True, check=False, **options)


def stats_of(path):
    return json.loads(path.read_text())


def read_pfm(path):
    """Width, height and rows from the top of RGB triples."""
    data = path.read_bytes()
    kind, size, scale, pixels = data.split(b"\n", 3)
    assert kind == b"PF"
    assert float(scale) == -1.0
    width, height = map(int, size.split())
    numbers = struct.unpack(f"<{width * height * 3}f", pixels)
    rows = [numbers[3 * width * y : 3 * width * (y + 1)] for y in range(height)][::-1]
    return width, height, rows


def read_exr_header(path):
    """Attributes of a single-part OpenEXR file: name -> raw value (OpenEXR's file layout, 'Attributes')."""
    data = path.read_bytes()
    assert data[:4] == b"\x76\x2f\x31\x01"
    at, attributes = 8, {}
    while data[at] != 0:
        name_end = data.index(b"\0", at)
        type_end = data.index(b"\0", name_end + 1)
        (size,) = struct.unpack_from("<i", data, type_end + 1)
        attributes[data[at:name_end].decode()] = data[type_end + 5 : type_end + 5 + size]
        at = type_end + 5 + size
    return attributes


def exr_channels(attributes):
    names, at, raw = [], 0, attributes["channels"]
    while raw[at] != 0:
        end = raw.index(b"\0", at)
        names.append(raw[at:end].decode())
        at = end + 17
    return names


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "scene.pbrt"
    path.write_text(SCENE)
    return path


# ---- Images -------------------------------------------------------------------------------------------------------------


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


def test_exr_holds_features_and_provenance(program, scene, tmp_path):
    exr = tmp_path / "out.exr"
    assert run(program, scene, "-o", exr, "--seed", "77", "--set", "integrator.maxdepth=2").returncode == 0
    header = read_exr_header(exr)
    assert {"R", "G", "B", "albedo.R", "normal.X", "depth.Z", "variance.G", "samples"} <= set(exr_channels(header))
    text = {name.removeprefix("lampyris."): value.decode() for name, value in header.items() if name.startswith("lampyris.")}
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


# ---- Statistics ---------------------------------------------------------------------------------------------------------


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
    assert convergence[0]["estimated_error"] is None  # one sample tells no variance
    assert convergence[-1]["estimated_error"] > 0
    assert all(a["wall_s"] <= b["wall_s"] for a, b in zip(convergence, convergence[1:]))
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
    # The estimate from the variance means what the reference says, and compare says what render said.
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


# ---- Budgets ------------------------------------------------------------------------------------------------------------


def test_target_error_stops(program, scene, tmp_path):
    file = tmp_path / "stats.json"
    done = run(program, scene, "-o", tmp_path / "o.exr", "--target-error", "1e-4", "--stats", file)
    assert done.returncode == 0
    stats = stats_of(file)
    assert stats["convergence"][-1]["estimated_error"] <= 1e-4
    assert stats["convergence"][-2]["estimated_error"] > 1e-4
    # The first limit reached stops.
    assert run(program, scene, "-o", tmp_path / "o.exr", "--target-error", "1e-9", "--spp", "16", "--stats", file).returncode == 0
    assert stats_of(file)["passes"] == 16


def test_time_stops(program, scene, tmp_path):
    file = tmp_path / "stats.json"
    done = run(program, scene, "-o", tmp_path / "o.exr", "--time", "2s", "--stats", file, "--resolution", "64x48")
    assert done.returncode == 0
    stats = stats_of(file)
    assert 1.5 < stats["wall_s"] < 3.0
    assert stats["passes"] > 4  # time takes the place of the scene's number of samples
    assert stats["interrupted"] is False


def test_passes_and_spp(program, scene, tmp_path):
    file = tmp_path / "stats.json"
    for arguments, passes in [(["--spp", "3"], 3), (["--passes", "5"], 5), (["--passes", "5", "--spp", "2"], 2), ([], 4)]:
        assert run(program, scene, "-o", tmp_path / "o.exr", "--stats", file, *arguments).returncode == 0
        assert stats_of(file)["passes"] == passes


def wait_until_caught(process, signal_number):
    """Until the program catches the signal: while it starts, it would end by it."""
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


# ---- What is printed ----------------------------------------------------------------------------------------------------


def test_quiet_prints_nothing(program, scene, tmp_path):
    done = run(program, scene, "-o", tmp_path / "o.exr", "--quiet")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    done = run(program, tmp_path / "missing.pbrt", "-o", tmp_path / "o.exr", "--quiet")
    assert done.returncode == 1
    assert "missing.pbrt" in done.stderr  # errors are told all the same


def test_results_and_progress_go_to_different_streams(program, scene, tmp_path):
    done = run(program, scene, "-o", tmp_path / "o.exr")
    assert "o.exr" in done.stdout
    assert "Mrays/s" in done.stdout
    assert "passes" in done.stderr
    assert "\r" not in done.stderr  # no progress bar in a log


# ---- Errors -------------------------------------------------------------------------------------------------------------


def assert_refused(done, code, *parts):
    assert done.returncode == code, done.stderr
    assert done.stdout == ""
    assert "error:" in done.stderr
    for part in parts:
        assert part in done.stderr


def test_scene_errors_are_located_with_a_caret(program, scene, tmp_path):
    scene.write_text(SCENE.replace('"sphere"', '"shpere"').replace("LightSource", "LigtSource"))
    done = run(program, scene, "-o", tmp_path / "o.exr")
    assert_refused(done, 1, f"{scene}:8:1: error:", f"{scene}:10:7: error:", "sphere", "LightSource", "did you mean")
    lines = done.stderr.splitlines()
    line = next(i for i, text in enumerate(lines) if text.startswith(f"{scene}:10:7"))
    assert lines[line + 1].startswith('Shape "shpere"')
    assert lines[line + 2] == "      ^"
    assert not (tmp_path / "o.exr").exists()


@pytest.mark.parametrize(
    ("arguments", "part"),
    [
        (["--integrator", "pth"], "path"),
        (["--set", "integrator.maxdeth=3"], "maxdepth"),
        (["--set", "integrator.maxdepth=many"], "maxdepth"),
        (["--set", "maxdepth=3"], "SECTION.KEY=VALUE"),
        (["--set", "film.iso=3"], "film"),
        (["--integrator", "path:maxdepth"], "maxdepth"),
        (["--backend", "cuda"], "vulkan"),
        (["--spp", "0"], "--spp"),
        (["--spp", "-3"], "spp"),
        (["--spp", "many"], "spp"),
        (["--time", "soon"], "soon"),
        (["--target-error", "-1"], "--target-error"),
        (["--resolution", "0x5"], "--resolution"),
        (["--resolution", "wide"], "--resolution"),
        (["--crop", "0,0,99,5"], "24x16"),
        (["--crop", "3,3,3,5"], "3,3"),
        (["--crop", "1,2,3"], "--crop"),
        (["--replay", "24,0,0"], "24x16"),
        (["--replay", "0,0,-1"], "--replay"),
        (["--max-memory", "lots"], "lots"),
        (["--seed", "-1"], "seed"),
        (["--threads", "0"], "threads"),
        (["--plugin", "/no/such/plugin.so"], "plugin.so"),
        (["--reference", "/no/such/reference.exr"], "reference.exr"),
        (["--view", "Sepia"], "Sepia"),
        (["--no-such-option"], "no-such-option"),
    ],
)
def test_wrong_arguments(program, scene, tmp_path, arguments, part):
    done = run(program, scene, "-o", tmp_path / "o.png", *arguments)
    assert done.returncode == 1, done.stderr
    assert part in done.stderr
    assert done.stdout == ""
    assert not (tmp_path / "o.png").exists()


def test_an_unknown_integrator_of_the_scene_is_located(program, scene, tmp_path):
    scene.write_text(SCENE.replace('Integrator "path"', 'Integrator "pathh"'))
    assert_refused(run(program, scene, "-o", tmp_path / "o.exr"), 1, f"{scene}:6:12: error:", "pathh", "path")
    # Another one on the command line renders the scene.
    assert run(program, scene, "-o", tmp_path / "o.exr", "--integrator", "path").returncode == 0


def test_outputs_that_cannot_be_written_are_told_before_rendering(program, scene, tmp_path):
    started = time.monotonic()
    missing = tmp_path / "no-such-folder" / "o.exr"
    done = run(program, scene, "-o", missing, "--time", "60s")
    assert done.returncode in (1, 2)
    assert "no-such-folder" in done.stderr
    done = run(program, scene, "-o", tmp_path / "o.gif", "--time", "60s")
    assert done.returncode == 1
    assert ".exr" in done.stderr
    done = run(program, scene, "-o", tmp_path / "o.exr", "--stats", tmp_path / "no-such-folder" / "s.json", "--time", "60s")
    assert done.returncode in (1, 2)
    assert "no-such-folder" in done.stderr
    done = run(program, scene, "-o", tmp_path, "--time", "60s")
    assert done.returncode in (1, 2)
    assert time.monotonic() - started < 30


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_no_permission_is_the_machines_fault(program, scene, tmp_path):
    folder = tmp_path / "closed"
    folder.mkdir(mode=0o500)
    assert_refused(run(program, scene, "-o", folder / "o.exr"), 2, "closed", "ermission")


def test_a_folder_that_takes_no_files_is_the_machines_fault(program, scene):
    assert run(program, scene, "-o", "/proc/o.exr").returncode == 2


def test_too_little_memory_is_the_machines_fault(program, scene, tmp_path):
    assert_refused(run(program, scene, "-o", tmp_path / "o.exr", "--max-memory", "1K"), 2, "--max-memory")
    assert run(program, scene, "-o", tmp_path / "o.exr", "--max-memory", "1G").returncode == 0
    done = run(program, scene, "-o", tmp_path / "o.exr", "--max-memory", "16M", "--resolution", "4000x4000")
    assert_refused(done, 2, "--max-memory", "film")


def test_a_device_that_does_not_exist_is_told(program, scene, tmp_path):
    for backend in ["vulkan", "cpu"]:
        done = run(program, scene, "-o", tmp_path / "o.exr", "--backend", backend, "--device", "99")
        assert_refused(done, 1, "99", "CPU" if backend == "cpu" else "Vulkan")


def test_scenes_that_cannot_be_read(program, tmp_path):
    image = tmp_path / "o.exr"
    assert_refused(run(program, tmp_path / "missing.pbrt", "-o", image), 1, "missing.pbrt", "No such file")
    assert_refused(run(program, tmp_path, "-o", image), 1, str(tmp_path), "directory")
    binary = tmp_path / "binary.pbrt"
    binary.write_bytes(bytes(range(256)) * 10)
    assert_refused(run(program, binary, "-o", image), 1, "binary.pbrt:1:1")
    binary.write_bytes(b"")
    assert run(program, binary, "-o", image).returncode in (0, 1)
    assert run(program).returncode == 1


def test_a_pipe_is_told_and_does_not_hang(program, tmp_path):
    pipe = tmp_path / "pipe.pbrt"
    os.mkfifo(pipe)
    writer = threading.Thread(target=lambda: os.close(os.open(pipe, os.O_RDWR)), daemon=True)
    writer.start()
    assert_refused(run(program, pipe, "-o", tmp_path / "o.exr", timeout=20), 1, "pipe.pbrt", "not a regular file")


@pytest.mark.parametrize("name", ["with space.pbrt", "ümläut-光.pbrt", "quote'\".pbrt", "-dash.pbrt", "%s{}.pbrt"])
def test_odd_file_names(program, tmp_path, name):
    folder = tmp_path / name.removesuffix(".pbrt")
    folder.mkdir()
    (folder / name).write_text(SCENE)
    image, file = folder / name.replace("pbrt", "exr"), folder / name.replace("pbrt", "json")
    done = run(program, folder / name, "-o", image, "--stats", file)
    assert done.returncode == 0, done.stderr
    assert image.exists()
    assert stats_of(file)["scene"] == str(folder / name)
    (folder / name).write_text(SCENE.replace("Shape", "Shpe"))
    assert f"{folder / name}:10:1: error:" in run(program, folder / name, "-o", image).stderr


def test_a_full_disk_is_the_machines_fault(program, scene, tmp_path):
    with open("/dev/full", "w", encoding="utf-8") as full:
        done = subprocess.run(
            command(program, scene, "-o", tmp_path / "o.exr"), stdout=full, stderr=subprocess.PIPE, text=True, timeout=60, check=False
        )
    assert done.returncode == 2
    assert "No space left" in done.stderr
