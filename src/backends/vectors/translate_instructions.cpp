// Instructions other than those of arithmetic.
#include "backends/vectors/translator.h"

#include <fmt/format.h>

namespace lampyris::vectors {

void Translator::instruction(const Instruction& one) {
    if (is_ray_query(one.op)) {
        if (!ray_query(one)) throw NotTranslated(fmt::format("ray query {}", int(one.op)));
        return;
    }
    if (is_atomic(one.op)) return atomic(one);
    switch (one.op) {
        case spv::OpVariable: return;
        case spv::OpAccessChain: return;  // group_loads() has taken it in
        case spv::OpLoad: return load(one);
        case spv::OpStore: return store(one);
        case spv::OpExtInst: return extended(one);
        default: break;
    }
    if (!composite(one) && !arithmetic(one)) throw NotTranslated(fmt::format("instruction {}", int(one.op)));
}

bool Translator::composite(const Instruction& one) {
    const std::vector<uint32_t>& o = one.operands;
    switch (one.op) {
        case spv::OpCopyLogical: set(one, get(o[0]).of); return true;
        case spv::OpCompositeExtract: {
            const std::vector<Value*> from = get(o[0]).of;
            const auto [start, type] = part(type_id(o[0]), o, 1);
            set(one, {from.begin() + start, from.begin() + start + p_.scalars(type)});
            return true;
        }
        case spv::OpCompositeInsert: {
            const std::vector<Value*> inserted = get(o[0]).of;
            std::vector<Value*> whole = get(o[1]).of;
            std::copy(inserted.begin(), inserted.end(), whole.begin() + part(type_id(o[1]), o, 2).first);
            set(one, std::move(whole));
            return true;
        }
        case spv::OpCompositeConstruct: {
            std::vector<Value*> whole;
            for (const uint32_t id : o)
                for (Value* v : get(id).of) whole.push_back(v);
            set(one, std::move(whole));
            return true;
        }
        case spv::OpVectorShuffle: {
            std::vector<Value*> all = get(o[0]).of, chosen;
            for (Value* v : get(o[1]).of) all.push_back(v);
            for (size_t i = 2; i < o.size(); ++i) chosen.push_back(all.at(o[i]));
            set(one, std::move(chosen));
            return true;
        }
        default: return false;
    }
}

}  // namespace lampyris::vectors
