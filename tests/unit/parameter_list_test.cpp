// Parameters of every type: from text to values, and the getters' errors.
#include "core/scene/description.h"

#include <gtest/gtest.h>

using namespace lampyris;

namespace {

struct Fixture {
    std::shared_ptr<Sources> sources = std::make_shared<Sources>();
    Diagnostics diagnostics{*sources};
    ParameterList list;

    explicit Fixture(const std::string& parameters) {
        SceneDescription scene =
            parse_scene_text("p", "WorldBegin Shape \"s\"\n" + parameters, SceneFolder(), sources, diagnostics);
        if (!scene.shapes.empty()) list = std::move(scene.shapes[0].parameters);
    }
    std::string first_error() const { return diagnostics.has_errors() ? diagnostics.errors()[0] : ""; }
};

void expect_error(const std::string& parameters, const std::string& expected) {
    const Fixture f(parameters);
    EXPECT_EQ(f.diagnostics.error_count(), 1u) << parameters;
    EXPECT_EQ(f.first_error().find(expected), 0u) << f.first_error();
}

}  // namespace

TEST(ParameterList, ReadsEveryTypeInBothForms) {
    Fixture f(R"("bool a" true "bool b" [ false true ] "bool c" "true" "integer d" -3 "integer e" [ 1 2 3 ]
"float f" 1.5 "float g" [ 1 2e-1 ] "point2 h" [ 1 2 3 4 ] "vector2 i" [ 1 2 ] "point3 j" [ 1 2 3 ] "vector3 k" [ 4 5 6 ]
"normal l" [ 0 0 1 ] "rgb m" [ .1 .2 .3 ] "blackbody n" 6500 "spectrum o" "metal-Au-eta" "spectrum p" [ 400 1 500 2 ]
"spectrum q" [ "glass-BK7" ] "string r" "text" "string s" [ "one" "two" ] "texture t" "name" "float u" []
"  float   v	" [1]# comment ] "
"float w"[2]"float x"3)");
    ASSERT_FALSE(f.diagnostics.has_errors()) << f.first_error();
    Diagnostics& d = f.diagnostics;
    EXPECT_TRUE(f.list.get_bool("a", false, d));
    EXPECT_EQ(std::get<std::vector<uint8_t>>(f.list.find("b")->values), (std::vector<uint8_t>{0, 1}));
    EXPECT_TRUE(f.list.get_bool("c", false, d));
    EXPECT_EQ(f.list.get_int("d", 0, d), -3);
    EXPECT_EQ(f.list.take_ints("e", d), (std::vector<int32_t>{1, 2, 3}));
    EXPECT_EQ(f.list.get_float("f", 0, d), 1.5f);
    EXPECT_EQ(f.list.get_floats("g", ParameterType::kFloat, 2, d), (std::vector<float>{1, 0.2f}));
    EXPECT_EQ(f.list.take_floats("h", ParameterType::kPoint2, d), (std::vector<float>{1, 2, 3, 4}));
    EXPECT_EQ(f.list.get_floats("i", ParameterType::kVector2, 2, d).size(), 2u);
    EXPECT_EQ(f.list.get_floats("j", ParameterType::kPoint3, 3, d).size(), 3u);
    EXPECT_EQ(f.list.get_floats("k", ParameterType::kVector3, 3, d)[2], 6.0f);
    EXPECT_EQ(f.list.get_floats("l", ParameterType::kNormal, 3, d).size(), 3u);
    EXPECT_EQ(f.list.get_floats("m", ParameterType::kRgb, 3, d), (std::vector<float>{0.1f, 0.2f, 0.3f}));
    EXPECT_EQ(f.list.get_floats("n", ParameterType::kBlackbody, 1, d), (std::vector<float>{6500}));
    EXPECT_EQ(std::get<std::vector<std::string>>(f.list.find("o")->values)[0], "metal-Au-eta");
    EXPECT_EQ(f.list.get_floats("p", ParameterType::kSpectrum, 4, d), (std::vector<float>{400, 1, 500, 2}));
    EXPECT_EQ(std::get<std::vector<std::string>>(f.list.find("q")->values)[0], "glass-BK7");
    EXPECT_EQ(f.list.get_string("r", "", d), "text");
    EXPECT_EQ(std::get<std::vector<std::string>>(f.list.find("s")->values).size(), 2u);
    EXPECT_EQ(f.list.find("t")->type, ParameterType::kTexture);
    EXPECT_TRUE(f.list.take_floats("u", ParameterType::kFloat, d).empty());
    EXPECT_EQ(f.list.get_float("v", 0, d), 1.0f);
    EXPECT_EQ(f.list.get_float("w", 0, d), 2.0f);
    EXPECT_EQ(f.list.get_float("x", 0, d), 3.0f);
    f.list.report_unused("s", {}, d);
    EXPECT_FALSE(d.has_errors()) << f.first_error();
    EXPECT_EQ(f.sources->describe(f.list.find("b")->value_location), "p:2:26");
}

