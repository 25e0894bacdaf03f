"""`lampyris compare`: its output, its errors, and its exit codes, as users and scripts see them."""

import json
import math
import struct
import subprocess

import pytest

from support.render_program import run as render

KEYS = {"mse", "rmse", "relmse", "relmse_trimmed", "mape", "smape", "flip", "mean", "reference_mean", "non_finite"}


def write_pfm(path, width, height, pixels):
    """Rows from the top, RGB triples; the format stores them from the bottom."""
    rows = [pixels[y * width : (y + 1) * width] for y in range(height)]
    numbers = [number for row in reversed(rows) for pixel in row for number in pixel]
    path.write_bytes(f"PF\n{width} {height}\n-1.0\n".encode() + struct.pack(f"<{len(numbers)}f", *numbers))
    return path


def run(program, *arguments, **options):
    return subprocess.run(
        [program, "compare", *map(str, arguments)], capture_output=True, text=True, timeout=60, check=False, **options
    )


@pytest.fixture
def pair(tmp_path):
    """A grey reference, and an image that is 0.5 brighter in its top row."""
    width, height = 12, 10
    grey = [(0.25, 0.5, 1.0)] * (width * height)
    image = [(r + 0.5, g + 0.5, b + 0.5) if i < width else (r, g, b) for i, (r, g, b) in enumerate(grey)]
    return write_pfm(tmp_path / "image.pfm", width, height, image), write_pfm(tmp_path / "ref.pfm", width, height, grey)


def test_json_has_the_keys_of_the_contract(program, pair):
    done = run(program, *pair, "--json")
    assert done.returncode == 0, done.stderr
    result = json.loads(done.stdout)
    assert result["schema"] == "lampyris.compare/1"
    assert set(result) >= KEYS
    assert result["resolution"] == [12, 10]
    assert result["mse"] == pytest.approx(0.25 / 10)
    assert result["rmse"] == pytest.approx(math.sqrt(0.25 / 10))
    relative = (0.25 / 0.0725 + 0.25 / 0.26 + 0.25 / 1.01) / 3 / 10
    assert result["relmse"] == pytest.approx(relative)
    assert result["reference_mean"] == pytest.approx([0.25, 0.5, 1.0])
    assert result["mean"] == pytest.approx([0.3, 0.55, 1.05])
    assert result["non_finite"] == 0
    assert 0 < result["flip"] < 1
    assert result["flip_kind"] == "HDR"


def test_the_table_states_a_formula_beside_every_number(program, pair):
    done = run(program, *pair)
    assert done.returncode == 0
    for name, formula in [
        ("MSE", "mean (I-R)^2"),
        ("relMSE", "mean (I-R)^2 / (R^2 + 0.01)"),
        ("MAPE", "mean |I-R| / (|R| + 0.01)"),
        ("SMAPE", "mean 2 |I-R| / (|I| + |R| + 0.01)"),
        ("FLIP", "67 pixels per degree"),
    ]:
        assert any(line.startswith(name) and formula in line for line in done.stdout.splitlines()), done.stdout


def test_equal_images_have_no_error(program, pair):
    result = json.loads(run(program, pair[1], pair[1], "--json").stdout)
    assert all(result[key] == 0 for key in ["mse", "rmse", "relmse", "relmse_trimmed", "mape", "smape", "flip"])


def test_a_crop_compares_its_pixels_only(program, pair):
    lower = json.loads(run(program, *pair, "--json", "--crop", "0,1,12,10").stdout)
    assert lower["mse"] == 0
    assert lower["resolution"] == [12, 9]
    upper = json.loads(run(program, *pair, "--json", "--crop=0,0,3,1").stdout)
    assert upper["mse"] == pytest.approx(0.25)


def test_a_part_is_compared_with_its_place_in_the_whole(program, scene, tmp_path):
    """Pixels of a crop are those of the whole picture, whichever of the two is the reference."""
    whole, part = tmp_path / "whole.exr", tmp_path / "part.exr"
    for image, options in ((whole, ()), (part, ("--crop", "5,3,20,11"))):
        done = render(program, scene, "-o", image, "--passes", "2", *options)
        assert done.returncode == 0, done.stderr
    for pair in ((part, whole), (whole, part)):
        done = run(program, *pair, "--json")
        assert done.returncode == 0, done.stderr
        result = json.loads(done.stdout)
        assert result["resolution"] == [15, 8]
        assert result["mse"] == 0
        assert result["mean"][0] > 0


