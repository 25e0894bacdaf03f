#include "core/base/parameters.h"

#include "core/base/registry.h"
#include "core/kernel/params.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace lampyris {
namespace {

#define PROBE_PARAMS(P)                               \
    P(int, rays, 4, 1, 1024, "rays of a hit")         \
    P(float, distance, 1e30f, 0.0f, 1e30f, "how far") \
    P(unsigned, slots, 2, 1, 8, "slots of a bucket")
PARAMS(ProbeParams, PROBE_PARAMS)

std::string message_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

TEST(ParameterFields, DefaultsAndTextFillTheStruct) {
    const ParameterFields fields = PARAMETER_FIELDS(ProbeParams, PROBE_PARAMS);
    ProbeParams params{};
    set_defaults(&params, fields);
    EXPECT_EQ(params.rays, 4);
    EXPECT_EQ(params.distance, 1e30f);
    EXPECT_EQ(params.slots, 2u);
    set_parameter(&params, fields, "rays", "17", "integrator \"probe\"");
    set_parameter(&params, fields, "distance", "2.5e-1", "integrator \"probe\"");
    set_parameter(&params, fields, "slots", "8", "integrator \"probe\"");
    EXPECT_EQ(params.rays, 17);
    EXPECT_EQ(params.distance, 0.25f);
    EXPECT_EQ(params.slots, 8u);
    const auto shown = show_parameters(&params, fields);
    ASSERT_EQ(shown.size(), 3u);
    EXPECT_EQ(shown[1], (std::pair<std::string, std::string>("distance", "0.25")));
}

TEST(ParameterFields, WrongTextIsExplained) {
    const ParameterFields fields = PARAMETER_FIELDS(ProbeParams, PROBE_PARAMS);
    ProbeParams params{};
    const auto set = [&](const char* key, const char* value) {
        return message_of([&] { set_parameter(&params, fields, key, value, "integrator \"probe\""); });
    };
    EXPECT_NE(set("ray", "1").find("has no parameter \"ray\""), std::string::npos);
    EXPECT_NE(set("ray", "1").find("did you mean \"rays\"?"), std::string::npos);
    EXPECT_NE(set("rays", "1.5").find("\"1.5\" is not a whole number"), std::string::npos);
    EXPECT_NE(set("rays", "1025").find("must be 1 to 1024"), std::string::npos);
    EXPECT_NE(set("distance", "nan").find("must be"), std::string::npos);
    EXPECT_NE(set("distance", "far").find("\"far\" is not a number"), std::string::npos);
}

#define CHOICE_PARAMS(P) P(unsigned, selection, 1, 0, 2, "{race|priority|flux} who stays")
PARAMS(ChoiceParams, CHOICE_PARAMS)

TEST(ParameterFields, ChoicesAreNamedAndKeptAsNumbers) {
    const ParameterFields fields = PARAMETER_FIELDS(ChoiceParams, CHOICE_PARAMS);
    EXPECT_EQ(fields[0].spec.choices, (std::vector<std::string>{"race", "priority", "flux"}));
    EXPECT_EQ(fields[0].spec.default_text(), "priority");
    EXPECT_EQ(fields[0].spec.doc, "who stays");
    ChoiceParams params{};
    set_defaults(&params, fields);
    EXPECT_EQ(params.selection, 1u);
    set_parameter(&params, fields, "selection", "flux", "photon-map \"probe\"");
    EXPECT_EQ(params.selection, 2u);
    EXPECT_EQ(show_parameters(&params, fields)[0].second, "flux");
    const std::string message =
        message_of([&] { set_parameter(&params, fields, "selection", "fluxx", "photon-map \"probe\""); });
    EXPECT_NE(message.find("(did you mean \"flux\"?); valid are race, priority, flux"), std::string::npos) << message;
}

#define BOUNDED_PARAMS(P) P(float, footprint, 2.5f, 0.1f, 0.7f, "bounds that are no numbers in binary")
PARAMS(BoundedParams, BOUNDED_PARAMS)

TEST(ParameterFields, StatedBoundsAreInside) {
    const ParameterFields fields = PARAMETER_FIELDS(BoundedParams, BOUNDED_PARAMS);
    ASSERT_EQ(fields.front().spec.range_text(), "0.1 to 0.7");
    BoundedParams params{};
    set_parameter(&params, fields, "footprint", "0.1", "probe");
    EXPECT_EQ(params.footprint, 0.1f);
    set_parameter(&params, fields, "footprint", "0.7", "probe");
    EXPECT_EQ(params.footprint, 0.7f);
    EXPECT_THROW(set_parameter(&params, fields, "footprint", "0.0999999", "probe"), InputError);
    EXPECT_THROW(set_parameter(&params, fields, "footprint", "0.7000002", "probe"), InputError);
}

TEST(PluginChoice, NameAndSettings) {
    const PluginChoice choice = parse_plugin_choice("stochastic_hash:slots=2,load=0.5");
    EXPECT_EQ(choice.name, "stochastic_hash");
    ASSERT_EQ(choice.settings.size(), 2u);
    EXPECT_EQ(choice.settings[1], (std::pair<std::string, std::string>("load", "0.5")));
    EXPECT_EQ(parse_plugin_choice("path").settings.size(), 0u);
    EXPECT_NE(message_of([] { parse_plugin_choice(":a=1"); }).find("names no plugin"), std::string::npos);
    EXPECT_NE(message_of([] { parse_plugin_choice("path:depth"); }).find("not of the form key=value"),
              std::string::npos);
}

TEST(ParameterSpec, TellsItsRange) {
    EXPECT_EQ(real("x", 1, "").above(0).range_text(), "above 0");
    EXPECT_EQ(real("x", 1, "").above(0).between(0, 2).range_text(), "above 0 to 2");
    EXPECT_FALSE(real("x", 1, "").above(0).contains(0.0));
    EXPECT_FALSE(real("x", 1, "").at_least(0).contains(std::nan("")));
    EXPECT_TRUE(real("x", 1, "").at_least(0).contains(0.0));
}

TEST(Registry, FindsAndRefusesDuplicates) {
    static Registry<int> registry("probe", "Things of this test.");
    registry.add({"one", "The first.", {}}, 1);
    ASSERT_NE(registry.find("one"), nullptr);
    EXPECT_EQ(*registry.find("one"), 1);
    EXPECT_NE(
        message_of([] { registry.require("on"); }).find("unknown probe \"on\" (did you mean \"one\"?); known: one"),
        std::string::npos);
    EXPECT_EQ(message_of(check_registrations), "no error");
    registry.add({"one", "Another.", {}}, 2);
    EXPECT_EQ(*registry.find("one"), 1);
    EXPECT_NE(message_of(check_registrations).find("two plugins of kind probe are named \"one\""), std::string::npos);
}

}  // namespace
}  // namespace lampyris
