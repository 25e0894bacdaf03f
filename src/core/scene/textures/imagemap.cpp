#include "core/scene/builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace lampyris {
namespace {

const std::vector<std::string> kWraps = {"repeat", "black", "clamp", "octahedralsphere"};  // in order of kernel::WRAP_*

TexelEncoding read_encoding(TextureContext& context) {
    if (!context.reader.has("encoding")) return {};
    const std::string encoding = context.reader.get_string("encoding");
    if (encoding == "sRGB") return {TexelEncoding::Kind::kSrgb, 1.0f};
    if (encoding == "linear") return {TexelEncoding::Kind::kLinear, 1.0f};
    if (encoding.starts_with("gamma ")) {
        TexelEncoding result{TexelEncoding::Kind::kGamma, 0.0f};
        const char* first = encoding.data() + 6;
        const char* last = encoding.data() + encoding.size();
        const auto [end, code] = std::from_chars(first, last, result.gamma);
        if (code == std::errc() && end == last && result.gamma > 0.0f && result.gamma < 100.0f) return result;
    }
    context.reader.error("encoding", fmt::format("\"{}\" is no encoding", shown(encoding)),
                         "write \"sRGB\", \"linear\", or \"gamma 2.2\"");
    return {};
}

TextureProgram make(TextureContext& context) {
    ParameterReader& reader = context.reader;
    TextureProgram program = constant_program(glm::vec3(reader.get_float("scale")));
    kernel::TextureOp& op = program.ops[0];
    op.option = reader.get_bool("invert") ? 1u : 0u;
    context.read_mapping(op);

    ImageLookup lookup;
    lookup.wrap = uint32_t(std::find(kWraps.begin(), kWraps.end(), reader.get_string("wrap")) - kWraps.begin());
    const std::string filter = reader.get_string("filter");
    lookup.filtering = filter == "point" ? kernel::FILTER_POINT : kernel::FILTER_BILINEAR;
    reader.get_float("maxanisotropy");
    if (filter == "trilinear" || filter == "EWA") {
        const std::string note =
            fmt::format("imagemap filter \"{}\" is sampled as \"bilinear\": samples average over the pixel", filter);
        std::vector<std::string>& notes = context.builder.context().scene.notes;
        if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(note);
    }
    const TexelEncoding encoding = read_encoding(context);
    const std::string filename = reader.get_string("filename");
    if (filename.empty()) return constant_program(glm::vec3(0.5f));  // reported
    op.operation = kernel::TEXTURE_IMAGE;
    op.image = context.builder.request_image(
        {context.builder.context().resolve(filename), encoding, lookup, reader.location("filename")});
    return program;
}

const RegisterTexture registration(
    "imagemap", "An image from a file, of any format that OpenImageIO reads; (s, t) = (0, 0) is its lower left corner.",
    with_mapping({text("filename", "", "the file, relative to the scene's folder").needed(),
                  text("wrap", "repeat", "values beyond the image's edges").one_of(kWraps),
                  text("filter", "bilinear", "between texels; trilinear and EWA are sampled as bilinear")
                      .one_of({"point", "bilinear", "trilinear", "EWA"}),
                  real("maxanisotropy", 8.0, "of filter EWA, without effect"),
                  text("encoding", "",
                       "of integer formats: sRGB, linear, or \"gamma\" and a number; default: as the file says"),
                  real("scale", 1.0, "factor of the image's values"),
                  boolean("invert", false, "show one minus the scaled value")}),
    make);

}  // namespace
}  // namespace lampyris
