// Material "mix": each point shows one of two materials, by chance.
#include "core/scene/materials/common.h"

#include <fmt/format.h>

#include <algorithm>

namespace lampyris {

namespace {

void build(MaterialContext& context) {
    kernel::MaterialRecord& record = context.record;
    BuildContext& build = context.build;
    record.data.x = kernel::MATERIAL_MIX;
    context.ask(kernel::EFFECT_MIX);
    const FloatSlot amount = read_float(build, context.reader, "amount");
    record.floats.x = amount.value;
    record.extra.z = amount.texture;
    record.extra.x = record.extra.y = 0;
    const Parameter* parameter = context.reader.find("materials");
    if (!parameter) return;  // told as a missing parameter
    const auto* names = std::get_if<std::vector<std::string>>(&parameter->values);
    if (!names || names->size() != 2) {
        context.reader.error("materials", fmt::format("\"mix\" of {} materials", names ? names->size() : 0), "\"string materials\" [ \"a\" \"b\" ]");
        return;
    }
    for (int i = 0; i < 2; ++i) {
        const std::string& name = (*names)[size_t(i)];
        const auto& all = build.description.materials;
        const auto found = std::find_if(all.begin(), all.end(), [&](const MaterialDescription& m) { return !m.name.empty() && m.name == name; });
        if (found == all.end()) {
            std::vector<std::string> known;
            for (const MaterialDescription& m : all)
                if (!m.name.empty()) known.push_back(m.name);
            context.reader.error("materials", fmt::format("there is no material named \"{}\"{}", name, did_you_mean(name, known)),
                                 "MakeNamedMaterial defines one");
            continue;
        }
        const uint32_t index = uint32_t(found - all.begin());
        if (std::find(context.path.begin(), context.path.end(), index) != context.path.end()) {
            context.reader.error("materials", fmt::format("the mix contains itself, through \"{}\"", name));
            continue;
        }
        record.extra[i] = build.material(index, context.path);
    }
}

ParameterSpecs specs() {
    return {
        values("materials", ParameterType::kString, "", "names of two materials").needed(),
        real("amount", 0.5, "share of the second").between(0, 1).textured(),
    };
}

const RegisterMaterial mix("mix", "One of two named materials at each point, by chance.", specs(), build);

}  // namespace

}  // namespace lampyris
