// Values: types, constants, masks, and values that are needed behind a loop.
#include "backends/vectors/translator.h"

#include <fmt/format.h>
#include <llvm/IR/IntrinsicsX86.h>

namespace lampyris::vectors {

llvm::Type* Translator::scalar_type(uint32_t type) {
    const Type& t = p_.type(type);
    if (t.op == spv::OpTypeBool) return b_.getInt1Ty();
    if (t.op == spv::OpTypeInt) return b_.getIntNTy(t.width);
    if (t.op == spv::OpTypeFloat && t.width == 32) return b_.getFloatTy();
    throw NotTranslated("a scalar that is no bool, integer or float of 32 bits");
}

llvm::Type* Translator::type_of(uint32_t type, bool varying) {
    llvm::Type* scalar = scalar_type(type);
    if (!varying) return scalar;
    return scalar->isIntegerTy(1) ? mask_type() : wide(scalar);
}

Value* Translator::splat(Value* v) {
    if (v->getType()->isVectorTy()) return v;
    if (v->getType()->isIntegerTy(1)) v = b_.CreateSExt(v, b_.getInt32Ty());
    return b_.CreateVectorSplat(kLanes, v);
}

Value* Translator::as_mask(Value* compared) {
    return compared->getType()->isVectorTy() ? b_.CreateSExt(compared, mask_type()) : compared;
}

Value* Translator::choose(Value* mask, Value* yes, Value* no) {
    if (!mask->getType()->isVectorTy()) return b_.CreateSelect(mask, yes, no);
    if (llvm::isa<llvm::PoisonValue>(no)) return yes;
    if (yes->getType()->getScalarSizeInBits() != 32)
        return b_.CreateSelect(b_.CreateICmpSLT(mask, llvm::Constant::getNullValue(mask_type())), yes, no);
    // By the sign of each word, which a selection by bits would first have to find.
    llvm::Type* floats = wide(b_.getFloatTy());
    Value* chosen = b_.CreateIntrinsic(
        llvm::Intrinsic::x86_avx_blendv_ps_256, {},
        {b_.CreateBitCast(no, floats), b_.CreateBitCast(yes, floats), b_.CreateBitCast(mask, floats)});
    return b_.CreateBitCast(chosen, yes->getType());
}

Value* Translator::signs(Value* mask) {
    return b_.CreateIntrinsic(llvm::Intrinsic::x86_avx_movmsk_ps_256, {},
                              {b_.CreateBitCast(mask, wide(b_.getFloatTy()))});
}

Scalars Translator::constant(uint32_t id) {
    const Instruction& one = p_.constants.at(id);
    Scalars result;
    if (one.op == spv::OpConstantComposite) {
        for (const uint32_t part : one.operands)
            for (Value* v : constant(part).of) result.of.push_back(v);
        return result;
    }
    for (uint32_t i = 0; i < p_.scalars(one.type); ++i) {
        llvm::Type* type = scalar_type(p_.scalar_type(one.type, i));
        switch (one.op) {
            case spv::OpUndef: result.of.push_back(llvm::PoisonValue::get(type)); break;
            case spv::OpConstantNull: result.of.push_back(llvm::Constant::getNullValue(type)); break;
            case spv::OpConstantTrue: result.of.push_back(b_.getTrue()); break;
            case spv::OpConstantFalse: result.of.push_back(b_.getFalse()); break;
            default: {
                uint64_t word = one.operands[0];
                if (one.operands.size() > 1) word |= uint64_t(one.operands[1]) << 32u;
                result.of.push_back(
                    type->isFloatTy()
                        ? llvm::ConstantFP::get(c_, llvm::APFloat(llvm::APFloat::IEEEsingle(), llvm::APInt(32, word)))
                        : llvm::ConstantInt::get(type, word));
            }
        }
    }
    return result;
}

Scalars Translator::get_at(uint32_t id, uint32_t place) {
    if (p_.is_constant(id)) return constant(id);
    if (flow_.outlives_loop(id) && flow_.is_behind_loop(id, place)) {
        Scalars result;
        for (llvm::AllocaInst* kept : outlived_.at(id))
            result.of.push_back(kept ? b_.CreateLoad(kept->getAllocatedType(), kept) : nullptr);
        return result;
    }
    const auto found = values_.find(id);
    if (found == values_.end()) throw NotTranslated(fmt::format("a use of %{} before its definition", id));
    return found->second;
}

std::vector<Value*> Translator::wide_of(uint32_t id) {
    Scalars s = get(id);
    for (Value*& v : s.of) v = v ? splat(v) : nullptr;
    return s.of;
}

void Translator::set(const Instruction& one, std::vector<Value*> scalars) {
    if (flow_.is_varying(one.result))
        for (Value*& v : scalars) v = v ? splat(v) : nullptr;
    // A lane that has left the loop keeps what it had.
    if (flow_.outlives_loop(one.result)) {
        std::vector<llvm::AllocaInst*>& kept = outlived_[one.result];
        if (kept.empty())
            for (Value* v : scalars) kept.push_back(v ? local(v->getType(), "outlived") : nullptr);
        for (size_t i = 0; i < scalars.size(); ++i)
            if (scalars[i])
                b_.CreateStore(choose(exec_, scalars[i], b_.CreateLoad(scalars[i]->getType(), kept[i])), kept[i]);
    }
    values_[one.result] = {std::move(scalars)};
}

std::pair<uint32_t, uint32_t> Translator::part(uint32_t type, const std::vector<uint32_t>& operands,
                                               size_t first) const {
    uint32_t start = 0;
    for (size_t i = first; i < operands.size(); ++i) {
        start += p_.member_start(type, operands[i]);
        type = p_.member_type(type, operands[i]);
    }
    return {start, type};
}

// Which scalars of values are used, so that of a record that is loaded, only these are; and which buffers are written.
void Translator::find_uses() {
    std::set<uint32_t> whole;
    const auto all = [&](uint32_t id) {
        if (p_.is_value(id)) whole.insert(id);
    };
    std::unordered_map<uint32_t, uint32_t> variables;  // by pointer
    for (uint32_t place = 0; place < flow_.places.size(); ++place) {
        const Block& block = flow_.block(place);
        for (const Instruction& phi : block.phis)
            for (const uint32_t id : values_of(phi)) all(id);
        for (const Instruction& one : block.body) {
            if (one.op == spv::OpAccessChain) {
                const auto before = variables.find(one.operands[0]);
                variables[one.result] = before == variables.end() ? one.operands[0] : before->second;
            }
            if (one.op == spv::OpStore || is_atomic(one.op)) {
                const auto known = variables.find(one.operands[0]);
                written_.insert(known == variables.end() ? one.operands[0] : known->second);
            }
            if (one.op == spv::OpCompositeExtract || one.op == spv::OpCopyLogical) continue;
            for (const uint32_t id : values_of(one)) all(id);
        }
        for (const uint32_t id : values_of(block.end)) all(id);
    }
    for (const uint32_t id : whole)
        for (uint32_t i = 0; i < p_.scalars(type_id(id)); ++i) used_[id].insert(i);
    // Backwards through extractions and copies: what they are made of comes before them.
    for (uint32_t place = uint32_t(flow_.places.size()); place-- > 0;) {
        const std::vector<Instruction>& body = flow_.block(place).body;
        for (auto one = body.rbegin(); one != body.rend(); ++one) {
            if (one->op != spv::OpCompositeExtract && one->op != spv::OpCopyLogical) continue;
            uint32_t start = 0;
            if (one->op == spv::OpCompositeExtract) start = part(type_id(one->operands[0]), one->operands, 1).first;
            for (const uint32_t i : used_[one->result]) used_[one->operands[0]].insert(start + i);
        }
    }
}

}  // namespace lampyris::vectors
