#include "backends/vectors/vector_kernel.h"

#include "accel/rays/embree_scene.h"
#include "backends/vectors/lane_code.h"
#include "backends/vulkan/shader_compiler.h"

#include <llvm/ExecutionEngine/Orc/LLJIT.h>
#include <llvm/Passes/PassBuilder.h>
#include <llvm/Support/Host.h>
#include <llvm/Support/TargetSelect.h>
#include <llvm/Target/TargetMachine.h>

#include <limits>

namespace lampyris::vectors {
namespace {

void closest(const VectorCall* call, const int32_t* valid, RTCRayHit8* rays) {
    if (call->packets) return call->packets->closest8(valid, *rays);
    const RTCRay8& r = rays->ray;
    for (uint32_t l = 0; l < kLanes; ++l) {
        if (!valid[l]) continue;
        const float origin[3] = {r.org_x[l], r.org_y[l], r.org_z[l]},
                    direction[3] = {r.dir_x[l], r.dir_y[l], r.dir_z[l]};
        TraceHit hit{};
        if (!call->tracer->closest(call->tracer->scene, origin, direction, r.tfar[l], hit)) continue;
        rays->hit.instID[0][l] = hit.instance;
        rays->hit.geomID[l] = hit.geometry;
        rays->hit.primID[l] = hit.primitive;
    }
}

void occluded(const VectorCall* call, const int32_t* valid, RTCRay8* rays) {
    if (call->packets) return call->packets->occluded8(valid, *rays);
    RTCRay8& r = *rays;
    for (uint32_t l = 0; l < kLanes; ++l) {
        if (!valid[l]) continue;
        const float origin[3] = {r.org_x[l], r.org_y[l], r.org_z[l]},
                    direction[3] = {r.dir_x[l], r.dir_y[l], r.dir_z[l]};
        if (call->tracer->occluded(call->tracer->scene, origin, direction, r.tfar[l])) r.tfar[l] = -1.0f;
    }
}

void check(llvm::Error error) {
    if (error) throw NotTranslated("LLVM: " + llvm::toString(std::move(error)));
}

template <typename T>
T check(llvm::Expected<T> result) {
    check(result.takeError());
    return std::move(*result);
}

class JitKernel final : public VectorKernel {
 public:
    JitKernel(std::unique_ptr<llvm::orc::LLJIT> jit, VectorFunction function)
        : jit_(std::move(jit)), function_(function) {}
    void run(const CpuInvocation& call) const override {
        const EmbreeScene* packets = call.tracer ? EmbreeScene::of_packets(*call.tracer) : nullptr;
        const VectorCall of{call.scene_buffers,
                            call.kernel_buffers,
                            call.tracer,
                            call.unfinished,
                            packets,
                            packets ? packets->largest_ray() : std::numeric_limits<float>::infinity()};
        const uint32_t count = call.end - call.begin;
        for (uint32_t first = 0; first < count; first += kLanes) function_(&of, call.begin, count, first);
    }

 private:
    std::unique_ptr<llvm::orc::LLJIT> jit_;  // has the code
    VectorFunction function_;
};

// Without the pass that combines instructions, which would turn masks into vectors of bits.
constexpr const char* kPasses = "function(sroa,early-cse,simplifycfg,instsimplify,gvn,simplifycfg,adce,sink)";

void optimize(llvm::Module& module, llvm::TargetMachine& machine) {
    llvm::LoopAnalysisManager loops;
    llvm::FunctionAnalysisManager functions;
    llvm::CGSCCAnalysisManager components;
    llvm::ModuleAnalysisManager modules;
    llvm::PassBuilder builder(&machine);
    builder.registerModuleAnalyses(modules);
    builder.registerCGSCCAnalyses(components);
    builder.registerFunctionAnalyses(functions);
    builder.registerLoopAnalyses(loops);
    builder.crossRegisterProxies(loops, functions, components, modules);
    llvm::ModulePassManager passes;
    check(builder.parsePassPipeline(passes, kPasses));
    passes.run(module, modules);
}

bool has_avx2() {
    llvm::StringMap<bool> features;
    return llvm::sys::getHostCPUFeatures(features) && features["avx2"];
}

std::shared_ptr<const VectorKernel> compile(const vulkan::Spirv& spirv) {
    static const bool ready =
        !llvm::InitializeNativeTarget() && !llvm::InitializeNativeTargetAsmPrinter() && has_avx2();
    if (!ready) throw NotTranslated("the processor has no AVX2");
    const Program program = take_apart(spirv);
    auto context = std::make_unique<llvm::LLVMContext>();
    auto target = check(llvm::orc::JITTargetMachineBuilder::detectHost());
    target.getOptions().AllowFPOpFusion = llvm::FPOpFusion::Strict;
    const auto machine = check(target.createTargetMachine());
    auto module = lane_code(program, *context);
    module->setDataLayout(machine->createDataLayout());
    module->setTargetTriple(machine->getTargetTriple().str());
    for (llvm::Function& function : *module) {
        function.addFnAttr("target-cpu", machine->getTargetCPU());
        function.addFnAttr("target-features", machine->getTargetFeatureString());
    }
    optimize(*module, *machine);
    auto jit = check(llvm::orc::LLJITBuilder().setJITTargetMachineBuilder(target).create());
    llvm::orc::SymbolMap functions;
    functions[jit->mangleAndIntern(kClosest)] = llvm::JITEvaluatedSymbol::fromPointer(ClosestFunction(&closest));
    functions[jit->mangleAndIntern(kOccluded)] = llvm::JITEvaluatedSymbol::fromPointer(OccludedFunction(&occluded));
    check(jit->getMainJITDylib().define(llvm::orc::absoluteSymbols(std::move(functions))));
    check(jit->addIRModule(llvm::orc::ThreadSafeModule(std::move(module), std::move(context))));
    const auto address = check(jit->lookup(kFunctionName));
    return std::make_shared<JitKernel>(std::move(jit), address.toPtr<VectorFunction>());
}

}  // namespace

std::shared_ptr<const VectorKernel> compile_vector_kernel(std::string_view file, uint64_t effects) {
    vulkan::ShaderOptions options;
    options.effects = effects;
    options.ray_query = true;
    options.local_size = 1;
    return compile(
        vulkan::compile_shader(file, options, vulkan::ShaderCache(vulkan::ShaderCache::default_folder())).spirv);
}

}  // namespace lampyris::vectors
