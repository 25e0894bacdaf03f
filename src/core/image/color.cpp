#include "core/image/color.h"

#include "core/base/error.h"
#include "core/image/color_config.h"

#include <fmt/format.h>
#include <OpenColorIO/OpenColorIO.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace lampyris {
namespace {

namespace OCIO = OCIO_NAMESPACE;

const OCIO::ConstConfigRcPtr& config() {
    static const OCIO::ConstConfigRcPtr built_in = [] {
        std::istringstream text(kColorConfig);
        OCIO::ConstConfigRcPtr result = OCIO::Config::CreateFromStream(text);
        result->validate();
        return result;
    }();
    return built_in;
}

OCIO::ConstCPUProcessorRcPtr processor_of(const std::string& view) {
    auto transform = OCIO::DisplayViewTransform::Create();
    transform->setSrc(OCIO::ROLE_SCENE_LINEAR);
    transform->setDisplay(config()->getDefaultDisplay());
    transform->setView(view.c_str());
    transform->setDataBypass(false);
    // Lossless: by default, OpenColorIO trades accuracy of exponents for speed, and sometimes the difference is visible in 8
    // bits.
    return config()->getProcessor(transform)->getOptimizedCPUProcessor(OCIO::OPTIMIZATION_LOSSLESS);
}

}  // namespace

const std::vector<View>& views() {
    static const std::vector<View> list = [] {
        std::vector<View> result;
        const char* display = config()->getDefaultDisplay();
        for (int i = 0; i < config()->getNumViews(display); ++i) {
            const char* name = config()->getView(display, i);
            const auto space = config()->getColorSpace(config()->getDisplayViewColorSpaceName(display, name));
            result.push_back({name, space ? space->getDescription() : ""});
        }
        return result;
    }();
    return list;
}

std::vector<std::string> view_names() {
    std::vector<std::string> names;
    for (const View& view : views()) names.push_back(view.name);
    return names;
}

void check_view(const std::string& view) {
    const std::vector<std::string> names = view_names();
    if (std::find(names.begin(), names.end(), view) == names.end())
        throw InputError(
            fmt::format("there is no view '{}'{}; the views are {}", view, did_you_mean(view, names), list_of(names)));
}

void apply_view(Image& rgb, const std::string& view, float exposure) {
    check_view(view);
    if (rgb.channels != 3) throw InputError(fmt::format("a view needs three channels, not {}", rgb.channels));
    const float scale = std::exp2(exposure);
    for (float& value : rgb.pixels) {
        value *= scale;
        if (std::isnan(value)) value = 0.0f;
        // The largest finite number replaces infinity: it is white in every view, whereas Inf would turn into NaN inside some.
        value = std::clamp(value, -65504.0f, 65504.0f);
    }
    try {
        OCIO::PackedImageDesc description(rgb.pixels.data(), rgb.width, rgb.height, 3);
        processor_of(view)->apply(description);
    } catch (const OCIO::Exception& error) {
        throw MachineError(fmt::format("OpenColorIO cannot apply the view '{}': {}", view, error.what()));
    }
    for (float& value : rgb.pixels) value = std::isnan(value) ? 0.0f : std::clamp(value, 0.0f, 1.0f);
}

std::vector<uint8_t> display_bytes(const Image& rgb, const std::string& view, float exposure) {
    Image shown = rgb;
    apply_view(shown, view, exposure);
    std::vector<uint8_t> bytes(shown.pixels.size());
    std::transform(shown.pixels.begin(), shown.pixels.end(), bytes.begin(),
                   [](float value) { return uint8_t(std::lround(value * 255.0f)); });
    return bytes;
}

}  // namespace lampyris
