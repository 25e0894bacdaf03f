"""Folders of src/ include those below them only."""

import re

# Each folder, and what it may include besides itself: docs/decisions/tree.md.
LAYERS = {
    "core/base": set(),
    "core/kernel": {"materials"},  # the dispatch, which the build writes
    "core/device": {"core/base", "core/kernel"},
    "core/image": {"core/base"},
    "formats": {"core/base", "core/image"},
    "core/photons": {"core/base", "core/kernel", "core/device"},
    "core/scene": {"core/base", "core/kernel", "core/device", "core/image"},
    "core/render": {"core/base", "core/kernel", "core/device", "core/image", "core/photons", "core/scene"},
    "accel/rays": {"core/base", "core/kernel", "core/device", "core/scene"},
    "accel/photons": {"core/base", "core/kernel", "core/device", "core/photons"},
    "materials": {"core/base", "core/kernel", "core/device", "core/scene"},
    "integrators": {
        "core/base",
        "core/kernel",
        "core/device",
        "core/image",
        "core/photons",
        "core/scene",
        "core/render",
    },
    "backends/shaders": {"core/base", "core/device"},
    "backends/cpu": {"core/base", "core/kernel", "core/device", "core/scene", "accel/rays"},
    "backends/vectors": {"core/base", "core/device", "accel/rays", "backends/cpu", "backends/shaders"},
    "backends/vulkan": {"core/base", "core/kernel", "core/device", "core/scene", "accel/rays", "backends/shaders"},
}
# Written by the build, below a folder of their own.
GENERATED = {"core/plugin_abi.h", "backends/vectors/version.h"}
INCLUDE = re.compile(r'^#include "([^"]+)"', re.MULTILINE)


def layer_of(name: str) -> str:
    """The folder of a file, at the depth of LAYERS."""
    parts = name.split("/")
    return "/".join(parts[:2]) if parts[0] in ("core", "accel", "backends") else parts[0]


def upward_includes(source: dict[str, str]) -> list[str]:
    """Includes that LAYERS does not allow, among files given by their names below src/."""
    found = []
    for name, text in source.items():
        layer = layer_of(name)
        allowed = LAYERS.get(layer)
        for included in INCLUDE.findall(text):
            target = layer_of(included)
            if included not in GENERATED and allowed is not None and target != layer and target not in allowed:
                found.append(f"{name} includes {included}")
    return found


def test_no_folder_includes_one_above_it(source_dir):
    root = source_dir / "src"
    files = [path for path in root.rglob("*") if path.suffix in (".h", ".cpp", ".glsl", ".in")]
    source = {str(path.relative_to(root)): path.read_text() for path in files}
    unknown = {layer_of(name) for name in source} - set(LAYERS) - {"commands"}
    assert not unknown, f"folders that LAYERS does not have: {sorted(unknown)}"
    assert not upward_includes(source)


def test_an_upward_include_is_found():
    assert upward_includes({"core/scene/a.cpp": '#include "core/render/film.h"\n'})
    assert not upward_includes({"core/render/a.cpp": '#include "core/scene/scene.h"\n'})
