// lampyris compare IMAGE REF: how far an image is from its reference.
#include "commands/command.h"
#include "commands/console.h"
#include "core/base/error.h"
#include "core/image/image_io.h"
#include "core/image/metrics.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>
#include <string>
#include <vector>

namespace lampyris {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kCompareSchema = "lampyris.compare/1";

struct CompareOptions {
    std::string image, reference, error_image;
    std::vector<int> crop;  // x0, y0, x1, y1
    bool json = false;
};

std::string flip_formula(const Comparison& comparison) {
    if (!comparison.hdr) return "LDR-FLIP, 67 pixels per degree (one of the files holds integers)";
    return fmt::format("HDR-FLIP, 67 pixels per degree, ACES, {} exposures from {:+.2f} to {:+.2f} stops",
                       comparison.flip.exposures, comparison.flip.start_exposure, comparison.flip.stop_exposure);
}

void print_table(const CompareOptions& options, const Comparison& comparison) {
    const Metrics& metrics = comparison.metrics;
    print("image      {}\nreference  {}\n", options.image, options.reference);
    print("pixels     {}x{}", comparison.width, comparison.height);
    if (!options.crop.empty()) lampyris::print(" (crop {})", fmt::join(options.crop, ","));
    print("\n\n");
    const auto row = [](const char* name, double value, const std::string& formula) {
        print("{:<16} {:>12.6g}   {}\n", name, value, formula);
    };
    for (const MetricFormula& formula : metric_formulas()) row(formula.name, metrics.*formula.value, formula.formula);
    row("FLIP", comparison.flip.mean, flip_formula(comparison));
    const auto means = [](const char* name, const std::array<double, 3>& mean) {
        print("{:<16} {:>12.6g} {:>12.6g} {:>12.6g}   R G B\n", name, mean[0], mean[1], mean[2]);
    };
    print("\n");
    means("mean", metrics.mean);
    means("reference mean", metrics.reference_mean);
    print("\nI: image, R: reference, scene-linear; means are over pixels and channels.\n");
    if (metrics.non_finite > 0)
        print("{} of {} pixels hold NaN or Inf in one of the images; they are left out of every number above.\n",
              metrics.non_finite, metrics.non_finite + metrics.pixels);
}

void print_json(const CompareOptions& options, const Comparison& comparison) {
    const Metrics& metrics = comparison.metrics;
    Json json;
    json["schema"] = kCompareSchema;
    json["image"] = options.image;
    json["reference"] = options.reference;
    json["resolution"] = {comparison.width, comparison.height};
    if (!options.crop.empty()) json["crop"] = options.crop;
    // Values that are not finite become null.
    for (const MetricFormula& formula : metric_formulas()) json[formula.key] = metrics.*formula.value;
    json["flip"] = comparison.flip.mean;
    json["flip_kind"] = comparison.hdr ? "HDR" : "LDR";
    if (comparison.hdr)
        json["flip_exposures"] = {{"start", comparison.flip.start_exposure},
                                  {"stop", comparison.flip.stop_exposure},
                                  {"count", comparison.flip.exposures}};
    json["mean"] = metrics.mean;
    json["reference_mean"] = metrics.reference_mean;
    json["non_finite"] = metrics.non_finite;
    // A file's name may hold any bytes; JSON is UTF-8.
    print_text(json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

int compare(const CompareOptions& options) {
    if (!options.error_image.empty()) check_image_output(options.error_image);
    Image image = read_image(options.image), reference = read_image(options.reference);
    reference.cut_to_window_of(image);
    image.cut_to_window_of(reference);
    Comparison comparison;
    try {
        check_same_size(image, reference);  // an error even if the crop would fit both
        if (!options.crop.empty()) {
            const PixelBounds bounds{options.crop[0], options.crop[1], options.crop[2], options.crop[3]};
            image = image.crop(bounds);
            reference = reference.crop(bounds);
        }
        comparison = compare_images(image, reference);
    } catch (const InputError& error) {
        throw InputError(
            fmt::format("cannot compare '{}' with '{}': {}", options.image, options.reference, error.what()));
    }
    if (!options.error_image.empty())
        write_png(options.error_image, comparison.width, comparison.height, error_picture(comparison));
    if (options.json)
        print_json(options, comparison);
    else
        print_table(options, comparison);
    return int(ExitCode::kDone);
}

void add_compare(CLI::App& parent, std::function<int()>& run) {
    auto options = std::make_shared<CompareOptions>();
    CLI::App* command = parent.add_subcommand("compare", "Measure how much an image differs from its reference");
    command->add_option("IMAGE", options->image, "the image (EXR, PFM, PNG, or what OpenImageIO reads)")->required();
    command->add_option("REF", options->reference, "the reference")->required();
    command->add_flag("--json", options->json, "print JSON (docs/metrics.md)");
    command->add_option("--error-image", options->error_image, "write FLIP's error map as a PNG")->type_name("E.png");
    command->add_option("--crop", options->crop, "compare only these pixels (x1 and y1 are the first outside)")
        ->delimiter(',')
        ->expected(4)
        ->type_name("x0,y0,x1,y1");
    command->callback([&run, options] { run = [options] { return compare(*options); }; });
}
REGISTER_COMMAND(add_compare);

}  // namespace
}  // namespace lampyris
