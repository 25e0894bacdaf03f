// Measures how fast scenes are read, and in how much memory: text, and a PLY mesh of ten million triangles.
// Goals: 50 MB/s of text; the mesh in 2 s more than a plain read of its file; peak memory below 3x the mesh data.
// Rates are per second of CPU time, because reading runs on one thread, and its files are in the page cache.
#include "core/scene/description.h"
#include "core/scene/ply.h"

#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <malloc.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>

using namespace lampyris;

namespace {

constexpr size_t kMegabyte = 1000000;

// A file that exists while the benchmark runs.
class TemporaryFile {
 public:
    explicit TemporaryFile(const std::string& name)
        : path_(std::filesystem::temp_directory_path() / ("lampyris-" + std::to_string(getpid()) + "-" + name)) {}
    ~TemporaryFile() { std::filesystem::remove(path_); }
    std::string path() const { return path_.string(); }
    size_t size() const { return std::filesystem::file_size(path_); }

 private:
    std::filesystem::path path_;
};

void write_number(std::string& text, float value) {
    char buffer[32];
    text.append(buffer, static_cast<size_t>(snprintf(buffer, sizeof buffer, " %.7g", static_cast<double>(value))));
}

// Triangle meshes as text, as exporters write them: positions, normals, texture coordinates, indices.
void write_mesh_scene(const std::string& path, size_t bytes, int vertices_per_mesh) {
    std::ofstream file(path, std::ios::binary);
    std::mt19937 random(1);
    std::uniform_real_distribution<float> number(-10.0f, 10.0f);
    std::string text = "WorldBegin\n";
    for (size_t written = 0; written < bytes;) {
        text += "Material \"diffuse\" \"rgb reflectance\" [ 0.5 0.4 0.3 ]\nShape \"trianglemesh\"\n    \"point3 P\" [";
        for (int i = 0; i < 3 * vertices_per_mesh; ++i) write_number(text, number(random));
        text += " ]\n    \"normal N\" [";
        for (int i = 0; i < 3 * vertices_per_mesh; ++i) write_number(text, number(random));
        text += " ]\n    \"point2 uv\" [";
        for (int i = 0; i < 2 * vertices_per_mesh; ++i) write_number(text, number(random));
        text += " ]\n    \"integer indices\" [";
        for (int i = 0; i < 6 * vertices_per_mesh; ++i)
            text += " " + std::to_string(random() % static_cast<unsigned>(vertices_per_mesh));
        text += " ]\n";
        file << text;
        written += text.size();
        text.clear();
    }
}

size_t bytes_of(const SceneDescription& scene) {
    size_t bytes = 0;
    for (const ShapeDescription& shape : scene.shapes)
        for (const Parameter& parameter : shape.parameters.parameters) {
            if (const auto* f = std::get_if<std::vector<float>>(&parameter.values)) bytes += f->size() * sizeof(float);
            if (const auto* i = std::get_if<std::vector<int32_t>>(&parameter.values))
                bytes += i->size() * sizeof(int32_t);
        }
    return bytes;
}

size_t bytes_of(const PlyMesh& mesh) {
    return sizeof(float) * (mesh.positions.size() + mesh.normals.size() + mesh.uvs.size()) +
           sizeof(uint32_t) * (mesh.triangles.size() + mesh.quads.size());
}

SceneDescription parse(const std::string& path) {
    auto sources = std::make_shared<Sources>();
    Diagnostics diagnostics(*sources);
    SceneDescription scene = parse_scene_file(path, sources, diagnostics);
    diagnostics.throw_if_errors();
    return scene;
}

// The peak of resident memory that `work` adds, mapped files included; measured in a process of its own.
double peak_bytes(const std::function<void()>& work) {
    const auto peak_of_child = [](const std::function<void()>& job) {
        const pid_t child = fork();
        if (child == 0) {
            job();
            _exit(0);
        }
        rusage usage{};
        int status = 0;
        wait4(child, &status, 0, &usage);
        if (child < 0 || status != 0) std::abort();
        return 1024.0 * static_cast<double>(usage.ru_maxrss);
    };
    malloc_trim(0);  // or the child would reuse memory that this process has freed, and seem to need none
    return peak_of_child(work) - peak_of_child([] {});
}

void parse_text(benchmark::State& state) {
    const TemporaryFile file("text.pbrt");
    write_mesh_scene(file.path(), static_cast<size_t>(state.range(0)) * kMegabyte, static_cast<int>(state.range(1)));
    size_t mesh_bytes = 0;
    for (auto _ : state) mesh_bytes = bytes_of(parse(file.path()));
    state.counters["MB/s"] =
        benchmark::Counter(static_cast<double>(file.size()) / kMegabyte, benchmark::Counter::kIsIterationInvariantRate);
    state.counters["peak/mesh"] = peak_bytes([&] { parse(file.path()); }) / static_cast<double>(mesh_bytes);
}
// Large meshes, and many small ones.
BENCHMARK(parse_text)->Args({128, 200000})->Args({64, 8})->Unit(benchmark::kMillisecond);

// A square grid of 2236 x 2236 vertices: ten million triangles.
void write_grid(const std::string& path) {
    constexpr uint32_t kSide = 2237;
    std::ofstream file(path, std::ios::binary);
    file << "ply\nformat binary_little_endian 1.0\nelement vertex " << kSide * kSide
         << "\nproperty float x\nproperty float y\nproperty float z\nelement face " << 2 * (kSide - 1) * (kSide - 1)
         << "\nproperty list uchar int vertex_indices\nend_header\n";
    std::string row;
    for (uint32_t y = 0; y < kSide; ++y) {
        row.clear();
        for (uint32_t x = 0; x < kSide; ++x) {
            const float p[3] = {static_cast<float>(x), static_cast<float>(y), static_cast<float>(x * y % 97)};
            row.append(reinterpret_cast<const char*>(p), sizeof p);
        }
        file << row;
    }
    for (uint32_t y = 0; y + 1 < kSide; ++y) {
        row.clear();
        for (uint32_t x = 0; x + 1 < kSide; ++x) {
            const uint32_t a = y * kSide + x;
            for (const auto& face : {std::array<uint32_t, 3>{a, a + 1, a + kSide}, {a + 1, a + kSide + 1, a + kSide}}) {
                row += '\3';
                row.append(reinterpret_cast<const char*>(face.data()), sizeof face);
            }
        }
        file << row;
    }
}

void read_plainly(const std::string& path, size_t size) {
    std::vector<char> bytes(size);
    const int descriptor = open(path.c_str(), O_RDONLY);
    size_t done = 0;
    while (done < size) {
        const ssize_t got = read(descriptor, bytes.data() + done, size - done);
        if (got <= 0) std::abort();
        done += static_cast<size_t>(got);
    }
    close(descriptor);
    benchmark::DoNotOptimize(bytes.data());
}

void ply_ten_million_triangles(benchmark::State& state) {
    const TemporaryFile file("grid.ply");
    write_grid(file.path());
    const size_t size = file.size();
    double reading = 0.0;
    size_t mesh_bytes = 0;
    for (auto _ : state) {
        mesh_bytes = bytes_of(read_ply(file.path()));
        state.PauseTiming();
        const auto start = std::chrono::steady_clock::now();
        read_plainly(file.path(), size);
        reading += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        state.ResumeTiming();
    }
    state.counters["plain_read_s"] = benchmark::Counter(reading, benchmark::Counter::kAvgIterations);
    state.counters["peak/mesh"] = peak_bytes([&] { read_ply(file.path()); }) / static_cast<double>(mesh_bytes);
}
BENCHMARK(ply_ten_million_triangles)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
