#include "support/convergence.h"

#include "integrators/photon_paths/progressive.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace lampyris::test {
namespace {

constexpr int kSize = 8;             // pixels a side
constexpr double kHalfWidth = 0.12;  // of the window
constexpr double kRadius = 0.25;     // of the first pass
constexpr double kAlbedo = 0.5;
constexpr double kConeAngle = 40.0;  // degrees

// A spot light of intensity 1, at height 1 over the plane z = 0, whose cone is far wider than the window and its disks.
std::string scene_text(const std::string& sampler = "independent") {
    return fmt::format(
        "LookAt 0 0 3  0 0 0  0 1 0\nCamera \"orthographic\" \"float screenwindow\" [ {0} {1} {0} {1} ]\n"
        "Sampler \"{4}\" \"integer pixelsamples\" 1\nPixelFilter \"box\" \"float xradius\" 0.5 \"float "
        "yradius\" 0.5\n"
        "Film \"rgb\" \"integer xresolution\" {2} \"integer yresolution\" {2}\nWorldBegin\n"
        "LightSource \"spot\" \"point3 from\" [ 0 0 1 ] \"point3 to\" [ 0 0 0 ] \"float coneangle\" {5} "
        "\"float conedeltaangle\" 0.01\nMaterial \"diffuse\" \"rgb reflectance\" [ {3} {3} {3} ]\n"
        "Shape \"trianglemesh\" \"point3 P\" [ -3 -3 0  3 -3 0  3 3 0  -3 3 0 ] \"integer indices\" [ 0 1 2 0 2 3 ]\n",
        -kHalfWidth, kHalfWidth, kSize, kAlbedo, sampler, kConeAngle);
}

// Radiance at distance rho from the foot of the light: albedo / pi times irradiance 1 / (1 + rho^2)^(3/2).
double radiance(double rho2) { return kAlbedo / std::numbers::pi * std::pow(1.0 + rho2, -1.5); }

double pixel_truth(int x, int y) {
    constexpr int kGrid = 8;
    double sum = 0.0;
    for (int j = 0; j < kGrid; ++j)
        for (int i = 0; i < kGrid; ++i) {
            const double px = kHalfWidth * (2.0 * (x + (i + 0.5) / kGrid) / kSize - 1.0);
            const double py = kHalfWidth * (2.0 * (y + (j + 0.5) / kGrid) / kSize - 1.0);
            sum += radiance(px * px + py * py);
        }
    return sum / (kGrid * kGrid);
}

// The share of the photons that hit a disk about the foot: directions are uniform within the cone.
double disk_share(double r2) {
    return (1.0 - 1.0 / std::sqrt(1.0 + r2)) / (1.0 - std::cos(kConeAngle * std::numbers::pi / 180.0));
}

// Relative bias of a disk of squared radius r2 about the foot: the mean of (1 + rho^2)^(-3/2) over it, less 1; to first order
// -3/4 r^2, which is r^2 / 8 times the Laplacian.
double disk_bias(double r2) { return 2.0 / r2 * (1.0 - 1.0 / std::sqrt(1.0 + r2)) - 1.0; }

struct Run {
    std::vector<std::vector<double>> errors;  // of each snapshot: relative errors of the pixels
};

double slope(const std::vector<double>& x, const std::vector<double>& y) {
    double mx = 0.0, my = 0.0;
    for (size_t i = 0; i < x.size(); ++i) mx += x[i] / double(x.size()), my += y[i] / double(x.size());
    double up = 0.0, down = 0.0;
    for (size_t i = 0; i < x.size(); ++i) up += (x[i] - mx) * (y[i] - my), down += (x[i] - mx) * (x[i] - mx);
    return up / down;
}

// Bias and variance of each snapshot from all runs but one (-1: from all).
std::vector<ConvergencePointOfSeeds> points_of(const std::vector<Run>& runs, const std::vector<uint64_t>& passes,
                                               int without) {
    std::vector<ConvergencePointOfSeeds> points;
    for (size_t k = 0; k < passes.size(); ++k) {
        const size_t pixels = runs[0].errors[k].size();
        ConvergencePointOfSeeds point{passes[k], 0.0, 0.0};
        for (size_t p = 0; p < pixels; ++p) {
            double sum = 0.0, squares = 0.0;
            int n = 0;
            for (size_t r = 0; r < runs.size(); ++r) {
                if (int(r) == without) continue;
                const double e = runs[r].errors[k][p];
                sum += e, squares += e * e, ++n;
            }
            point.bias += sum / n / double(pixels);
            point.variance += (squares - sum * sum / n) / (n - 1) / double(pixels);
        }
        points.push_back(point);
    }
    return points;
}

struct Slopes {
    double bias_squared, variance;
};
Slopes fit(const std::vector<ConvergencePointOfSeeds>& points, uint64_t first) {
    std::vector<double> x, b, v;
    for (const ConvergencePointOfSeeds& p : points) {
        if (p.passes < first) continue;
        x.push_back(std::log(double(p.passes)));
        b.push_back(std::log(p.bias * p.bias));
        v.push_back(std::log(p.variance));
    }
    return {slope(x, b), slope(x, v)};
}

std::string integrator_of(double alpha, uint32_t photons = 3000) {
    return fmt::format("sppm:schedule=memoryless,direct=photons,maxdepth=1,radius={},alpha={},photonsperiteration={}",
                       kRadius, alpha, photons);
}

}  // namespace

