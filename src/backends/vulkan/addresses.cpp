#include "backends/vulkan/addresses.h"

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

namespace lampyris::vulkan {
namespace {

using shaders::for_each_instruction;
using shaders::is_annotation;
using shaders::kHeaderWords;
using shaders::precedes_annotations;

// The lowest set bit of a number: all multiples of the number are aligned to it.
uint32_t low_bit(uint32_t x) { return x & (~x + 1); }

class Rewriting {
 public:
    Rewriting(const Spirv& spirv, std::span<const ShaderBinding> bindings) : spirv_(spirv), next_id_(spirv.at(3)) {
        read();
        for (const auto& [variable, type] : storage_variables_) {
            const auto set = sets_.find(variable), binding = bindings_.find(variable);
            if (set == sets_.end() || binding == bindings_.end()) continue;
            const auto wanted = std::find_if(bindings.begin(), bindings.end(), [&](const ShaderBinding& b) {
                return b.set == set->second && b.binding == binding->second;
            });
            if (wanted == bindings.end()) continue;
            replaced_[variable] = {uint32_t(wanted - bindings.begin()), type};
        }
        if (replaced_.size() != bindings.size() || range_variable_ == 0)
            throw std::logic_error("a kernel lacks a buffer that is to be addressed, or its range");
        addresses_ = uint32_t(bindings.size());
    }

    Spirv run() {
        Spirv head(spirv_.begin(), spirv_.begin() + kHeaderWords), body;
        bool capable = false, decorated = false, inside = false;
        for_each_instruction(spirv_, [&](spv::Op op, const uint32_t* words, uint32_t count) {
            if (!capable && op != spv::OpCapability) {
                add_capabilities(head);
                capable = true;
            }
            if (!decorated && !precedes_annotations(op) && !is_annotation(op)) {
                for (uint32_t i = 0; i < 2 * addresses_; ++i)
                    emit(head, spv::OpMemberDecorate,
                         {range_struct_, 2 + i, spv::DecorationOffset, uint32_t(sizeof(KernelRange)) + 4 * i});
                decorated = true;
            }
            inside = inside || op == spv::OpFunction;
            if (inside)
                rewrite(body, op, words, count);
            else
                declare(head, op, words, count);
        });
        head.insert(head.end(), globals_.begin(), globals_.end());
        head.insert(head.end(), body.begin(), body.end());
        head[3] = next_id_;
        return head;
    }

 private:
    using Words = std::vector<uint32_t>;
    struct Replaced {
        uint32_t number, pointer_type;  // index among the addresses; pointer type of the variable
    };
    struct Pointer {
        uint32_t alignment, type;  // of the data that it points to
    };

    void read() {
        for_each_instruction(spirv_, [&](spv::Op op, const uint32_t* words, uint32_t count) {
            const auto operands = [&](uint32_t from) { return Words(words + from, words + count); };
            switch (op) {
                case spv::OpCapability: capabilities_.insert(words[1]); break;
                case spv::OpDecorate:
                    if (words[2] == spv::DecorationDescriptorSet) sets_[words[1]] = words[3];
                    if (words[2] == spv::DecorationBinding) bindings_[words[1]] = words[3];
                    if (words[2] == spv::DecorationArrayStride) strides_[words[1]] = words[3];
                    break;
                case spv::OpMemberDecorate:
                    if (words[3] == spv::DecorationOffset) offsets_[{words[1], words[2]}] = words[4];
                    break;
                case spv::OpTypeInt:
                case spv::OpTypeFloat:
                case spv::OpTypeVector:
                case spv::OpTypeArray:
                case spv::OpTypeRuntimeArray:
                case spv::OpTypeStruct:
                case spv::OpTypePointer:
                    types_[words[1]] = {op, operands(2)};
                    known_.emplace(std::pair(op, operands(2)), words[1]);
                    break;
                case spv::OpConstant:
                    if (count == 4) constants_[words[2]] = words[3];
                    known_.emplace(std::pair(op, constant_key(words, count)), words[2]);
                    break;
                case spv::OpVariable:
                    if (words[3] == spv::StorageClassStorageBuffer) storage_variables_[words[2]] = words[1];
                    if (words[3] == spv::StorageClassPushConstant) {
                        range_variable_ = words[2];
                        range_struct_ = types_.at(words[1]).second.at(1);
                    }
                    break;
                default: break;
            }
        });
    }

    static Words constant_key(const uint32_t* words, uint32_t count) {
        Words key{words[1]};
        key.insert(key.end(), words + 3, words + count);
        return key;
    }

