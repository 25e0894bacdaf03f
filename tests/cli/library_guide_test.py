"""docs/library.md, followed to the letter: its program and its snippets are built outside the tree against an installed
Lampyris, and run."""

import re

import pytest

from support.plugin_project import build, checked, configure, write_files
from support.render_program import SCENE

SNIPPETS_CMAKE = """cmake_minimum_required(VERSION 3.25)
project(snippets LANGUAGES CXX)
find_package(Lampyris REQUIRED)
add_executable(snippets snippets.cpp)
target_link_libraries(snippets PRIVATE Lampyris::lampyris)
"""
# Each snippet is a function's body; those that do not make a request of their own get this one.
SNIPPETS_HEAD = """#include "core/base/error.h"
#include "core/image/image_io.h"
#include "core/render/render.h"

#include <cstdio>
#include <string>

using namespace lampyris;

RenderRequest some_request() {
    RenderRequest request;
    request.scene = SceneSource::of_file("sphere.pbrt");
    return request;
}
"""


def guide(source_dir):
    return (source_dir / "docs/library.md").read_text()


def guide_files(text):
    """The blocks that the guide announces with "`first_image/NAME`:"."""
    return dict(re.findall(r"^`first_image/([^`]+)`:\n\n```\w+\n(.*?)^```$", text, flags=re.MULTILINE | re.DOTALL))


def snippets(text):
    """The other blocks of C++."""
    blocks = re.findall(r"^```cpp\n(.*?)^```$", text, flags=re.MULTILINE | re.DOTALL)
    return [block for block in blocks if "int main()" not in block]


def snippets_program(bodies):
    functions, calls = "", ""
    for number, body in enumerate(bodies):
        given = "" if body.startswith("RenderRequest request;") else "    RenderRequest request = some_request();\n"
        functions += f"\nvoid snippet_{number}() {{\n{given}{body}}}\n"
        calls += f"    snippet_{number}();\n"
    return f"{SNIPPETS_HEAD}{functions}\nint main() {{\n{calls}}}\n"


def test_the_guide_shows_the_example(source_dir):
    files = guide_files(guide(source_dir))
    example = source_dir / "examples/first_image"
    assert set(files) == {path.name for path in example.iterdir() if path.name != "README.md"}
    for name, text in files.items():
        assert text == (example / name).read_text(), f"docs/library.md and examples/first_image/{name} differ"
    assert len(files["first_image.cpp"].splitlines()) <= 32


@pytest.fixture(scope="module")
def outside(source_dir, installed, tmp_path_factory):
    """Both programs, built with nothing of this tree but the guide."""
    folder = tmp_path_factory.mktemp("outside")
    text = guide(source_dir)
    write_files(folder / "first_image", guide_files(text))
    program = snippets_program(snippets(text))
    write_files(folder / "snippets", {"CMakeLists.txt": SNIPPETS_CMAKE, "snippets.cpp": program})
    for name in ["first_image", "snippets"]:
        configure(folder / name, installed, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_CXX_FLAGS=-Wall")
        build(folder / name)
    (folder / "sphere.pbrt").write_text(SCENE)
    return folder


def test_the_example_shows_a_sphere(outside):
    lines = checked(outside / "first_image/build/first_image", cwd=outside).stdout.splitlines()
    *picture, summary = lines
    assert [len(line) for line in picture] == [64] * 28
    assert picture[0].strip() == picture[-1].strip() == ""  # nothing around it
    lit = [x for line in picture for x, shade in enumerate(line) if shade != " "]
    assert len(lit) > 300
    assert sum(lit) / len(lit) < 32  # the lamp is on the left
    assert re.fullmatch(r"\d+ rays, estimated relMSE \S+", summary)


def test_the_snippets_run(source_dir, outside):
    assert len(snippets(guide(source_dir))) == 5
    said = checked(outside / "snippets/build/snippets", cwd=outside).stdout
    assert (outside / "sphere.exr").stat().st_size > 1000
    shown = re.search(r"with its location:\n\n```\n(.*?)\n```", guide(source_dir), flags=re.DOTALL).group(1)
    assert shown in said
    passes = re.search(r"^(\d+) passes$", said, flags=re.MULTILINE)
    assert passes, said
    assert 8 <= int(passes.group(1)) < 100000
