#include "core/image/flip.h"

#include "core/base/error.h"

#include <fmt/format.h>
#include <glm/glm.hpp>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace lampyris {
namespace {

using Plane = std::vector<float>;  // [height][width]
using Taps = std::vector<float>;   // an odd number of weights around the middle one

struct Size {
    int width, height;
    size_t count() const { return size_t(width) * size_t(height); }
};

// Every row is computed by one thread and depends on its inputs alone: the result does not depend on the number of
// threads.
void for_rows(int height, const std::function<void(int)>& row) {
    tbb::parallel_for(tbb::blocked_range<int>(0, height, 8), [&](const tbb::blocked_range<int>& rows) {
        for (int y = rows.begin(); y < rows.end(); ++y) row(y);
    });
}

// Correlates along x; outside the image the border pixels repeat.
Plane filter_x(const Plane& in, Size size, const Taps& taps) {
    const int radius = int(taps.size() / 2);
    Plane out(size.count());
    for_rows(size.height, [&](int y) {
        const float* row = in.data() + size_t(y) * size_t(size.width);
        std::vector<float> padded(size_t(size.width + 2 * radius));
        for (int x = 0; x < int(padded.size()); ++x) padded[size_t(x)] = row[std::clamp(x - radius, 0, size.width - 1)];
        float* to = out.data() + size_t(y) * size_t(size.width);
        for (size_t k = 0; k < taps.size(); ++k)
            for (int x = 0; x < size.width; ++x) to[x] += taps[k] * padded[size_t(x) + k];
    });
    return out;
}

Plane filter_y(const Plane& in, Size size, const Taps& taps) {
    const int radius = int(taps.size() / 2);
    Plane out(size.count());
    for_rows(size.height, [&](int y) {
        float* to = out.data() + size_t(y) * size_t(size.width);
        for (int k = 0; k < int(taps.size()); ++k) {
            const float* from = in.data() + size_t(std::clamp(y + k - radius, 0, size.height - 1)) * size_t(size.width);
            for (int x = 0; x < size.width; ++x) to[x] += taps[size_t(k)] * from[x];
        }
    });
    return out;
}

// Linear Rec.709 to XYZ, as rationals in the authors' supplement; white is its image of (1, 1, 1), so that Y = 1.
const glm::dmat3 kXyzFromRgb =
    glm::transpose(glm::dmat3(10135552.0 / 24577794.0, 8788810.0 / 24577794.0, 4435075.0 / 24577794.0,  //
                              2613072.0 / 12288897.0, 8788810.0 / 12288897.0, 887015.0 / 12288897.0,    //
                              1425312.0 / 73733382.0, 8788810.0 / 73733382.0, 70074185.0 / 73733382.0));

struct ColorSpaces {
    glm::mat3 white_relative_xyz_from_rgb, rgb_from_white_relative_xyz;
    ColorSpaces() {
        const glm::dvec3 white = kXyzFromRgb * glm::dvec3(1.0);
        glm::dmat3 scale(0.0);
        for (int i = 0; i < 3; ++i) scale[i][i] = 1.0 / white[i];
        white_relative_xyz_from_rgb = glm::mat3(scale * kXyzFromRgb);
        rgb_from_white_relative_xyz = glm::mat3(glm::inverse(scale * kXyzFromRgb));
    }
};
const ColorSpaces kSpaces;

// YCxCz, a linear opponent space (HPG 2020, section 4.1): luminance, red-green and blue-yellow.
glm::vec3 ycc_from_rgb(glm::vec3 rgb) {
    const glm::vec3 xyz = kSpaces.white_relative_xyz_from_rgb * rgb;
    return {116.0f * xyz.y - 16.0f, 500.0f * (xyz.x - xyz.y), 200.0f * (xyz.y - xyz.z)};
}

glm::vec3 rgb_from_ycc(glm::vec3 ycc) {
    const float y = (ycc.x + 16.0f) / 116.0f;
    return kSpaces.rgb_from_white_relative_xyz * glm::vec3(y + ycc.y / 500.0f, y, y - ycc.z / 200.0f);
}

// CIELAB with the chroma scaled by lightness (Hunt's effect; HPG 2020, section 4.1).
glm::vec3 hunt_lab_from_rgb(glm::vec3 rgb) {
    constexpr float kDelta = 6.0f / 29.0f;
    const glm::vec3 xyz = kSpaces.white_relative_xyz_from_rgb * rgb;
    glm::vec3 f;
    for (int i = 0; i < 3; ++i)
        f[i] = xyz[i] > kDelta * kDelta * kDelta ? std::cbrt(xyz[i]) : xyz[i] / (3.0f * kDelta * kDelta) + 4.0f / 29.0f;
    const float lightness = 116.0f * f.y - 16.0f;
    return {lightness, 0.01f * lightness * 500.0f * (f.x - f.y), 0.01f * lightness * 200.0f * (f.y - f.z)};
}

float hyab(glm::vec3 a, glm::vec3 b) {  // lightness city-block, chroma Euclidean
    const glm::vec3 d = a - b;
    return std::fabs(d.x) + std::sqrt(d.y * d.y + d.z * d.z);
}

// Exponents and break points of the two pipelines (HPG 2020, sections 4.1 to 4.3).
constexpr float kColorExponent = 0.7f, kColorBreak = 0.4f, kColorBreakValue = 0.95f, kFeatureExponent = 0.5f;
constexpr double kFeatureWidthDegrees = 0.082;  // of the edges that people see best

// Colour differences are compressed so that large ones do not crowd out the rest (HPG 2020, equation 8).
float redistribute_color_error(float difference, float largest) {
    const float powered = std::pow(difference, kColorExponent), knee = kColorBreak * largest;
    if (powered < knee) return kColorBreakValue / knee * powered;
    return kColorBreakValue + (powered - knee) / (largest - knee) * (1.0f - kColorBreakValue);
}

// One term of a contrast sensitivity function: a sqrt(pi/b) exp(-pi^2 x^2 / b), x in degrees (HPG 2020, table 1).
struct SensitivityTerm {
    double a, b;
};
constexpr SensitivityTerm kAchromatic{1.0, 0.0047}, kRedGreen{1.0, 0.0053},
    kBlueYellow[2] = {{34.1, 0.04}, {13.5, 0.025}};

struct Filters {
    Taps achromatic, red_green, blue_yellow[2];
    float blue_yellow_weight[2];
    Taps gauss, edge, point;  // of the feature detectors: a Gaussian and its first and second derivative