@pytest.mark.parametrize("crop", ["0,0,13,1", "5,5,5,6", "-1,0,3,3", "1,2,3", "a,b,c,d"])
def test_a_wrong_crop_is_a_wrong_argument(program, pair, crop):
    done = run(program, *pair, f"--crop={crop}")
    assert done.returncode == 1
    assert "crop" in done.stderr
    assert done.stdout == ""


def test_non_finite_pixels_are_told_and_left_out(program, tmp_path):
    good = [(1.0, 1.0, 1.0)] * 16
    bad = good.copy()
    bad[3] = (float("nan"), 1.0, 1.0)
    bad[7] = (1.0, float("inf"), 1.0)
    image, reference = write_pfm(tmp_path / "i.pfm", 4, 4, bad), write_pfm(tmp_path / "r.pfm", 4, 4, good)
    result = json.loads(run(program, image, reference, "--json").stdout)
    assert result["non_finite"] == 2
    assert result["mse"] == 0
    assert "2 of 16 pixels hold NaN or Inf" in run(program, image, reference).stdout
    nothing = write_pfm(tmp_path / "n.pfm", 1, 1, [(float("nan"),) * 3])
    assert json.loads(run(program, nothing, nothing, "--json").stdout)["mse"] is None


def test_different_sizes_are_named(program, pair, tmp_path):
    other = write_pfm(tmp_path / "other.pfm", 5, 7, [(0.0, 0.0, 0.0)] * 35)
    for arguments in [[pair[0], other], [pair[0], other, "--crop=0,0,2,2"]]:
        done = run(program, *arguments)
        assert done.returncode == 1
        assert "12x10" in done.stderr
        assert "5x7" in done.stderr


def test_unreadable_files_are_named(program, pair, tmp_path):
    done = run(program, tmp_path / "missing.exr", pair[1])
    assert done.returncode == 1
    assert "missing.exr" in done.stderr
    assert "No such file" in done.stderr
    (tmp_path / "text.exr").write_text("no picture")
    done = run(program, tmp_path / "text.exr", pair[1])
    assert done.returncode == 1
    assert "text.exr" in done.stderr


def test_the_error_image_is_a_png_of_the_same_size(program, pair, tmp_path):
    target = tmp_path / "error.png"
    assert run(program, *pair, "--error-image", target).returncode == 0
    data = target.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    assert struct.unpack(">II", data[16:24]) == (12, 10)
    # It can be read back, and equals itself; the metrics of integer files use LDR-FLIP.
    result = json.loads(run(program, target, target, "--json").stdout)
    assert result["flip_kind"] == "LDR"
    assert result["flip"] == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["error.png", "image.pfm", "ref.pfm"]


def test_an_error_image_that_cannot_be_written_is_told_first(program, pair, tmp_path):
    done = run(program, *pair, "--error-image", tmp_path / "no-such-folder" / "e.png")
    assert done.returncode == 1
    assert "no-such-folder" in done.stderr
    assert done.stdout == ""
    assert run(program, *pair, "--error-image", tmp_path / "e.gif").returncode == 1


def test_a_full_disk_under_standard_output_is_no_success(program, pair):
    with open("/dev/full", "w", encoding="utf-8") as full:
        done = subprocess.run(
            [program, "compare", *pair], stdout=full, stderr=subprocess.PIPE, text=True, timeout=60, check=False
        )
    assert done.returncode == 2
    assert "No space left" in done.stderr


def test_the_program_knows_its_commands(program):
    done = subprocess.run([program, "--version"], capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 0
    assert done.stdout.startswith("lampyris ")
    done = subprocess.run([program, "compere"], capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 1
    assert "compare" in done.stderr
    assert done.stdout == ""
    assert run(program, "--help").returncode == 0
    assert run(program).returncode == 1
