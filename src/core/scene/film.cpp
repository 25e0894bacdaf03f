// Film "rgb" and "gbuffer": resolution, crop, exposure.
#include "core/scene/film.h"

#include "core/scene/limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>

namespace lampyris {

namespace {

using Rectangle = std::array<int, 4>;  // x0 y0 x1 y1, half-open

// The four numbers x0 x1 y0 y1 of a parameter, each pair sorted. Empty if the parameter is absent or wrong: a wrong type is an
// error; a wrong count is a warning, since pbrt-v4 then ignores the parameter.
template <typename T>
std::optional<std::array<T, 4>> read_bounds(ParameterReader& reader, const char* name, const char* hint) {
    const Parameter* parameter = reader.find(name);
    if (!parameter) return {};
    const auto* numbers = std::get_if<std::vector<T>>(&parameter->values);
    constexpr ParameterType kType = std::is_same_v<T, float> ? ParameterType::kFloat : ParameterType::kInteger;
    if (!numbers || parameter->type != kType) {
        reader.error(name, fmt::format("\"{}\" is of type {}", name, type_name(parameter->type)), hint);
        return {};
    }
    if (numbers->size() != 4) {
        reader.warning(name,
                       fmt::format("\"{}\" has {} numbers, not 4: it is ignored, as in pbrt-v4", name, numbers->size()),
                       hint);
        return {};
    }
    std::array<T, 4> bounds{(*numbers)[0], (*numbers)[1], (*numbers)[2], (*numbers)[3]};
    if (bounds[0] > bounds[1]) std::swap(bounds[0], bounds[1]);
    if (bounds[2] > bounds[3]) std::swap(bounds[2], bounds[3]);
    return bounds;
}

// As in pbrt-v4 (film.cpp, FilmBaseParameters): the bounds are clipped to the picture, and the crop window wins if both
// parameters are given.
void read_rectangle(FilmContext& film, std::array<int, 2> size, Rectangle& crop) {
    ParameterReader& reader = film.reader;
    const auto bounds = read_bounds<int32_t>(reader, "pixelbounds", "x0 x1 y0 y1");
    const auto window = read_bounds<float>(reader, "cropwindow", "x0 x1 y0 y1, each between 0 and 1");
    if (bounds) {
        crop = {std::max((*bounds)[0], 0), std::max((*bounds)[2], 0), std::min((*bounds)[1], size[0]),
                std::min((*bounds)[3], size[1])};
        if (crop != Rectangle{(*bounds)[0], (*bounds)[2], (*bounds)[1], (*bounds)[3]} && crop[0] < crop[2] &&
            crop[1] < crop[3])
            reader.warning("pixelbounds", fmt::format("\"pixelbounds\" reach out of the {}x{} picture and are cut off",
                                                      size[0], size[1]));
    }
    if (window) {
        if (bounds)
            reader.warning("cropwindow", "both \"cropwindow\" and \"pixelbounds\" are given: the crop window is used");
        // Both ends are rounded up.
        const auto pixel = [](float share, int side) {
            return int(std::ceil(float(side) * std::fmin(std::fmax(share, 0.0f), 1.0f)));
        };
        crop = {pixel((*window)[0], size[0]), pixel((*window)[2], size[1]), pixel((*window)[1], size[0]),
                pixel((*window)[3], size[1])};
    }
}

void build_film(FilmContext& film) {
    ParameterReader& reader = film.reader;
    BuildContext& build = film.build;
    std::array<int, 2> size{reader.get_int("xresolution"), reader.get_int("yresolution")};
    Rectangle crop{0, 0, size[0], size[1]};
    read_rectangle(film, size, crop);
    const Location where = reader.location(reader.has("cropwindow") ? "cropwindow" : "pixelbounds");
    if (build.options.resolution) {
        // The crop window keeps its place in the picture.
        const auto moved = [&](int at, int axis) {
            return int(std::lround(double(at) * (*build.options.resolution)[size_t(axis)] / size[size_t(axis)]));
        };
        crop = {moved(crop[0], 0), moved(crop[1], 1), moved(crop[2], 0), moved(crop[3], 1)};
        size = *build.options.resolution;
    }
    if (build.options.crop) crop = *build.options.crop;
    if (crop[0] < 0 || crop[1] < 0 || crop[2] > size[0] || crop[3] > size[1] || crop[0] >= crop[2] ||
        crop[1] >= crop[3]) {
        const std::string message = fmt::format("the pixels {},{} to {},{} are not a part of the {}x{} picture",
                                                crop[0], crop[1], crop[2], crop[3], size[0], size[1]);
        if (build.options.crop) throw InputError("error: --crop: " + message);
        build.diagnostics.error(where, message, "the window must not be empty, nor larger than the picture");
        crop = {0, 0, size[0], size[1]};
    }
    film.record.resolution_x = uint32_t(size[0]);
    film.record.resolution_y = uint32_t(size[1]);
    film.record.crop_x = uint32_t(crop[0]);
    film.record.crop_y = uint32_t(crop[1]);
    build.settings.crop = crop;
    build.settings.output = reader.get_string("filename");
    build.settings.save_half = reader.get_bool("savefp16");
    reader.get_float("diagonal");  // used by realistic cameras only

    // pbrt-v4: a sensor's values are light times exposure time times ISO / 100, then clamped per sample.
    Entity& camera = build.description.camera;
    Diagnostics quiet(*build.description.sources);  // the camera's own factory reports errors in these
    const float open = camera.parameters.get_float("shutteropen", 0.0f, quiet),
                close = camera.parameters.get_float("shutterclose", 1.0f, quiet);
    const float exposure = reader.has("exposuretime") ? reader.get_float("exposuretime") : std::abs(close - open);
    film.record.imaging_ratio = exposure > 0.0f ? exposure * reader.get_float("iso") / 100.0f : 1.0f;
    const float largest = reader.get_float("maxcomponentvalue");
    film.record.max_component = std::isfinite(largest) && largest < 3e38f ? largest : 0.0f;
    const std::string sensor = reader.get_string("sensor");
    if (sensor != "cie1931")
        build.diagnostics.unsupported(reader.location("sensor"), fmt::format("sensor \"{}\"", sensor),
                                      "--skip-unsupported renders with \"cie1931\" instead");
    if (reader.get_float("whitebalance") != 0.0f)
        build.diagnostics.unsupported(reader.location("whitebalance"), "white balance",
                                      "--skip-unsupported renders with a whitebalance of 0");
    if (build.description.color_space != "srgb")
        build.scene.notes.push_back(fmt::format("ColorSpace \"{}\": images are still written in linear Rec.709",
                                                build.description.color_space));
}

void build_gbuffer(FilmContext& film) {
    build_film(film);
    film.reader.get_string("coordinatesystem");
    film.build.scene.notes.push_back("Film \"gbuffer\" gives the channels that every EXR of Lampyris has");
}

ParameterSpecs film_specs() {
    constexpr double kLargest = double(std::numeric_limits<float>::infinity());
    return {
        integer("xresolution", 1280, "width of the picture").between(1, kLargestSide).in("pixels"),
        integer("yresolution", 720, "height of the picture").between(1, kLargestSide).in("pixels"),
        values("cropwindow", ParameterType::kFloat, "0 1 0 1", "part to render: x0 x1 y0 y1, shares of the picture"),
        values("pixelbounds", ParameterType::kInteger, "all", "part to render: x0 x1 y0 y1").in("pixels"),
        text("filename", "", "image file, unless the command line names one"),
        boolean("savefp16", true, "EXR files hold half floats"),
        real("diagonal", 35.0, "of the sensor; has no effect on the cameras here").above(0).in("mm"),
        text("sensor", "cie1931", "spectral response; only cie1931 is known"),
        real("iso", 100.0, "sensitivity: the image is multiplied by iso / 100").above(0),
        real("exposuretime", 1.0, "the image is multiplied by it; default: the camera's shutterclose - shutteropen")
            .above(0)
            .in("s"),
        real("whitebalance", 0.0, "colour temperature that becomes white; 0: none").at_least(0).in("K"),
        real("maxcomponentvalue", kLargest, "a sample's components are scaled down to at most this").above(0),
    };
}

ParameterSpecs gbuffer_specs() {
    ParameterSpecs specs = film_specs();
    specs.push_back(text("coordinatesystem", "camera", "of normals and positions; here they are in world space")
                        .one_of({"camera", "world"}));
    return specs;
}

const RegisterFilm rgb("rgb", "Linear Rec.709 colour.", film_specs(), build_film);
const RegisterFilm gbuffer("gbuffer", "The same as rgb: every EXR can hold albedo, normals and depth.", gbuffer_specs(),
                           build_gbuffer);

}  // namespace

}  // namespace lampyris
