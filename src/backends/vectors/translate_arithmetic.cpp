// Arithmetic: to the bit what the C++ builds of kernels compute (GLM's minimum, the processor's conversions, no contraction).
#include "backends/vectors/translator.h"

#include <glslang/SPIRV/GLSL.std.450.h>

#include <fmt/format.h>
#include <llvm/IR/IntrinsicsX86.h>

namespace lampyris::vectors {

Value* Translator::compare(spv::Op op, Value* x, Value* y) {
    switch (op) {
        case spv::OpFOrdEqual: return b_.CreateFCmpOEQ(x, y);
        case spv::OpFUnordEqual: return b_.CreateFCmpUEQ(x, y);
        case spv::OpFOrdNotEqual: return b_.CreateFCmpONE(x, y);
        case spv::OpFUnordNotEqual: return b_.CreateFCmpUNE(x, y);
        case spv::OpFOrdLessThan: return b_.CreateFCmpOLT(x, y);
        case spv::OpFOrdGreaterThan: return b_.CreateFCmpOGT(x, y);
        case spv::OpFOrdLessThanEqual: return b_.CreateFCmpOLE(x, y);
        case spv::OpFOrdGreaterThanEqual: return b_.CreateFCmpOGE(x, y);
        case spv::OpFUnordLessThan: return b_.CreateFCmpULT(x, y);
        case spv::OpFUnordGreaterThan: return b_.CreateFCmpUGT(x, y);
        case spv::OpFUnordLessThanEqual: return b_.CreateFCmpULE(x, y);
        case spv::OpFUnordGreaterThanEqual: return b_.CreateFCmpUGE(x, y);
        case spv::OpIEqual: return b_.CreateICmpEQ(x, y);
        case spv::OpINotEqual: return b_.CreateICmpNE(x, y);
        case spv::OpULessThan: return b_.CreateICmpULT(x, y);
        case spv::OpUGreaterThan: return b_.CreateICmpUGT(x, y);
        case spv::OpULessThanEqual: return b_.CreateICmpULE(x, y);
        case spv::OpUGreaterThanEqual: return b_.CreateICmpUGE(x, y);
        case spv::OpSLessThan: return b_.CreateICmpSLT(x, y);
        case spv::OpSGreaterThan: return b_.CreateICmpSGT(x, y);
        case spv::OpSLessThanEqual: return b_.CreateICmpSLE(x, y);
        case spv::OpSGreaterThanEqual: return b_.CreateICmpSGE(x, y);
        default: return nullptr;
    }
}

// As the processor converts, also numbers that do not fit.
Value* Translator::to_integer(Value* x, bool is_unsigned) {
    const bool one = !x->getType()->isVectorTy();
    x = splat(x);
    const auto convert = [&](Value* v) { return b_.CreateIntrinsic(llvm::Intrinsic::x86_avx_cvtt_ps2dq_256, {}, {v}); };
    Value* small = convert(x);
    if (is_unsigned) {  // numbers of 2^31 and more overflow to a negative one
        Value* large = convert(b_.CreateFSub(x, splat(number(2147483648.0f))));
        small = b_.CreateOr(small, b_.CreateAnd(large, b_.CreateAShr(small, splat(b_.getInt32(31)))));
    }
    return one ? b_.CreateExtractElement(small, uint64_t(0)) : small;
}

Value* Translator::calculate(const Instruction& one, llvm::Type* type, const std::vector<Value*>& in) {
    Value* x = in[0];
    Value* y = in.size() > 1 ? in[1] : nullptr;
    if (y)
        if (Value* compared = compare(one.op, x, y)) return as_mask(compared);
    // A lane that is not here may have any divisor, and a division by 0 would end the program.
    const auto divisor = [&] {
        return y->getType()->isVectorTy() ? choose(exec_, y, llvm::ConstantInt::get(y->getType(), 1)) : y;
    };
    const auto bits = [&] { return b_.CreateZExtOrTrunc(y, x->getType()); };
    switch (one.op) {
        case spv::OpFAdd: return b_.CreateFAdd(x, y);
        case spv::OpFSub: return b_.CreateFSub(x, y);
        case spv::OpVectorTimesScalar:
        case spv::OpFMul: return b_.CreateFMul(x, y);
        case spv::OpFDiv: return b_.CreateFDiv(x, y);
        case spv::OpFNegate: return b_.CreateFNeg(x);
        case spv::OpIAdd: return b_.CreateAdd(x, y);
        case spv::OpISub: return b_.CreateSub(x, y);
        case spv::OpIMul: return b_.CreateMul(x, y);
        case spv::OpUDiv: return b_.CreateUDiv(x, divisor());
        case spv::OpUMod: return b_.CreateURem(x, divisor());
        case spv::OpSDiv: return b_.CreateSDiv(x, divisor());
        case spv::OpSRem: return b_.CreateSRem(x, divisor());
        case spv::OpSNegate: return b_.CreateNeg(x);
        case spv::OpBitwiseAnd:
        case spv::OpLogicalAnd: return b_.CreateAnd(x, y);
        case spv::OpBitwiseOr:
        case spv::OpLogicalOr: return b_.CreateOr(x, y);
        case spv::OpLogicalNotEqual:
        case spv::OpBitwiseXor: return b_.CreateXor(x, y);
        case spv::OpLogicalEqual: return b_.CreateNot(b_.CreateXor(x, y));
        case spv::OpNot:
        case spv::OpLogicalNot: return b_.CreateNot(x);
        case spv::OpShiftLeftLogical: return b_.CreateShl(x, bits());
        case spv::OpShiftRightLogical: return b_.CreateLShr(x, bits());
        case spv::OpShiftRightArithmetic: return b_.CreateAShr(x, bits());
        case spv::OpSelect: return choose(x, y, in[2]);
        case spv::OpIsNan: return as_mask(b_.CreateFCmpUNO(x, x));
        case spv::OpConvertUToF: return b_.CreateUIToFP(x, type);
        case spv::OpConvertSToF: return b_.CreateSIToFP(x, type);
        case spv::OpConvertFToU:
            if (type->getScalarSizeInBits() == 64) return b_.CreateFPToUI(x, type);
            return to_integer(x, true);
        case spv::OpConvertFToS:
            if (type->getScalarSizeInBits() == 64) return b_.CreateFPToSI(x, type);
            return to_integer(x, false);
        case spv::OpUConvert: return b_.CreateZExtOrTrunc(x, type);
        case spv::OpBitcast: return b_.CreateBitCast(x, type);
        case spv::OpCopyObject: return x;
        case spv::OpBitReverse: return b_.CreateUnaryIntrinsic(llvm::Intrinsic::bitreverse, x);
        default: return nullptr;
    }
}

bool Translator::arithmetic(const Instruction& one) {
    std::vector<Scalars> in;
    const bool varying = flow_.is_varying(one.result);
    for (const uint32_t id : one.operands) {
        if (!p_.is_value(id)) return false;
        in.push_back(get(id));
        if (varying)
            for (Value*& v : in.back().of) v = v ? splat(v) : nullptr;
    }
    if (in.empty()) return false;
    if (one.op == spv::OpDot) {  // summed in the order of GLM
        Value* sum = b_.CreateFMul(in[0].of[0], in[1].of[0]);
        for (size_t i = 1; i < in[0].of.size(); ++i) sum = b_.CreateFAdd(sum, b_.CreateFMul(in[0].of[i], in[1].of[i]));
        set(one, {sum});
        return true;
    }
    if (one.op == spv::OpUMulExtended) {
        llvm::Type* narrow = in[0].of[0]->getType();
        llvm::Type* twice = varying ? wide(b_.getInt64Ty()) : b_.getInt64Ty();
        Value* product = b_.CreateMul(b_.CreateZExt(in[0].of[0], twice), b_.CreateZExt(in[1].of[0], twice));
        Value* high = b_.CreateLShr(product, llvm::ConstantInt::get(twice, 32));
        set(one, {b_.CreateTrunc(product, narrow), b_.CreateTrunc(high, narrow)});
        return true;
    }
    std::vector<Value*> out;
    for (uint32_t s = 0; s < p_.scalars(one.type); ++s) {
        std::vector<Value*> operands;  // of vectors this component; a scalar goes with each
        for (const Scalars& each : in) operands.push_back(each.of.size() == 1 ? each.of[0] : each.of.at(s));
        Value* v = calculate(one, type_of(p_.scalar_type(one.type, s), varying), operands);
        if (!v) return false;
        out.push_back(v);
    }
    set(one, std::move(out));
    return true;
}

void Translator::extended(const Instruction& one) {
    std::vector<Scalars> in;
    const bool varying = flow_.is_varying(one.result);
    for (const uint32_t id : values_of(one)) in.push_back(get(id));
    const auto less = [&](Value* x, Value* y) {
        switch (one.operands[1]) {
            case GLSLstd450UMin:
            case GLSLstd450UMax:
            case GLSLstd450UClamp: return b_.CreateICmpULT(x, y);
            case GLSLstd450SMin:
            case GLSLstd450SMax:
            case GLSLstd450SClamp: return b_.CreateICmpSLT(x, y);
            default: return b_.CreateFCmpOLT(x, y);
        }
    };
    // Of NaN and a number, GLM's give the first one.
    const auto smaller = [&](Value* x, Value* y) { return b_.CreateSelect(less(y, x), y, x); };
    const auto larger = [&](Value* x, Value* y) { return b_.CreateSelect(less(x, y), y, x); };
    std::vector<Value*> out;
    for (size_t s = 0; s < in[0].of.size(); ++s) {
        std::vector<Value*> a;
        for (const Scalars& each : in) a.push_back(varying ? splat(each.of[s]) : each.of[s]);
        switch (one.operands[1]) {
            case GLSLstd450FAbs: out.push_back(b_.CreateUnaryIntrinsic(llvm::Intrinsic::fabs, a[0])); break;
            case GLSLstd450Sqrt: out.push_back(b_.CreateUnaryIntrinsic(llvm::Intrinsic::sqrt, a[0])); break;
            case GLSLstd450Floor: out.push_back(b_.CreateUnaryIntrinsic(llvm::Intrinsic::floor, a[0])); break;
            case GLSLstd450Ceil: out.push_back(b_.CreateUnaryIntrinsic(llvm::Intrinsic::ceil, a[0])); break;
            case GLSLstd450FMin:
            case GLSLstd450UMin:
            case GLSLstd450SMin: out.push_back(smaller(a[0], a[1])); break;
            case GLSLstd450FMax:
            case GLSLstd450UMax:
            case GLSLstd450SMax: out.push_back(larger(a[0], a[1])); break;
            case GLSLstd450FClamp:
            case GLSLstd450UClamp:
            case GLSLstd450SClamp: out.push_back(smaller(larger(a[0], a[1]), a[2])); break;
            case GLSLstd450SAbs: {
                Value* zero = llvm::Constant::getNullValue(a[0]->getType());
                out.push_back(b_.CreateSelect(b_.CreateICmpSLT(a[0], zero), b_.CreateNeg(a[0]), a[0]));
                break;
            }
            default: throw NotTranslated(fmt::format("function {} of GLSL.std.450", one.operands[1]));
        }
    }
    set(one, std::move(out));
}

}  // namespace lampyris::vectors
