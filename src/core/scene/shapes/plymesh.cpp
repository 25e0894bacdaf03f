// Shape "plymesh": a mesh from a PLY file.
#include "core/base/file.h"
#include "core/scene/ply.h"
#include "core/scene/shapes/mesh.h"

#include <fmt/format.h>

#include <filesystem>

namespace lampyris {

namespace {

void build(ShapeContext& context) {
    ParameterReader& reader = context.reader;
    const std::string filename = reader.get_string("filename");
    for (const char* name : {"displacement", "edgelength"}) {
        if (!reader.find(name)) continue;
        if (std::string_view(name) == "displacement")
            context.build.diagnostics.unsupported(reader.location(name), "displacement of a mesh",
                                                  "without it, the mesh is as in the file");
    }
    if (filename.empty()) return;  // reported
    const std::string path = context.build.resolve(filename);
    if (const std::string why = context.build.description.folder.why_refused(path); !why.empty()) {
        reader.error("filename", fmt::format("the mesh {} is not read: {}", shown(filename), why));
        return;
    }
    std::error_code code;
    if (!std::filesystem::is_regular_file(path, code)) {
        reader.error("filename",
                     fmt::format("there is no file {}{}", shown(path),
                                 context.build.diagnostics.guess(std::filesystem::path(path).filename().string(),
                                                                 [&] { return files_beside(path); })));
        return;
    }
    PlyMesh ply;
    try {
        ply = read_ply(path);
    } catch (const InputError& error) {
        reader.error("filename", fmt::format("the mesh {} cannot be read:\n{}", shown(filename), error.what()));
        return;
    }
    if (ply.skipped_faces > 0)
        context.build.diagnostics.warning(
            reader.location("filename"),
            fmt::format("{} faces of {} have neither three nor four vertices and are left out", ply.skipped_faces,
                        shown(filename)));
    if (ply.triangles.empty() && ply.quads.empty())
        context.build.diagnostics.warning(reader.location("filename"),
                                          fmt::format("the mesh {} has no faces", shown(filename)));
    // Quads become bilinear patches beside the triangles, as in pbrt-v4. If there are both, each kind gets vertices of its own.
    Mesh quads;
    const bool has_triangles = !ply.triangles.empty();
    if (!ply.quads.empty()) {
        quads.corners = 4;
        quads.indices = std::move(ply.quads);
        if (!has_triangles) {
            quads.positions = std::move(ply.positions), quads.normals = std::move(ply.normals),
            quads.uvs = std::move(ply.uvs);
        } else {
            quads.positions = ply.positions, quads.normals = ply.normals, quads.uvs = ply.uvs;
        }
    }
    if (has_triangles) {
        Mesh triangles;
        triangles.indices = std::move(ply.triangles);
        triangles.positions = std::move(ply.positions), triangles.normals = std::move(ply.normals),
        triangles.uvs = std::move(ply.uvs);
        if (check_mesh(context, triangles)) add_mesh(context, std::move(triangles));
    }
    if (!quads.indices.empty() && check_mesh(context, quads)) add_mesh(context, std::move(quads));
}

ParameterSpecs specs() {
    return {
        text("filename", "", "a PLY file: ascii or binary, gzip'd or not").needed(),
        value("displacement", ParameterType::kTexture, "none", "moves the surface (not supported)"),
        real("edgelength", 1.0, "of displaced triangles; has no effect").above(0),
    };
}

const RegisterShape plymesh("plymesh", "A mesh from a PLY file: triangles, and quads as bilinear patches.", specs(),
                            build);

}  // namespace

}  // namespace lampyris