    explicit Filters(double pixels_per_degree) {
        // The widest Gaussian (blue-yellow) to three standard deviations decides for all.
        const double kPi = 3.14159265358979323846;
        const int radius = int(std::ceil(3.0 * std::sqrt(kBlueYellow[0].b / (2.0 * kPi * kPi)) * pixels_per_degree));
        const auto sampled = [&](SensitivityTerm term, double& volume) {
            std::vector<double> line;
            double sum = 0.0;
            for (int i = -radius; i <= radius; ++i) {
                const double x = double(i) / pixels_per_degree;
                line.push_back(std::exp(-kPi * kPi * x * x / term.b));
                sum += line.back();
            }
            volume =
                term.a * std::sqrt(kPi / term.b) * sum * sum;  // of the two-dimensional filter, before it is normalised
            return Taps(normalised(line, sum));
        };
        double volume[2];
        achromatic = sampled(kAchromatic, volume[0]);
        red_green = sampled(kRedGreen, volume[0]);
        for (int i = 0; i < 2; ++i) blue_yellow[i] = sampled(kBlueYellow[i], volume[i]);
        for (int i = 0; i < 2; ++i) blue_yellow_weight[i] = float(volume[i] / (volume[0] + volume[1]));

        const double deviation = 0.5 * kFeatureWidthDegrees * pixels_per_degree;
        const int reach = int(std::ceil(3.0 * deviation));
        std::vector<double> g, first, second;
        for (int i = -reach; i <= reach; ++i) {
            const double x = i;
            g.push_back(std::exp(-x * x / (2.0 * deviation * deviation)));
            first.push_back(-x * g.back());
            second.push_back((x * x / (deviation * deviation) - 1.0) * g.back());
        }
        double sum = 0.0;
        for (const double value : g) sum += value;
        gauss = normalised(g, sum);
        edge = balanced(first);
        point = balanced(second);
    }

