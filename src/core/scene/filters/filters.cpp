// Pixel filters: box and triangle in closed form, gaussian, mitchell and sinc from tables.
#include "core/scene/film.h"
#include "core/scene/filter_table.h"

#include <stdexcept>
#include <vector>

namespace lampyris {

namespace {

void set_radius(FilterContext& context, uint32_t kind) {
    context.record.filter_kind = kind;
    context.record.filter_radius_x = context.reader.get_float("xradius");
    context.record.filter_radius_y = context.reader.get_float("yradius");
}

void build_box(FilterContext& context) { set_radius(context, kernel::PIXEL_FILTER_BOX); }
void build_triangle(FilterContext& context) { set_radius(context, kernel::PIXEL_FILTER_TRIANGLE); }
// A filter of the distance along each axis, given as f(x, radius).
template <typename F>
void set_table(FilterContext& context, F&& f) {
    set_radius(context, kernel::PIXEL_FILTER_GAUSSIAN);
    const double rx = context.record.filter_radius_x, ry = context.record.filter_radius_y;
    std::vector<uint32_t>& distributions = context.build.scene.distributions;
    try {
        context.record.filter_tables = append_filter_table([&](double x) { return f(x, rx); }, rx,
                                                           [&](double y) { return f(y, ry); }, ry, distributions);
        context.record.filter_intervals = kFilterTableSize;
    } catch (const std::invalid_argument& error) {
        context.build.diagnostics.error(context.reader.entity().location, "the filter's integral is not positive",
                                        "other parameters");
        context.record.filter_kind = kernel::PIXEL_FILTER_BOX;
    }
}

void build_gaussian(FilterContext& context) {
    const double sigma = context.reader.get_float("sigma");
    set_table(context, [=](double x, double radius) { return gaussian_filter(x, radius, sigma); });
}
void build_mitchell(FilterContext& context) {
    const double b = context.reader.get_float("B"), c = context.reader.get_float("C");
    set_table(context, [=](double x, double radius) { return mitchell_filter(x, radius, b, c); });
}
void build_sinc(FilterContext& context) {
    const double tau = context.reader.get_float("tau");
    set_table(context, [=](double x, double radius) { return sinc_filter(x, radius, tau); });
}

ParameterSpecs with_radius(double radius, ParameterSpecs specs = {}) {
    specs.push_back(real("xradius", radius, "horizontal radius").above(0).between(0, 64).in("pixels"));
    specs.push_back(real("yradius", radius, "vertical radius").above(0).between(0, 64).in("pixels"));
    return specs;
}

const RegisterFilter box("box", "Weights all points alike.", with_radius(0.5), build_box);
const RegisterFilter triangle("triangle", "Falls off linearly.", with_radius(2.0), build_triangle);
const RegisterFilter gaussian("gaussian", "A Gaussian, lowered to reach zero at the radius.",
                              with_radius(1.5, {real("sigma", 0.5, "standard deviation").above(0).in("pixels")}),
                              build_gaussian);
const RegisterFilter mitchell("mitchell", "Mitchell and Netravali's cubic.",
                              with_radius(2.0, {real("B", 1.0 / 3.0, "blur"), real("C", 1.0 / 3.0, "ringing")}),
                              build_mitchell);
const RegisterFilter lanczos("sinc", "A sinc under a Lanczos window.",
                             with_radius(4.0, {real("tau", 3.0, "width of the window").above(0).in("pixels")}),
                             build_sinc);

}  // namespace

}  // namespace lampyris