TEST(ParameterList, LongArraysAreReadWhole) {
    std::string text = "\"point3 P\" [";
    for (int i = 0; i < 30000; ++i) text += " " + std::to_string(i);
    Fixture f(text + " ]");
    const std::vector<float> values = f.list.take_floats("P", ParameterType::kPoint3, f.diagnostics);
    ASSERT_EQ(values.size(), 30000u);
    for (int i = 0; i < 30000; ++i) ASSERT_EQ(values[i], static_cast<float>(i));
    EXPECT_TRUE(f.list.take_floats("P", ParameterType::kPoint3, f.diagnostics).empty());  // taken
}

TEST(ParameterList, OldTypeNamesAreUnderstood) {
    Fixture f("\"point P\" [ 1 2 3 ] \"vector V\" [ 1 2 3 ]");
    EXPECT_FALSE(f.diagnostics.has_errors());
    EXPECT_EQ(f.diagnostics.warnings().size(), 2u);
    EXPECT_EQ(f.list.take_floats("P", ParameterType::kPoint3, f.diagnostics).size(), 3u);
}

TEST(ParameterList, GettersGiveDefaultsAndReportWrongTypesAndCounts) {
    Fixture f("\"integer radius\" 2 \"float many\" [ 1 2 ] \"string mode\" \"repaet\" \"float empty\" []");
    EXPECT_EQ(f.list.get_float("absent", 7.0f, f.diagnostics), 7.0f);
    EXPECT_EQ(f.list.get_int("absent", 7, f.diagnostics), 7);
    EXPECT_EQ(f.list.get_string("absent", "x", f.diagnostics), "x");
    EXPECT_TRUE(f.list.get_bool("absent", true, f.diagnostics));
    EXPECT_TRUE(f.list.get_floats("absent", ParameterType::kRgb, 3, f.diagnostics).empty());
    EXPECT_EQ(f.list.get_choice("absent", "black", {"repeat", "clamp"}, f.diagnostics), "black");
    EXPECT_FALSE(f.diagnostics.has_errors());
    EXPECT_EQ(f.list.find("radius", ParameterType::kFloat), nullptr);
    EXPECT_EQ(f.list.get_float("radius", 5.0f, f.diagnostics), 5.0f);
    EXPECT_EQ(f.list.get_float("many", 5.0f, f.diagnostics), 5.0f);
    EXPECT_EQ(f.list.get_float("empty", 5.0f, f.diagnostics), 5.0f);
    EXPECT_EQ(f.list.get_choice("mode", "clamp", {"repeat", "clamp"}, f.diagnostics), "clamp");
    const std::vector<std::string> errors = f.diagnostics.errors();
    ASSERT_EQ(errors.size(), 4u);
    EXPECT_EQ(
        errors[0].find("p:2:1: error: parameter \"radius\" is of type float, not integer; write \"float radius\""), 0u);
    EXPECT_EQ(errors[1].find("p:2:35: error: parameter \"float many\" takes one value, but has 2"), 0u) << errors[1];
    EXPECT_EQ(
        errors[2].find(
            "p:2:55: error: \"repaet\" is not a value of \"string mode\" (did you mean \"repeat\"?); it is one of "
            "repeat, clamp"),
        0u)
        << errors[2];
    EXPECT_EQ(errors[3].find("p:2:79: error: parameter \"float empty\" takes one value, but has none"), 0u)
        << errors[3];
}