 private:
    static Taps normalised(const std::vector<double>& line, double sum) {
        Taps taps;
        for (const double value : line) taps.push_back(float(value / sum));
        return taps;
    }
    // Positive weights sum to 1, negative ones to -1.
    static Taps balanced(const std::vector<double>& line) {
        double positive = 0.0, negative = 0.0;
        for (const double value : line) (value > 0.0 ? positive : negative) += std::fabs(value);
        Taps taps;
        for (const double value : line) taps.push_back(float(value / (value > 0.0 ? positive : negative)));
        return taps;
    }
};

// One image as the eye sees it: filtered colours, and how strong edges and points are.
struct Seen {
    std::vector<glm::vec3> lab;
    Plane edge, point;
};

Seen see(const std::vector<glm::vec3>& rgb, Size size, const Filters& filters) {
    Plane planes[3], luminance(size.count());
    for (Plane& plane : planes) plane.resize(size.count());
    for_rows(size.height, [&](int y) {
        for (size_t i = size_t(y) * size_t(size.width), end = i + size_t(size.width); i < end; ++i) {
            const glm::vec3 ycc = ycc_from_rgb(rgb[i]);
            for (int c = 0; c < 3; ++c) planes[c][i] = ycc[c];
            luminance[i] = (ycc.x + 16.0f) / 116.0f;
        }
    });
    const auto both_ways = [&](const Plane& plane, const Taps& taps) {
        return filter_y(filter_x(plane, size, taps), size, taps);
    };
    const Plane a = both_ways(planes[0], filters.achromatic), rg = both_ways(planes[1], filters.red_green);
    const Plane by0 = both_ways(planes[2], filters.blue_yellow[0]), by1 = both_ways(planes[2], filters.blue_yellow[1]);

    const Plane smooth_x = filter_x(luminance, size, filters.gauss);
    const Plane edge_x = filter_y(filter_x(luminance, size, filters.edge), size, filters.gauss);
    const Plane edge_y = filter_y(smooth_x, size, filters.edge);
    const Plane point_x = filter_y(filter_x(luminance, size, filters.point), size, filters.gauss);
    const Plane point_y = filter_y(smooth_x, size, filters.point);

    Seen seen{std::vector<glm::vec3>(size.count()), Plane(size.count()), Plane(size.count())};
    for_rows(size.height, [&](int y) {
        for (size_t i = size_t(y) * size_t(size.width), end = i + size_t(size.width); i < end; ++i) {
            const float by = filters.blue_yellow_weight[0] * by0[i] + filters.blue_yellow_weight[1] * by1[i];
            seen.lab[i] = hunt_lab_from_rgb(glm::clamp(rgb_from_ycc({a[i], rg[i], by}), 0.0f, 1.0f));
            seen.edge[i] = std::sqrt(edge_x[i] * edge_x[i] + edge_y[i] * edge_y[i]);
            seen.point[i] = std::sqrt(point_x[i] * point_x[i] + point_y[i] * point_y[i]);
        }
    });
    return seen;
}

// LDR-FLIP of two pictures in [0, 1]; `error` becomes the maximum of its former value and this.
void accumulate(const std::vector<glm::vec3>& image, const std::vector<glm::vec3>& reference, Size size,
                const Filters& filters, std::vector<float>& error) {
    const Seen seen = see(image, size, filters), wanted = see(reference, size, filters);
    // Green against blue is the largest difference that a display can show (HPG 2020, section 4.1).
    const float largest =
        std::pow(hyab(hunt_lab_from_rgb({0.0f, 1.0f, 0.0f}), hunt_lab_from_rgb({0.0f, 0.0f, 1.0f})), kColorExponent);
    for_rows(size.height, [&](int y) {
        for (size_t i = size_t(y) * size_t(size.width), end = i + size_t(size.width); i < end; ++i) {
            const float color = redistribute_color_error(hyab(wanted.lab[i], seen.lab[i]), largest);
            const float difference =
                std::max(std::fabs(wanted.edge[i] - seen.edge[i]), std::fabs(wanted.point[i] - seen.point[i]));
            const float feature = std::pow(difference / std::sqrt(2.0f), kFeatureExponent);
            error[i] = std::max(error[i], std::pow(color, std::max(1.0f - feature, 0.0f)));  // HPG 2020, equation 13
        }
    });
}

std::vector<glm::vec3> colors_of(const Image& image) {
    std::vector<glm::vec3> colors(image.pixel_count());
    for (size_t i = 0; i < colors.size(); ++i)
        colors[i] = {image.pixels[3 * i], image.pixels[3 * i + 1], image.pixels[3 * i + 2]};
    return colors;
}

double mean_of(const std::vector<float>& values) {
    double sum = 0.0;
    for (const float value : values) sum += value;
    return sum / double(values.size());
}

void check_inputs(const Image& image, const Image& reference) {
    if (image.channels != 3 || reference.channels != 3 || image.width != reference.width ||
        image.height != reference.height)
        throw InputError(fmt::format("FLIP compares two RGB images of one size, not {} with {} channels and {} with {}",
                                     image.size_text(), image.channels, reference.size_text(), reference.channels));
}

// ACES' curve as a quotient of quadratics: (n0 x^2 + n1 x + n2) / (d0 x^2 + d1 x + d2), with Narkowicz's fit and x
// scaled by 0.6.
constexpr double kAcesNumerator[3] = {0.6 * 0.6 * 2.51, 0.6 * 0.03, 0.0},
                 kAcesDenominator[3] = {0.6 * 0.6 * 2.43, 0.6 * 0.59, 0.14};

glm::vec3 tone_mapped(glm::vec3 light) {
    const glm::vec3 x = glm::min(light, 1e6f);  // far beyond white, and its square is still finite
    const auto quadratic = [&](const double(&k)[3]) { return (float(k[0]) * x + float(k[1])) * x + float(k[2]); };
    return glm::clamp(quadratic(kAcesNumerator) / quadratic(kAcesDenominator), 0.0f, 1.0f);
}

// The light that the curve maps to 0.85: anything brighter counts as over-exposed (EG 2021, section 3).
double overexposed_light() {
    constexpr double kTarget = 0.85;
    const double a = kAcesNumerator[0] - kTarget * kAcesDenominator[0],
                 b = kAcesNumerator[1] - kTarget * kAcesDenominator[1],
                 c = kAcesNumerator[2] - kTarget * kAcesDenominator[2];
    return (-b + std::sqrt(b * b - 4.0 * a * c)) / (2.0 * a);
}

// From the exposure at which the brightest pixel of the reference is just well exposed to the one at which half of the pixels
// are.
void choose_exposures(const std::vector<glm::vec3>& reference, FlipResult& result) {
    std::vector<float> luminances;
    luminances.reserve(reference.size());
    for (const glm::vec3& color : reference)
        luminances.push_back(glm::dot(color, glm::vec3(0.2126f, 0.7152f, 0.0722f)));
    const auto middle = luminances.begin() + std::ptrdiff_t(luminances.size() / 2);
    std::nth_element(luminances.begin(), middle, luminances.end());
    // As in flip-evaluator: the upper of the two medians of an even number of pixels, and a lower bound that keeps the range
    // finite for a mostly black reference.
    const auto exposure_for = [](float luminance) {
        return std::log2(overexposed_light() / double(std::max(luminance, std::numeric_limits<float>::epsilon())));
    };
    result.start_exposure = exposure_for(*std::max_element(middle, luminances.end()));
    result.stop_exposure = exposure_for(*middle);
    result.exposures = std::max(2, int(std::ceil(result.stop_exposure - result.start_exposure)));
}

}  // namespace

