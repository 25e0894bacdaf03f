// A kernel's SPIR-V as LLVM code that runs eight invocations at once, one in each lane of AVX2's vectors.
//
// A value that may differ between invocations is a vector for each of its scalars; others stay scalars. A block runs under a mask of
// the lanes that have come to it, and is skipped if there are none. Phis are variables, into which lanes put their value on the
// way to the block; LLVM makes values of them again.
#pragma once

#include "backends/vectors/spirv_program.h"

#include <embree3/rtcore.h>
#include <llvm/IR/Module.h>

#include <cstdint>
#include <memory>

namespace lampyris {
class EmbreeScene;
}

namespace lampyris::vectors {

constexpr uint32_t kLanes = 8;

// What the code is called with.
struct VectorCall {
    void* const* scene_buffers;
    void* const* kernel_buffers;
    uint32_t* unfinished;
    const EmbreeScene* scene;  // null for kernels that trace no rays
    float largest_ray;         // a ray with larger coordinates hits nothing
};

// Invocations begin + first to begin + first + 7, those from begin + count on left out.
using VectorFunction = void (*)(const VectorCall* call, uint32_t begin, uint32_t count, uint32_t first);
constexpr const char* kFunctionName = "kernel";

// Functions that the code calls. `valid`: -1 for lanes that have a ray. A ray that hits nothing keeps RTC_INVALID_GEOMETRY_ID; others
// get numbers of the scene. An occluded one gets a negative tfar.
using ClosestFunction = void (*)(const VectorCall* call, const int32_t* valid, RTCRayHit8* rays);
using OccludedFunction = void (*)(const VectorCall* call, const int32_t* valid, RTCRay8* rays);
constexpr const char* kClosest = "lampyris_closest";
constexpr const char* kOccluded = "lampyris_occluded";

// Throws NotTranslated.
std::unique_ptr<llvm::Module> lane_code(const Program& program, llvm::LLVMContext& context);

}  // namespace lampyris::vectors
