// Loads from buffers. What a block reads of one record, or of neighbouring elements, is read in rows of up to 16 bytes for each
// lane, and transposed.
#include "backends/vectors/translator.h"

#include <functional>

namespace lampyris::vectors {
namespace {

// An index as another one of the block plus a constant.
std::pair<uint32_t, int64_t> without_constants(uint32_t id, const Program& program,
                                               const std::unordered_map<uint32_t, const Instruction*>& here) {
    const auto found = here.find(id);
    if (found == here.end() || found->second->op != spv::OpIAdd) return {id, 0};
    for (size_t side = 0; side < 2; ++side) {
        const uint32_t number = found->second->operands[side];
        if (!program.is_number(number)) continue;
        const auto [base, more] = without_constants(found->second->operands[1 - side], program, here);
        return {base, more + int32_t(program.constant_u32(number))};
    }
    return {id, 0};
}

}  // namespace

void Translator::group_loads(uint32_t place) {
    groups_.clear(), group_of_.clear(), from_groups_.clear(), loaded_groups_.clear();
    std::unordered_map<uint32_t, const Instruction*> here;
    std::map<std::tuple<uint32_t, uint32_t, uint64_t>, uint32_t> known;
    for (const Instruction& one : flow_.block(place).body) {
        if (one.result) here[one.result] = &one;
        if (one.op == spv::OpAccessChain) pointers_[one.result] = chain(one);
        if (one.op != spv::OpLoad || !flow_.is_varying(one.result)) continue;
        Pointer from = pointer(one.operands[0]);
        if (storage(from) != spv::StorageClassStorageBuffer || from.steps.size() != 1) continue;
        bool words = true;
        for (uint32_t s = 0; s < p_.scalars(from.type); ++s)
            words = words && scalar_type(p_.scalar_type(from.type, s))->getPrimitiveSizeInBits() == 32;
        if (!words) continue;
        const auto [base, more] = without_constants(from.steps[0].index, p_, here);
        from.bytes += uint64_t(more * int64_t(from.steps[0].stride));
        from.steps[0].index = base;
        uint32_t group = uint32_t(groups_.size());
        // What the kernel writes is not read in advance.
        if (!written_.contains(from.variable))
            group = known.emplace(std::tuple(from.variable, base, from.steps[0].stride), group).first->second;
        if (group == groups_.size()) groups_.emplace_back();
        groups_[group].push_back({&one, from});
        group_of_[one.result] = group;
    }
}

void Translator::load_group(uint32_t group) {
    if (!loaded_groups_.insert(group).second) return;
    std::map<int64_t, std::vector<std::pair<uint32_t, uint32_t>>> wanted;  // result and scalar, by bytes
    for (const Load& load : groups_[group])
        for (const uint32_t s : used_[load.one->result])
            wanted[int64_t(load.from.bytes) + p_.scalar_offset(load.from.type, s)].emplace_back(load.one->result, s);
    Pointer first = groups_[group][0].from;
    first.bytes = 0;
    std::vector<int64_t> offsets;
    for (const auto& [offset, uses] : wanted) offsets.push_back(offset);
    const std::vector<Value*> words = gather(addresses(first), offsets);
    size_t i = 0;
    for (const auto& [offset, uses] : wanted) {
        for (const auto& [result, s] : uses)
            from_groups_[{result, s}] =
                b_.CreateBitCast(words[i], wide(scalar_type(p_.scalar_type(type_id(result), s))));
        ++i;
    }
}

// Words at several offsets, in ascending order, from each lane's address.
std::vector<Value*> Translator::gather(const std::vector<Value*>& lanes, const std::vector<int64_t>& offsets) {
    std::vector<Value*> result(offsets.size());
    llvm::Type* word = b_.getInt32Ty();
    const auto read = [&](llvm::Type* type, uint32_t l, int64_t offset) -> Value* {
        return b_.CreateAlignedLoad(type, at(lanes[l], uint64_t(offset)), llvm::Align(4));
    };
    const auto mix = [&](Value* a, Value* b, llvm::ArrayRef<int> order) { return b_.CreateShuffleVector(a, b, order); };
    for (size_t i = 0; i < offsets.size();) {
        size_t end = i + 1;
        while (end < offsets.size() && offsets[end] <= offsets[i] + 12) ++end;
        const int64_t first = offsets[i];
        const int64_t span = (offsets[end - 1] - first) / 4 + 1;
        if (end - i == 1) {
            std::vector<Value*> words;
            for (uint32_t l = 0; l < kLanes; ++l) words.push_back(read(word, l, first));
            result[i++] = from_lanes(words);
            continue;
        }
        // Rows of four, of which only the words between the first and the last one that are wanted are read.
        std::vector<Value*> rows(kLanes);
        for (uint32_t l = 0; l < kLanes; ++l) {
            if (span == 4) {
                rows[l] = read(llvm::FixedVectorType::get(word, 4), l, first);
                continue;
            }
            Value* two = read(llvm::FixedVectorType::get(word, 2), l, first);
            rows[l] = b_.CreateShuffleVector(two, llvm::ArrayRef<int>{0, 1, -1, -1});
            if (span == 3) rows[l] = b_.CreateInsertElement(rows[l], read(word, l, first + 8), uint64_t(2));
        }
        Value* pairs[4];  // rows 0 and 4, 1 and 5...
        for (uint32_t k = 0; k < 4; ++k) pairs[k] = mix(rows[k], rows[k + 4], {0, 1, 2, 3, 4, 5, 6, 7});
        Value* columns[4] = {};
        for (int half = 0; half < (span > 2 ? 2 : 1); ++half) {
            const int k = 2 * half;
            const int order[] = {k, k + 8, k + 1, k + 9, k + 4, k + 12, k + 5, k + 13};
            Value *low = mix(pairs[0], pairs[1], order), *high = mix(pairs[2], pairs[3], order);
            columns[k] = mix(low, high, {0, 1, 8, 9, 4, 5, 12, 13});
            columns[k + 1] = mix(low, high, {2, 3, 10, 11, 6, 7, 14, 15});
        }
        for (; i < end; ++i) result[i] = columns[(offsets[i] - first) / 4];
    }
    return result;
}

void Translator::load(const Instruction& one) {
    if (const auto group = group_of_.find(one.result); group != group_of_.end()) {
        load_group(group->second);
        std::vector<Value*> scalars(p_.scalars(one.type));
        for (const uint32_t s : used_[one.result]) scalars[s] = from_groups_.at({one.result, s});
        return set(one, std::move(scalars));
    }
    const Pointer from = pointer(one.operands[0]);
    switch (storage(from)) {
        case spv::StorageClassUniformConstant: return;  // the acceleration structure
        case spv::StorageClassInput: {
            const std::vector<Value*>& all = values_.at(from.variable).of;
            const auto begin = all.begin() + int64_t(from.bytes / 4);
            return set(one, {begin, begin + p_.scalars(one.type)});
        }
        case spv::StorageClassPushConstant: {
            std::vector<Value*> scalars;
            for (uint32_t s = 0; s < p_.scalars(one.type); ++s)
                scalars.push_back(from.bytes + p_.scalar_offset(from.type, s) == 0 ? begin_ : count_);
            return set(one, std::move(scalars));
        }
        case spv::StorageClassFunction:
        case spv::StorageClassPrivate: return set(one, load_local(from));
        case spv::StorageClassStorageBuffer: return set(one, load_buffer(one, from));
        default: throw NotTranslated("a load");
    }
}

std::vector<Value*> Translator::load_buffer(const Instruction& one, const Pointer& from) {
    std::vector<Value*> scalars(p_.scalars(one.type));
    const bool differ = differs(from);
    const std::vector<Value*> lanes = differ ? addresses(from) : std::vector<Value*>{address(from)};
    for (const uint32_t s : used_[one.result]) {
        llvm::Type* type = scalar_type(p_.scalar_type(from.type, s));
        std::vector<Value*> words;
        for (Value* lane : lanes)
            words.push_back(b_.CreateAlignedLoad(type, at(lane, p_.scalar_offset(from.type, s)), llvm::Align(4)));
        scalars[s] = differ ? from_lanes(words) : words[0];
    }
    return scalars;
}

}  // namespace lampyris::vectors