    static void emit(Words& out, spv::Op op, const Words& operands) {
        out.push_back(uint32_t(operands.size() + 1) << 16 | uint32_t(op));
        out.insert(out.end(), operands.begin(), operands.end());
    }

    // The type with these operands; SPIR-V does not allow a second declaration of the same type.
    uint32_t type(spv::Op op, const Words& operands) {
        const auto [found, is_new] = known_.emplace(std::pair(op, operands), next_id_);
        if (is_new) {
            Words words{next_id_++};
            words.insert(words.end(), operands.begin(), operands.end());
            emit(globals_, op, words);
        }
        return found->second;
    }
    uint32_t constant(uint32_t of_type, Words value) {
        value.insert(value.begin(), of_type);
        const auto [found, is_new] = known_.emplace(std::pair(spv::OpConstant, value), next_id_);
        if (is_new) {
            value.insert(value.begin() + 1, next_id_++);
            emit(globals_, spv::OpConstant, value);
        }
        return found->second;
    }
    uint32_t word_type() { return type(spv::OpTypeInt, {32, 0}); }
    uint32_t address_type() { return type(spv::OpTypeInt, {64, 0}); }
    uint32_t pointer_to(uint32_t pointee) {
        return type(spv::OpTypePointer, {spv::StorageClassPhysicalStorageBuffer, pointee});
    }

    void add_capabilities(Words& out) const {
        for (const spv::Capability wanted : {spv::CapabilityInt64, spv::CapabilityPhysicalStorageBufferAddresses})
            if (!capabilities_.count(wanted)) emit(out, spv::OpCapability, {uint32_t(wanted)});
    }

    // Instructions before the first function.
    void declare(Words& out, spv::Op op, const uint32_t* words, uint32_t count) const {
        const bool names_one = (op == spv::OpName || op == spv::OpDecorate) && replaced_.count(words[1]);
        if (names_one || (op == spv::OpVariable && replaced_.count(words[2]))) return;
        if (op == spv::OpMemoryModel) return emit(out, op, {spv::AddressingModelPhysicalStorageBuffer64, words[2]});
        if (op == spv::OpEntryPoint) {
            Words kept(words + 1, words + count);
            const auto interface = std::find_if(kept.begin() + 2, kept.end(), [](uint32_t word) {
                return word >> 24 == 0;  // a zero in the last byte ends the name
            });
            kept.erase(std::remove_if(interface + 1, kept.end(), [&](uint32_t id) { return replaced_.count(id) != 0; }),
                       kept.end());
            return emit(out, op, kept);
        }
        if (op == spv::OpTypeStruct && words[1] == range_struct_) {
            Words longer(words + 1, words + count);
            longer.insert(longer.end(), 2 * size_t(addresses_), words[2]);  // its members are words
            return emit(out, op, longer);
        }
        out.insert(out.end(), words, words + count);
    }

    void rewrite(Words& out, spv::Op op, const uint32_t* words, uint32_t count) {
        switch (op) {
            case spv::OpAccessChain:
            case spv::OpInBoundsAccessChain:
                if (const auto found = replaced_.find(words[3]); found != replaced_.end())
                    return point(out, words, count, found->second);
                if (const auto found = pointers_.find(words[3]); found != pointers_.end())
                    return go_on(out, words[1], words[2], words[3], found->second, words + 4, count - 4);
                break;
            case spv::OpLoad:
                if (const auto found = pointers_.find(words[3]); found != pointers_.end())
                    return aligned(out, op, words, count, 4, found->second.alignment);
                break;
            case spv::OpStore:
                if (const auto found = pointers_.find(words[1]); found != pointers_.end())
                    return aligned(out, op, words, count, 3, found->second.alignment);
                break;
            case spv::OpPhi:
            case spv::OpSelect:
            case spv::OpCopyObject:
            case spv::OpCopyMemory:
            case spv::OpArrayLength:
            case spv::OpFunctionCall:
                for (uint32_t i = 2; i < count; ++i)
                    if (pointers_.count(words[i]) || replaced_.count(words[i]))
                        throw std::logic_error("a kernel hands a place in a buffer on, which cannot be addressed");
                break;
            default: break;
        }
        out.insert(out.end(), words, words + count);
    }

