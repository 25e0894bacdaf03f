"""Builds plugins outside of the tree, against an installed Lampyris."""

import re
import subprocess

# A photon map that tests every photon.
EVERY = {
    "CMakeLists.txt": """cmake_minimum_required(VERSION 3.25)
project(every LANGUAGES CXX)
find_package(Lampyris REQUIRED)
lampyris_add_plugin(every SOURCES every.cpp GATHERS every.gather.h)
""",
    "every.gather.h": """// Tests every photon.
#include "core/kernel/gather.h"

BUFFER_RO(1, uvec4, arguments)
BUFFER_RO(2, PhotonRecord, photons)

KERNEL(every) {
    vec4 q = queries[index];
    if (q.w < 0.0f) return;
    Gathered gathered = gather_begin(index);
    for (uint i = 0u; i < arguments[0].x; ++i) {
        float d2;
        if (in_range(photon_position(photons[i]), vec3(q), q.w, d2)) gather_add(gathered, index, photons[i], d2, 1.0f);
    }
    gather_end(gathered, index);
}
""",
    "every.cpp": """#include "core/photons/photon_map.h"

namespace {

struct EveryParams {};
#define EVERY_PARAMS(P)

class Every : public lampyris::PhotonMap {
 public:
    EveryParams params;
    lampyris::PhotonMapCapabilities capabilities() const override { return {.exact = true}; }

 protected:
    std::vector<std::string> kernels() const override { return {}; }
    void construct(const lampyris::PhotonSet& photons) override {
        upload("arguments", glm::uvec4(photons.count, 0, 0, 0));
    }
};

REGISTER_PHOTON_MAP(Every, EVERY_PARAMS, "every", "Tests every photon.")

}  // namespace
""",
}


def run(*command, **options):
    return subprocess.run(
        [str(word) for word in command], capture_output=True, text=True, timeout=600, check=False, **options
    )


def checked(*command, **options):
    done = run(*command, **options)
    assert done.returncode == 0, f"{done.args}\n{done.stdout}{done.stderr}"
    return done


def write_files(folder, files):
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


# Kernels in one version in place of one for each set of effects, and not optimised: builds take a fraction of the time.
QUICK = ("-DCMAKE_BUILD_TYPE=Debug", "-DLAMPYRIS_SPECIALISED_KERNELS=OFF")


def configure(folder, installed, *options):
    """Configures `folder`, whose build goes to its subfolder `build`."""
    checked("cmake", "-S", folder, "-B", folder / "build", f"-DCMAKE_PREFIX_PATH={installed}", *options)


def build(folder):
    checked("cmake", "--build", folder / "build")


def guide_files(source_dir, page, folder):
    """The code blocks that a guide in docs/ announces with "`FOLDER/NAME`:", by name."""
    text = (source_dir / "docs" / page).read_text()
    return dict(re.findall(rf"^`{folder}/([^`]+)`:\n\n```\w+\n(.*?)^```$", text, flags=re.MULTILINE | re.DOTALL))


def check_example(source_dir, page, folder):
    """The guide shows what examples/FOLDER has."""
    files = guide_files(source_dir, page, folder)
    example = source_dir / "examples" / folder
    assert set(files) == {path.name for path in example.iterdir() if path.name != "README.md"}
    for name, text in files.items():
        assert text == (example / name).read_text(), f"docs/{page} and examples/{folder}/{name} differ"