FlipResult flip_ldr(const Image& image, const Image& reference, double pixels_per_degree) {
    check_inputs(image, reference);
    std::vector<glm::vec3> seen = colors_of(image), wanted = colors_of(reference);
    for (glm::vec3& color : seen) color = glm::clamp(color, 0.0f, 1.0f);
    for (glm::vec3& color : wanted) color = glm::clamp(color, 0.0f, 1.0f);
    FlipResult result;
    result.error.resize(image.pixel_count());
    accumulate(seen, wanted, {image.width, image.height}, Filters(pixels_per_degree), result.error);
    result.mean = mean_of(result.error);
    return result;
}

FlipResult flip_hdr(const Image& image, const Image& reference, double pixels_per_degree) {
    check_inputs(image, reference);
    std::vector<glm::vec3> seen = colors_of(image), wanted = colors_of(reference);
    for (glm::vec3& color : seen) color = glm::max(color, 0.0f);
    for (glm::vec3& color : wanted) color = glm::max(color, 0.0f);
    FlipResult result;
    choose_exposures(wanted, result);
    result.error.resize(image.pixel_count());
    const Filters filters(pixels_per_degree);
    std::vector<glm::vec3> seen_mapped(seen.size()), wanted_mapped(wanted.size());
    for (int i = 0; i < result.exposures; ++i) {
        const double step = (result.stop_exposure - result.start_exposure) / double(result.exposures - 1);
        const float scale = float(std::exp2(result.start_exposure + i * step));
        for_rows(image.height, [&](int y) {
            for (size_t p = size_t(y) * size_t(image.width), end = p + size_t(image.width); p < end; ++p) {
                seen_mapped[p] = tone_mapped(scale * seen[p]);
                wanted_mapped[p] = tone_mapped(scale * wanted[p]);
            }
        });
        accumulate(seen_mapped, wanted_mapped, {image.width, image.height}, filters, result.error);
    }
    result.mean = mean_of(result.error);
    return result;
}

}  // namespace lampyris