    // variable, 0, index, ...: the address plus index times the stride, then the rest of the chain from there.
    void point(Words& out, const uint32_t* words, uint32_t count, const Replaced& variable) {
        if (count < 6) throw std::logic_error("a kernel takes a buffer as a whole, which cannot be addressed");
        const uint32_t block = types_.at(variable.pointer_type).second.at(1);
        const uint32_t array = types_.at(block).second.at(constants_.at(words[4]));
        const uint32_t element = types_.at(array).second.at(0), stride = strides_.at(array);
        const uint32_t u64 = address_type();
        const uint32_t pair = type(spv::OpTypeVector, {word_type(), 2});
        const uint32_t halves = next_id_++, base = next_id_++, index = next_id_++, offset = next_id_++,
                       place = next_id_++;
        const uint32_t low = load_word(out, 2 + 2 * variable.number), high = load_word(out, 3 + 2 * variable.number);
        emit(out, spv::OpCompositeConstruct, {pair, halves, low, high});
        emit(out, spv::OpBitcast, {u64, base, halves});
        emit(out, spv::OpUConvert, {u64, index, words[5]});
        emit(out, spv::OpIMul, {u64, offset, index, constant(u64, {stride, 0})});
        emit(out, spv::OpIAdd, {u64, place, base, offset});
        const Pointer pointer{std::min(kAddressAlignment, low_bit(stride)), element};
        const bool ends = count == 6;
        const uint32_t id = ends ? words[2] : next_id_++;
        emit(out, spv::OpConvertUToPtr, {pointer_to(element), id, place});
        pointers_[id] = pointer;
        if (!ends) go_on(out, words[1], words[2], id, pointer, words + 6, count - 6);
    }

    uint32_t load_word(Words& out, uint32_t member) {
        const uint32_t place = next_id_++, value = next_id_++;
        emit(out, spv::OpAccessChain,
             {type(spv::OpTypePointer, {spv::StorageClassPushConstant, word_type()}), place, range_variable_,
              constant(word_type(), {member})});
        emit(out, spv::OpLoad, {word_type(), value, place});
        return value;
    }

    // An access chain from an address on.
    void go_on(Words& out, uint32_t pointer_type, uint32_t id, uint32_t base, Pointer pointer, const uint32_t* indices,
               uint32_t count) {
        Words operands{pointer_to(types_.at(pointer_type).second.at(1)), id, base};
        for (uint32_t i = 0; i < count; ++i) {
            operands.push_back(indices[i]);
            pointer = step(pointer, indices[i]);
        }
        emit(out, spv::OpAccessChain, operands);
        pointers_[id] = pointer;
    }

    Pointer step(const Pointer& pointer, uint32_t index) const {
        const auto& [op, operands] = types_.at(pointer.type);
        uint32_t multiple = 0, member = 0;
        if (op == spv::OpTypeStruct) {
            const uint32_t which = constants_.at(index);
            multiple = offsets_.at({pointer.type, which});
            member = operands.at(which);
        } else {
            member = operands.at(0);
            multiple = op == spv::OpTypeVector ? types_.at(member).second.at(0) / 8 : strides_.at(pointer.type);
        }
        return {multiple ? std::min(pointer.alignment, low_bit(multiple)) : pointer.alignment, member};
    }

    // A load or store, with an alignment added to its memory operands (from word `at`).
    static void aligned(Words& out, spv::Op op, const uint32_t* words, uint32_t count, uint32_t at,
                        uint32_t alignment) {
        Words operands(words + 1, words + std::min(at, count));
        const uint32_t mask = count > at ? words[at] : 0;
        operands.push_back(mask | uint32_t(spv::MemoryAccessAlignedMask));
        operands.push_back(alignment);
        const uint32_t rest = at + 1 + ((mask & uint32_t(spv::MemoryAccessAlignedMask)) != 0);
        if (count > rest) operands.insert(operands.end(), words + rest, words + count);
        emit(out, op, operands);
    }

    const Spirv& spirv_;
    uint32_t next_id_;
    std::set<uint32_t> capabilities_;
    std::map<uint32_t, uint32_t> sets_, bindings_, strides_, constants_, storage_variables_;
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> offsets_;  // (struct, member)
    std::map<uint32_t, std::pair<spv::Op, Words>> types_;
    std::map<std::pair<spv::Op, Words>, uint32_t> known_;  // types and constants, by their definitions
    uint32_t range_variable_ = 0, range_struct_ = 0, addresses_ = 0;
    std::map<uint32_t, Replaced> replaced_;
    std::map<uint32_t, Pointer> pointers_;  // pointers into the replaced buffers
    Words globals_;
};

}  // namespace

Spirv address_buffers(const Spirv& spirv, std::span<const ShaderBinding> bindings) {
    if (bindings.empty()) return spirv;
    return Rewriting(spirv, bindings).run();
}

}  // namespace lampyris::vulkan
