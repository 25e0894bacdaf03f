"""A photon map of one's own, built outside of the tree against an installed Lampyris: it meets the consumers that
Lampyris has, on both backends."""

import json
import subprocess

import pytest

FILES = {
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
    "every.cpp": """#include "core/photon_map.h"

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
    std::vector<lampyris::BufferHandle> gather_buffers() const override {
        return {kept("arguments"), photons_.photons};
    }
};

REGISTER_PHOTON_MAP(Every, EVERY_PARAMS, "every", "Tests every photon.")

}  // namespace
""",
}


def checked(*command, **options):
    done = subprocess.run(
        [str(word) for word in command], capture_output=True, text=True, timeout=600, check=False, **options
    )
    assert done.returncode == 0, f"{done.args}\n{done.stdout}{done.stderr}"
    return done


@pytest.fixture(scope="module")
def outside(build_dir, tmp_path_factory):
    folder = tmp_path_factory.mktemp("outside")
    checked("cmake", "--install", build_dir, "--prefix", folder / "lampyris")
    (folder / "every").mkdir()
    for name, text in FILES.items():
        (folder / "every" / name).write_text(text)
    options = ["-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", f"-DCMAKE_PREFIX_PATH={folder / 'lampyris'}"]
    checked("cmake", "-S", "every", "-B", "every/build", *options, cwd=folder)
    checked("cmake", "--build", "every/build", cwd=folder)
    return folder


def test_a_photon_map_from_outside_finds_the_same_photons(outside):
    program = outside / "lampyris/bin/lampyris"
    arguments = [
        "--structures",
        "every,sorted_grid",
        "--points",
        "2000",
        "--queries",
        "500",
        "--seconds",
        "0",
        "--json",
    ]
    for backend in ["cpu", "vulkan"]:
        done = checked(
            program,
            "bench",
            "photon-maps",
            "--plugin",
            outside / "every/build/every.so",
            "--backend",
            backend,
            *arguments,
        )
        every, sorted_grid = json.loads(done.stdout)["rows"]
        assert every["structure"] == "every"
        assert every["photons_found_mean"] == sorted_grid["photons_found_mean"] > 5
