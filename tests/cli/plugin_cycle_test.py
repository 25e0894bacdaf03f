"""Edit, build, run, again: plugins outside of the tree whose kernels, parameters and lists of files change, and the
Lampyris below them. Editing a kernel configures the project anew."""

import json
import os

import pytest

from support.plugin_project import EVERY, QUICK, build, checked, configure, write_files
from support.render_program import read_pfm

FLAT = {
    "CMakeLists.txt": "lampyris_add_plugin(flat SOURCES flat.cpp KERNELS flat.kernel.h HEADERS flat_params.h)\n",
    "flat_params.h": """#ifndef FLAT_PARAMS
#define FLAT_PARAMS
#include "core/kernel/params.h"
#define FLAT_PARAMS_LIST(P) P(float, value, 1.0f, 0.0f, 100.0f, "what every pixel shows")
PARAMS(FlatParams, FLAT_PARAMS_LIST)
#endif
""",
    "flat.kernel.h": """#include "core/kernel/prelude.h"
#include "core/kernel/layout.h"
#include "flat/flat_params.h"
BUFFER_RO(0, FilmWindow, window)
BUFFER_RO(1, FlatParams, params)
BUFFER_RW(2, FilmPixel, film)
KERNEL(flat) {
    float n = float(window[0].samples);
    float v = params[0].value;
    film[index].sum += vec3(n * v);
    film[index].weight += n;
    film[index].samples += window[0].samples;
}
""",
    "flat.cpp": """#include "core/render/integrator.h"
#include "flat/flat_params.h"
namespace {
class Flat : public lampyris::Integrator {
 public:
    FlatParams params;
    void render(lampyris::RenderSession& session) override {
        render_samples(session, "flat/flat.kernel.h", &params, sizeof(params));
    }
};
REGISTER_INTEGRATOR(Flat, FLAT_PARAMS_LIST, "flat", "Every pixel shows a number.")
}  // namespace
""",
}
SCENE = """Integrator "flat"
Camera "perspective"
Film "rgb" "integer xresolution" 4 "integer yresolution" 4
Sampler "independent" "integer pixelsamples" 1
WorldBegin
Shape "sphere"
"""
FIND = "find_package(Lampyris REQUIRED)\n"


class Project:
    """Plugins in folders of a common project, and their results."""

    def __init__(self, installed, folder, generator, top, files):
        self.program = installed / "bin/lampyris"
        self.folder = folder
        write_files(folder, {"CMakeLists.txt": f"cmake_minimum_required(VERSION 3.25)\n{top}", "scene.pbrt": SCENE})
        write_files(folder, files)
        # Speed does not matter here.
        configure(folder, installed, "-G", generator, *QUICK)
        build(folder)

    def edit(self, name, old, new):
        path = self.folder / name
        text = path.read_text()
        assert text.count(old) == 1
        path.write_text(text.replace(old, new))

    def value(self, backend):
        """The value that `flat` shows in all pixels."""
        image = self.folder / "image.pfm"
        arguments = ["-o", image, "--plugin", self.folder / "build/flat/flat.so", "--backend", backend, "--quiet"]
        checked(self.program, "render", self.folder / "scene.pbrt", *arguments)
        values = {value for row in read_pfm(image)[2] for value in row}
        assert len(values) == 1
        return values.pop()

    def photons_found(self, backend):
        """How many photons `every` finds for a query."""
        arguments = ["--plugin", self.folder / "build/every/every.so", "--backend", backend, "--structures", "every"]
        arguments += ["--points", "2000", "--queries", "500", "--seconds", "0", "--json"]
        done = checked(self.program, "bench", "photon-maps", *arguments)
        return json.loads(done.stdout)["rows"][0]["photons_found_mean"]


def in_folder(name, files):
    return {f"{name}/{file}": text for file, text in files.items()}


# Lampyris is found at the top, or in the plugin's folder.
@pytest.mark.parametrize(
    ("generator", "languages", "at_top", "in_it"),
    [("Unix Makefiles", "CXX", FIND, ""), ("Ninja", "C CXX", "", FIND)],
    ids=["make", "ninja"],
)
def test_an_edited_integrator_is_built_and_loads(installed, tmp_path, generator, languages, at_top, in_it):
    files = in_folder("flat", FLAT | {"CMakeLists.txt": in_it + FLAT["CMakeLists.txt"]})
    top = f"project(edited LANGUAGES {languages})\n{at_top}add_subdirectory(flat)\n"
    project = Project(installed, tmp_path / "a project", generator, top, files)
    assert project.value("cpu") == 1

    project.edit("flat/flat.kernel.h", "params[0].value", "2.0f * params[0].value")  # and so configure again
    build(project.folder)
    assert project.value("cpu") == project.value("vulkan") == 2

    # The list of parameters, and another file, which the kernel includes.
    project.edit("flat/flat_params.h", "value, 1.0f,", "value, 3.0f,")
    project.edit("flat/flat.kernel.h", "2.0f *", "kMore *")
    project.edit("flat/flat.kernel.h", '"flat/flat_params.h"\n', '"flat/flat_params.h"\n#include "flat/more.h"\n')
    project.edit("flat/CMakeLists.txt", "flat_params.h", "flat_params.h more.h")
    write_files(project.folder / "flat", {"more.h": "CONST float kMore = 4.0f;\n"})
    build(project.folder)
    assert project.value("cpu") == project.value("vulkan") == 12


def test_an_edited_photon_map_beside_another_plugin_is_built_and_loads(build_dir, installed, tmp_path):
    every = EVERY | {"CMakeLists.txt": EVERY["CMakeLists.txt"].splitlines()[-1]}
    top = f"project(edited LANGUAGES CXX)\n{FIND}add_subdirectory(flat)\nadd_subdirectory(every)\n"
    files = in_folder("flat", FLAT) | in_folder("every", every)
    project = Project(installed, tmp_path, "Ninja", top, files)
    assert project.value("cpu") == 1
    found = project.photons_found("cpu")
    assert found > 5

    # Only every other photon, by another file.
    project.edit("every/every.gather.h", "++i", "i += kStep")
    project.edit("every/every.gather.h", 'gather.h"\n', 'gather.h"\n#include "every/step.h"\n')
    project.edit("every/CMakeLists.txt", "every.gather.h", "every.gather.h HEADERS step.h")
    write_files(project.folder / "every", {"step.h": "CONST uint kStep = 2u;\n"})
    build(project.folder)
    half = project.photons_found("cpu")
    assert 0.4 * found < half < 0.6 * found  # of thousands that were found
    assert project.photons_found("vulkan") == half
    assert project.value("cpu") == 1

    # Another Lampyris is installed, whose headers are older than the plugins: only then is everything rebuilt.
    header = installed / "include/lampyris/core/plugin_abi.h"
    objects = len(list((project.folder / "build").rglob("*.o")))
    for change, again in [("", 0), ("// another\n", objects)]:
        header.write_text(header.read_text() + change)
        os.utime(header, (0, 0))
        checked("cmake", "--install", build_dir, "--prefix", installed)
        checked("cmake", project.folder / "build")  # a dry run would stop at this
        done = checked("cmake", "--build", project.folder / "build", "--", "-n")
        assert done.stdout.count("Building CXX object") == again