TEST(ParameterList, WhatNobodyAskedForIsAnError) {
    Fixture f("\"float radius\" 2 \"float raduis\" 2");
    f.list.get_float("radius", 1.0f, f.diagnostics);
    f.list.report_unused("Shape \"sphere\"", {"radius", "zmin"}, f.diagnostics);
    ASSERT_EQ(f.diagnostics.error_count(), 1u);
    EXPECT_EQ(f.first_error().find(
                  "p:2:18: error: parameter \"raduis\" is unknown to Shape \"sphere\" (did you mean \"radius\"?); its "
                  "parameters are radius, zmin"),
              0u)
        << f.first_error();
}

TEST(ParameterList, TextErrorsNameTheirPlace) {
    expect_error("\"float radius\" [ 1 2x ]", "p:2:20: error: expected a number for \"float radius\", found \"2x\"");
    expect_error("\"float radius\" \"2\"",
                 "p:2:16: error: expected a number for \"float radius\", found the string \"2\"");
    expect_error("\"integer n\" 2.0", "p:2:13: error: expected an integer for \"integer n\", found \"2.0\"");
    expect_error("\"bool b\" maybe", "p:2:10: error: expected true or false for \"bool b\", found \"maybe\"");
    expect_error("\"string s\" word", "p:2:12: error: expected a string in quotes for \"string s\", found \"word\"");
    expect_error("\"texture s\" 5",
                 "p:2:13: error: expected a texture's name in quotes for \"texture s\", found \"5\"");
    expect_error("\"rgb c\" [ 1 2 ]",
                 "p:2:1: error: parameter \"rgb c\" has 2 numbers; type rgb takes a multiple of 3");
    expect_error("\"spectrum c\" [ 400 1 500 ]",
                 "p:2:1: error: parameter \"spectrum c\" has 3 numbers; a spectrum is pairs");
    expect_error("\"spectrum c\" [ 500 1 400 1 ]",
                 "p:2:1: error: the wavelengths of \"spectrum c\" do not increase at pair 2");
    expect_error("\"point3 P\" 1 2 3", "p:2:14: error: several values of \"point3 P\" need brackets");
    expect_error("\"float a\" 1 \"float a\" 2", "p:2:13: error: parameter \"a\" is given twice");
    expect_error("\"float a\"", "p:2:1: error: parameter \"float a\" has no value: the file ends");
    expect_error("\"float a\" [ 1", "p:2:11: error: this '[' of \"float a\" is never closed: the file ends first");
    expect_error("\"string a\" [ \"x\"\nShape \"s\"",
                 "p:2:12: error: this '[' of \"string a\" is never closed: \"Shape\" follows at line 3");
    expect_error("\"float a\" [ 1 \"float b\" 2",
                 "p:2:11: error: this '[' of \"float a\" is never closed: \"float b\" follows");
    expect_error("\"float a\" [ [ 1 ]", "p:2:13: error: expected a number for \"float a\", found \"[\"");
    expect_error("\"a\" 1", "p:2:1: error: \"a\" is no parameter: it has no type");
    expect_error("\"float\" 1", "p:2:1: error: this parameter has a type (float) but no name");
    expect_error("\"float a b\" 1", "p:2:1: error: \"float a b\" is no parameter: it has more than a type and a name");
    expect_error("\"\" 1", "p:2:1: error: an empty string where a parameter should be");
    expect_error("\"flaot a\" 1", "p:2:1: error: unknown parameter type \"flaot\" (did you mean \"float\"?)");
    expect_error("\"int a\" 1", "p:2:1: error: unknown parameter type \"int\"; it is called \"integer\" in pbrt-v4");
    expect_error("\"float a\" 1e99", "p:2:11: error: number out of range for a 32-bit float");
    expect_error("\"integer a\" [ 3000000000 ]", "p:2:15: error: number out of range for a 32-bit integer");
}
