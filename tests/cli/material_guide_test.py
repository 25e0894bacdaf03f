"""The material guide: its files are those of the example; the generator accepts them, and reports errors in others.

With --long, Lampyris is built with them and gives the result that the scene's comment derives, on both backends.
"""

import json
import math
import re
import subprocess

import pytest

from support.plugin_project import check_example, checked, guide_files, run, write_files
from support.render_program import read_pfm

SHEET = math.pi / (math.pi + math.pi / 2 - 2 / 3)


def test_the_guide_shows_the_example(source_dir):
    check_example(source_dir, "material-guide.md", "orennayar")


@pytest.fixture
def generate(source_dir, tmp_path):
    """Writes the headers for the tree's materials and the given folders."""

    def call(*folders):
        script = source_dir / "cmake/LampyrisMaterials.cmake"
        joined = ";".join(str(folder) for folder in folders)
        return run("cmake", f"-DOUTPUT={tmp_path}/out", f"-DFOLDERS={joined}", "-P", script)

    return call


def test_the_generator_takes_the_guides_folder(source_dir, generate, tmp_path):
    write_files(tmp_path / "orennayar", guide_files(source_dir, "material-guide.md", "orennayar"))
    done = generate(tmp_path / "orennayar")
    assert done.returncode == 0, done.stderr
    numbers = re.findall(r"MATERIAL_(\w+) = (\d+)u;", (tmp_path / "out/materials/list.h").read_text())
    assert [int(number) for _, number in numbers] == list(range(len(numbers)))
    assert numbers[-1][0] == "ORENNAYAR"  # the highest rank
    dispatch = (tmp_path / "out/materials/dispatch.h").read_text()
    assert '#include "orennayar/orennayar_bsdf.h"' in dispatch
    for function in ["make", "eval", "sample", "is_specular", "chooses_lobe", "transmits", "albedo", "visible_action"]:
        assert dispatch.count(f"orennayar_{function}(") == 1, function
    # All coats share one call for evaluating and one for sampling, because GLSL compilers inline every call.
    assert dispatch.count("coat_eval(") == dispatch.count("coat_sample(") == 1


def test_without_folders_the_generator_writes_what_the_build_has(generate, build_dir, tmp_path):
    cache = (build_dir / "CMakeCache.txt").read_text()
    if re.search(r"^LAMPYRIS_EXTRA_MATERIALS:\w+=.", cache, flags=re.MULTILINE):
        pytest.skip("this build has materials of other folders")
    assert generate().returncode == 0
    for name in ["list.h", "dispatch.h"]:
        assert (tmp_path / "out/materials" / name).read_text() == (build_dir / "generated/materials" / name).read_text()


@pytest.mark.parametrize(
    ("folder", "files", "said"),
    [
        ("Clay", {}, "lower-case"),
        ("clay", {}, "no clay.cmake"),
        ("clay", {"clay.cmake": ""}, "does not call lampyris_material(clay ...)"),
        ("clay", {"clay.cmake": "lampyris_material(sand RANK 1)"}, "the name is that of the folder"),
        ("clay", {"clay.cmake": "lampyris_material(clay)"}, "wrong arguments"),
        ("clay", {"clay.cmake": "lampyris_material(clay RANK first)"}, "wrong arguments"),
        ("clay", {"clay.cmake": "lampyris_material(clay RANK 1 RARE)"}, "wrong arguments"),
        ("clay", {"clay.cmake": "lampyris_material(clay RANK 1)"}, "no clay_bsdf.h"),
        ("diffuse", {"diffuse.cmake": "lampyris_material(diffuse RANK 1)"}, "there is a material"),
    ],
)
def test_the_generator_says_what_is_wrong_with_a_folder(generate, tmp_path, folder, files, said):
    (tmp_path / folder).mkdir()
    write_files(tmp_path / folder, files)
    done = generate(tmp_path / folder)
    assert done.returncode != 0
    assert said in " ".join(done.stderr.split())


def cost(program, scene, folder):
    """What a scene asks of a program: the image, the size of each shader, the scene's memory."""
    said = {"memory": json.loads(checked(program, "describe", scene, "--json").stdout)["memory_bytes"]}
    for backend in ["cpu", "vulkan"]:
        image, stats = folder / "image.pfm", folder / "stats.json"
        small = ["--resolution", "32x24", "--passes", "2", "--seed", "5"]
        checked(program, "render", scene, "-o", image, "--stats", stats, "--backend", backend, *small)
        said[backend] = image.read_bytes(), json.loads(stats.read_text())["spirv_bytes"]
    return said


def assert_no_cost(without, having, name):
    """The same image and memory, and shaders of the same size within 0.2 %."""
    assert having["memory"] == without["memory"], name
    for backend in ["cpu", "vulkan"]:
        assert having[backend][0] == without[backend][0], name
        assert having[backend][1].keys() == without[backend][1].keys()
        for kernel, size in without[backend][1].items():
            assert having[backend][1][kernel] == pytest.approx(size, rel=0.002), name
    assert without["vulkan"][1], "no shader was compiled"


@pytest.mark.long
def test_lampyris_is_built_with_the_guides_material(source_dir, build_dir, tmp_path):
    write_files(tmp_path / "orennayar", guide_files(source_dir, "material-guide.md", "orennayar"))
    options = [f"-DLAMPYRIS_EXTRA_MATERIALS={tmp_path}/orennayar", "-DLAMPYRIS_TESTS=OFF"]
    quick = ["-DLAMPYRIS_SPECIALISED_KERNELS=OFF", "-DCMAKE_BUILD_TYPE=Release"]
    checked("cmake", "-S", source_dir, "-B", tmp_path / "build", "-G", "Ninja", *options, *quick)
    # Every kernel is compiled: a quarter of an hour on two cores.
    subprocess.run(["cmake", "--build", tmp_path / "build", "--target", "lampyris_program"], check=True, timeout=2700)
    program = tmp_path / "build/lampyris"
    assert "facets" in checked(program, "plugins", "material", "orennayar").stdout
    images = {}
    for backend in ["cpu", "vulkan"]:
        image = tmp_path / f"{backend}.pfm"
        checked(program, "render", tmp_path / "orennayar/sheet.pbrt", "-o", image, "--backend", backend)
        width, height, rows = images[backend] = read_pfm(image)
        # 16 x 16 x 64 samples with a standard deviation below 0.5: 0.004 for the mean, of which this is five.
        assert sum(map(sum, rows)) / (3 * width * height) == pytest.approx(SHEET, abs=0.02)
    assert images["cpu"] == images["vulkan"]
    # Scenes that do not ask for the new effect pay nothing: the same images and memory, and shaders that differ by 13
    # empty blocks (208 bytes, 0.14 % on cornell-box; no other instruction is added).
    for name in [
        "cornell-box/scene",
        "reference/conductor-rough",
        "reference/coated-diffuse",
        "reference/dielectric-rough",
    ]:
        scene = source_dir / f"scenes/{name}.pbrt"
        assert_no_cost(cost(build_dir / "lampyris", scene, tmp_path), cost(program, scene, tmp_path), name)
