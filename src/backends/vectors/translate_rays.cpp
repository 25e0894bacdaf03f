// Ray queries: calls of the device's tracer, for eight rays at once.
//
// The tracer tests surfaces that are no triangles by itself. So a query never has a candidate: it has its hit when it begins, and
// proceeds no further.
#include "backends/vectors/translator.h"

#include <limits>

namespace lampyris::vectors {
namespace {

// Vectors of Embree's RTCRayHit8, in their order.
enum Slot : uint32_t {
    kOrigin = 0,
    kNear = 3,
    kDirection = 4,
    kTime = 7,
    kFar = 8,
    kMask = 9,
    kFlags = 11,
    kPrimitive = 17,
    kGeometry = 18,
    kInstance = 19,
    kSlots = 20
};
static_assert(sizeof(RTCRayHit8) == kSlots * 4 * kLanes && offsetof(RTCRayHit8, hit.geomID) == kGeometry * 4 * kLanes);

constexpr uint32_t kTerminateOnFirstHit = 4;  // as GLSL's extension for ray queries has it

}  // namespace

void Translator::trace(const Instruction& one) {
    const std::vector<uint32_t>& o = one.operands;  // query, structure, flags, mask, origin, t_min, direction, t_max
    const bool occlusion = (p_.constant_u32(o[2]) & kTerminateOnFirstHit) != 0;
    const llvm::Align align(4 * kLanes);
    llvm::AllocaInst* rays = local(llvm::ArrayType::get(mask_type(), kSlots), "rays");
    llvm::AllocaInst* valid = local(mask_type(), "valid");
    rays->setAlignment(align), valid->setAlignment(align);
    const auto slot = [&](uint32_t k) { return at(rays, uint64_t(k) * 4 * kLanes); };
    const auto put = [&](uint32_t k, Value* v) { b_.CreateAlignedStore(splat(v), slot(k), align); };
    const auto take = [&](uint32_t k, llvm::Type* type) { return b_.CreateAlignedLoad(wide(type), slot(k), align); };

    const std::vector<Value*> origin = wide_of(o[4]), direction = wide_of(o[6]);
    Value* t_max = wide_of(o[7])[0];
    // Embree ends the program for a ray that is not finite or reaches too far. It hits nothing.
    Value* largest = splat(b_.CreateLoad(b_.getFloatTy(), at(call_, offsetof(VectorCall, largest_ray))));
    Value* here = b_.CreateAnd(exec_, as_mask(b_.CreateFCmpOGE(t_max, splat(number(0.0f)))));
    for (const std::vector<Value*>& v : {origin, direction})
        for (Value* x : v)
            here = b_.CreateAnd(here,
                                as_mask(b_.CreateFCmpOLE(b_.CreateUnaryIntrinsic(llvm::Intrinsic::fabs, x), largest)));
    here = b_.CreateFreeze(here);
    b_.CreateAlignedStore(here, valid, align);
    for (uint32_t k = 0; k < 3; ++k) put(kOrigin + k, origin[k]), put(kDirection + k, direction[k]);
    put(kNear, number(std::numeric_limits<float>::min()));  // hits at 0 do not count
    put(kTime, number(0.0f));
    put(kFar, t_max);
    put(kMask, b_.getInt32(~0u));
    put(kFlags, b_.getInt32(0));
    put(kGeometry, b_.getInt32(RTC_INVALID_GEOMETRY_ID));
    put(kInstance, b_.getInt32(RTC_INVALID_GEOMETRY_ID));
    b_.CreateCall(module_->getOrInsertFunction(occlusion ? kOccluded : kClosest, b_.getVoidTy(), b_.getPtrTy(),
                                               b_.getPtrTy(), b_.getPtrTy()),
                  {call_, valid, rays});
    if (occlusion) {
        Value* occluded = as_mask(b_.CreateFCmpOLT(take(kFar, b_.getFloatTy()), splat(number(0.0f))));
        hits_[o[0]] = {b_.CreateAnd(here, occluded)};
    } else {
        Value* none = splat(b_.getInt32(RTC_INVALID_GEOMETRY_ID));
        Value *geometry = take(kGeometry, b_.getInt32Ty()), *instance = take(kInstance, b_.getInt32Ty());
        Value* outside =
            as_mask(b_.CreateICmpEQ(instance, none));  // of instances: the scene itself, which has number 0
        hits_[o[0]] = {as_mask(b_.CreateICmpNE(geometry, none)), b_.CreateAnd(instance, b_.CreateNot(outside)),
                       geometry, take(kPrimitive, b_.getInt32Ty())};
    }
    traced_at_[o[0]] = place_;
}

bool Translator::ray_query(const Instruction& one) {
    if (one.op == spv::OpRayQueryInitializeKHR) {
        trace(one);
        return true;
    }
    if (one.op == spv::OpRayQueryProceedKHR) {
        set(one, {b_.getFalse()});
        return true;
    }
    if (one.op == spv::OpRayQueryGenerateIntersectionKHR) return true;
    // Of a candidate, which there is never, any answer will do.
    const auto unknown = [&] {
        std::vector<Value*> scalars;
        for (uint32_t s = 0; s < p_.scalars(one.type); ++s)
            scalars.push_back(llvm::Constant::getNullValue(type_of(p_.scalar_type(one.type, s), false)));
        set(one, std::move(scalars));
        return true;
    };
    if (one.op == spv::OpRayQueryGetIntersectionObjectRayOriginKHR ||
        one.op == spv::OpRayQueryGetIntersectionObjectRayDirectionKHR || one.op == spv::OpRayQueryGetIntersectionTKHR)
        return unknown();
    if (p_.constant_u32(one.operands[1]) == 0) return unknown();
    const uint32_t query = one.operands[0];
    const auto hit = hits_.find(query);
    const auto traced = traced_at_.find(query);
    if (hit == hits_.end() || !flow_.dominates(traced->second, place_) ||
        flow_.is_behind_loop_of(traced->second, place_))
        throw NotTranslated("a ray query that is read where it may not have begun");
    const std::vector<Value*>& of = hit->second;
    size_t wanted = 0;
    switch (one.op) {
        case spv::OpRayQueryGetIntersectionTypeKHR:  // 0: none, 1: a triangle
            set(one, {b_.CreateAnd(of[0], splat(b_.getInt32(1)))});
            return true;
        case spv::OpRayQueryGetIntersectionInstanceShaderBindingTableRecordOffsetKHR: wanted = 1; break;
        case spv::OpRayQueryGetIntersectionInstanceCustomIndexKHR: wanted = 2; break;
        case spv::OpRayQueryGetIntersectionPrimitiveIndexKHR: wanted = 3; break;
        default: return false;
    }
    if (of.size() == 1) return unknown();  // whether a ray is occluded is all that is known of it
    set(one, {of[wanted]});
    return true;
}

}  // namespace lampyris::vectors
