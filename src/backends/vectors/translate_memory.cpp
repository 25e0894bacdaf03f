// Memory: pointers, stores, atomic operations and local variables.
#include "backends/vectors/translator.h"

#include <llvm/IR/IntrinsicsX86.h>

namespace lampyris::vectors {

uint32_t Translator::words_before(uint32_t type, uint32_t scalar) const {
    uint32_t sum = 0;
    for (uint32_t i = 0; i < scalar; ++i) sum += p_.type(p_.scalar_type(type, i)).width == 64 ? 2 : 1;
    return sum;
}

bool Translator::is_local(const Pointer& pointer) const {
    return storage(pointer) == spv::StorageClassFunction || storage(pointer) == spv::StorageClassPrivate;
}

Pointer Translator::pointer(uint32_t id) const {
    if (const auto found = pointers_.find(id); found != pointers_.end()) return found->second;
    const auto variable = p_.variables.find(id);
    if (variable == p_.variables.end()) throw NotTranslated("a pointer that is neither a variable nor a part of one");
    Pointer result;
    result.variable = id;
    result.type = p_.type(variable->second.type).element;
    return result;
}

Pointer Translator::chain(const Instruction& one) const {
    Pointer result = pointer(one.operands[0]);
    const bool by_words = is_local(result) || storage(result) == spv::StorageClassInput;
    const uint64_t word = is_local(result) ? 4 * kLanes : 4;
    for (size_t i = 1; i < one.operands.size(); ++i) {
        const uint32_t index = one.operands[i];
        const Type& type = p_.type(result.type);
        uint64_t stride = type.stride;
        if (by_words)
            stride = type.element ? words_before(type.element, p_.scalars(type.element)) * word : 0;
        else if (type.op == spv::OpTypeVector)
            stride = p_.type(type.element).width / 8;
        if (type.op == spv::OpTypeStruct) {
            const uint32_t member = p_.constant_u32(index);
            result.bytes += by_words ? words_before(result.type, p_.member_start(result.type, member)) * word
                                     : type.offsets.at(member);
            result.type = type.members[member];
            continue;
        }
        if (stride == 0) throw NotTranslated("an element of something without a stride");
        if (p_.is_constant(index))
            result.bytes += p_.constant_u32(index) * stride;
        else
            result.steps.push_back({index, stride});
        result.type = type.element;
    }
    return result;
}

bool Translator::differs(const Pointer& pointer) {
    for (const Pointer::Step& step : pointer.steps)
        if (flow_.is_varying(step.index)) return true;
    return false;
}

Value* Translator::active_lane() {
    if (!active_lane_)
        active_lane_ = splat(b_.CreateBinaryIntrinsic(llvm::Intrinsic::cttz, signs(exec_), b_.getTrue()));
    return active_lane_;
}

Value* Translator::address(const Pointer& pointer) {
    Value* offset = b_.getInt64(pointer.bytes);
    for (const Pointer::Step& step : pointer.steps) {
        Value* index = get(step.index).of[0];
        if (index->getType()->isVectorTy()) continue;
        offset = b_.CreateAdd(offset, b_.CreateMul(b_.CreateZExt(index, b_.getInt64Ty()), b_.getInt64(step.stride)));
    }
    return b_.CreateGEP(b_.getInt8Ty(), base(pointer.variable), offset);
}

// A lane that is not here may have any index: it gets that of one that is.
std::vector<Value*> Translator::addresses(const Pointer& pointer) {
    std::vector<Value*> result(kLanes, address(pointer));
    for (const Pointer::Step& step : pointer.steps) {
        Value* index = get(step.index).of[0];
        if (!index->getType()->isVectorTy()) continue;
        Value* of_active = b_.CreateIntrinsic(llvm::Intrinsic::x86_avx2_permd, {}, {index, active_lane()});
        index = choose(exec_, index, of_active);
        for (uint32_t l = 0; l < kLanes; ++l) {
            Value* element = b_.CreateZExt(b_.CreateExtractElement(index, l), b_.getInt64Ty());
            result[l] = b_.CreateGEP(b_.getInt8Ty(), result[l],
                                     b_.CreateMul(element, b_.getInt64(step.stride), "", true, true));
        }
    }
    return result;
}

Value* Translator::from_lanes(const std::vector<Value*>& lanes) {
    Value* v = llvm::PoisonValue::get(wide(lanes[0]->getType()));
    for (uint32_t l = 0; l < kLanes; ++l) v = b_.CreateInsertElement(v, lanes[l], l);
    return v;
}

std::vector<Value*> Translator::load_local(const Pointer& from) {
    std::vector<Value*> result;
    const bool differ = differs(from);
    const std::vector<Value*> lanes = addresses(from);
    for (uint32_t s = 0; s < p_.scalars(from.type); ++s) {
        llvm::Type* stored = type_of(p_.scalar_type(from.type, s), true);
        const uint64_t offset = uint64_t(words_before(from.type, s)) * kLanes * 4;
        if (!differ) {
            result.push_back(b_.CreateAlignedLoad(stored, at(lanes[0], offset), llvm::Align(4 * kLanes)));
            continue;
        }
        const uint64_t size = stored->getScalarSizeInBits() / 8;
        std::vector<Value*> words;
        for (uint32_t l = 0; l < kLanes; ++l)
            words.push_back(
                b_.CreateAlignedLoad(stored->getScalarType(), at(lanes[l], offset + l * size), llvm::Align(4)));
        result.push_back(from_lanes(words));
    }
    return result;
}

void Translator::store_local(const Pointer& to, const std::vector<Value*>& scalars) {
    const auto offset = [&](uint32_t s) { return uint64_t(words_before(to.type, s)) * kLanes * 4; };
    const std::vector<Value*> lanes = addresses(to);
    if (differs(to)) {
        for_active_lanes([&](uint32_t l) {
            for (uint32_t s = 0; s < scalars.size(); ++s) {
                Value* v = b_.CreateExtractElement(splat(scalars[s]), l);
                const uint64_t size = v->getType()->getPrimitiveSizeInBits() / 8;
                b_.CreateAlignedStore(v, at(lanes[l], offset(s) + l * size), llvm::Align(4));
            }
        });
        return;
    }
    for (uint32_t s = 0; s < scalars.size(); ++s) {
        Value* place = at(lanes[0], offset(s));
        Value* v = splat(scalars[s]);
        Value* old = b_.CreateAlignedLoad(v->getType(), place, llvm::Align(4 * kLanes));
        b_.CreateAlignedStore(choose(exec_, v, old), place, llvm::Align(4 * kLanes));
    }
}

void Translator::store(const Instruction& one) {
    const Pointer to = pointer(one.operands[0]);
    const Scalars value = get(one.operands[1]);
    if (is_local(to)) return store_local(to, value.of);
    if (storage(to) != spv::StorageClassStorageBuffer) throw NotTranslated("a store that is into no buffer");
    const std::vector<Value*> lanes = addresses(to);
    for_active_lanes([&](uint32_t l) {
        for (uint32_t s = 0; s < value.of.size(); ++s) {
            Value* v = value.of[s];
            if (v->getType()->isVectorTy()) v = b_.CreateExtractElement(v, l);
            b_.CreateAlignedStore(v, at(lanes[l], p_.scalar_offset(to.type, s)), llvm::Align(4));
        }
    });
}

void Translator::atomic(const Instruction& one) {
    llvm::AtomicRMWInst::BinOp op;
    switch (one.op) {
        case spv::OpAtomicIAdd: op = llvm::AtomicRMWInst::Add; break;
        case spv::OpAtomicOr: op = llvm::AtomicRMWInst::Or; break;
        case spv::OpAtomicUMax: op = llvm::AtomicRMWInst::UMax; break;
        case spv::OpAtomicExchange: op = llvm::AtomicRMWInst::Xchg; break;
        default: throw NotTranslated("an atomic operation");
    }
    const std::vector<Value*> lanes = addresses(pointer(one.operands[0]));
    Value* value = splat(get(one.operands[3]).of[0]);
    llvm::AllocaInst* before = local(value->getType(), "before");
    const llvm::Align align(value->getType()->getScalarSizeInBits() / 8);
    for_active_lanes([&](uint32_t l) {
        Value* old =
            b_.CreateAtomicRMW(op, lanes[l], b_.CreateExtractElement(value, l), align, llvm::AtomicOrdering::Monotonic);
        b_.CreateStore(b_.CreateInsertElement(b_.CreateLoad(value->getType(), before), old, l), before);
    });
    set(one, {b_.CreateLoad(value->getType(), before)});
}

}  // namespace lampyris::vectors