Mean measure_coverage(double confidence, int seeds, uint32_t passes) {
    RenderSettings settings;
    settings.samples = passes;
    settings.integrator = integrator_of(2.0 / 3.0) + fmt::format(",confidence={}", confidence);
    Mean coverage;
    for (int seed = 0; seed < seeds; ++seed) {
        settings.seed = uint32_t(5000 + seed);
        const Rendered image = render_text(scene_text(), settings);
        const int bound = image.image.find_channel("error.R");
        int below = 0;
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x)
                below += std::abs(double(image.value(x, y, 0)) - pixel_truth(x, y)) <= double(image.value(x, y, bound));
        coverage.add(below / double(kSize * kSize));
    }
    return coverage;
}

BiasEstimate measure_bias(int seeds, uint32_t passes) {
    constexpr double kAlpha = 2.0 / 3.0;
    RenderSettings settings;
    settings.samples = passes;
    settings.integrator = integrator_of(kAlpha);
    BiasEstimate result;
    for (int seed = 0; seed < seeds; ++seed) {
        settings.seed = uint32_t(9000 + seed);
        const Rendered image = render_text(scene_text(), settings);
        const int channel = image.image.find_channel("bias.R");
        double sum = 0.0;
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x) sum += double(image.value(x, y, channel)) / pixel_truth(x, y);
        result.estimated.add(sum / (kSize * kSize));
    }
    for (uint32_t i = 0; i < passes; ++i)
        result.expected += disk_bias(kRadius * kRadius * memoryless_scale(i, kAlpha)) / passes;
    return result;
}

ConvergenceSlopes measure_convergence(const ConvergenceSettings& asked) {
    RenderSettings settings;
    settings.samples = asked.passes;
    settings.integrator = integrator_of(asked.alpha, asked.photons);
    const std::string text = scene_text(asked.sampler);
    std::vector<Run> runs;
    std::vector<uint64_t> snapshots;
    for (int seed = 0; seed < asked.seeds; ++seed) {
        Run run;
        std::vector<uint64_t> at;
        settings.seed = asked.first_seed + uint32_t(seed);
        settings.on_progress = [&](const RenderProgress& progress, const Film& film) {
            if ((progress.passes & (progress.passes - 1)) != 0) return;
            const std::vector<float> rgb = film.rgb();
            std::vector<double> errors;
            for (int y = 0; y < kSize; ++y)
                for (int x = 0; x < kSize; ++x)
                    errors.push_back(double(rgb[size_t(3 * (y * kSize + x))]) / pixel_truth(x, y) - 1.0);
            run.errors.push_back(std::move(errors));
            at.push_back(progress.passes);
        };
        render_text(text, settings);
        runs.push_back(std::move(run));
        snapshots = at;
    }
    ConvergenceSlopes result;
    result.points = points_of(runs, snapshots, -1);
    const Slopes all = fit(result.points, asked.first);
    result.bias_squared = all.bias_squared, result.variance = all.variance;
    double b = 0.0, bb = 0.0, v = 0.0, vv = 0.0;
    for (int r = 0; r < asked.seeds; ++r) {
        const Slopes s = fit(points_of(runs, snapshots, r), asked.first);
        b += s.bias_squared, bb += s.bias_squared * s.bias_squared, v += s.variance, vv += s.variance * s.variance;
    }
    const auto jackknife = [&](double sum, double squares) {
        return std::sqrt(std::max(0.0, (squares - sum * sum / asked.seeds)) * (asked.seeds - 1) / asked.seeds);
    };
    result.bias_squared_error = jackknife(b, bb), result.variance_error = jackknife(v, vv);
    // The prediction from the radii of these passes: the mean of their biases, and of their variances over n. The number of
    // photons in a disk is binomial, so its relative variance is (1 - share) / share.
    std::vector<ConvergencePointOfSeeds> expected;
    double bias = 0.0, variance = 0.0;
    size_t k = 0;
    for (uint64_t i = 0; i < asked.passes && k < snapshots.size(); ++i) {
        const double r2 = kRadius * kRadius * memoryless_scale(i, asked.alpha);
        bias += disk_bias(r2), variance += 1.0 / disk_share(r2) - 1.0;
        if (i + 1 == snapshots[k]) {
            const double n = double(i + 1);
            expected.push_back({i + 1, bias / n, variance / (n * n * asked.photons)});
            ++k;
        }
    }
    const Slopes said = fit(expected, asked.first);
    result.expected_bias_squared = said.bias_squared, result.expected_variance = said.variance;
    return result;
}

}  // namespace lampyris::test
