// The library's entry: SPIR-V from the cache or the compiler, machine code from the cache or LLVM, and the kernel that runs it.
#include "accel/rays/embree_scene.h"
#include "backends/cpu/vectors.h"
#include "backends/shaders/shader_compiler.h"
#include "backends/vectors/lane_code.h"
#include "backends/vectors/version.h"

#include <llvm/ExecutionEngine/Orc/CompileUtils.h>
#include <llvm/ExecutionEngine/Orc/LLJIT.h>
#include <llvm/Passes/PassBuilder.h>
#include <llvm/Support/Host.h>
#include <llvm/Support/TargetSelect.h>
#include <llvm/Target/TargetMachine.h>

#include <cstring>
#include <limits>
#include <optional>

namespace lampyris::vectors {
namespace {

using shaders::ContentHash;
using shaders::ShaderCache;
using shaders::Spirv;
using Object = std::unique_ptr<llvm::MemoryBuffer>;  // machine code, not linked yet

void closest(const VectorCall* call, const int32_t* valid, RTCRayHit8* rays) { call->scene->closest8(valid, *rays); }
void occluded(const VectorCall* call, const int32_t* valid, RTCRay8* rays) { call->scene->occluded8(valid, *rays); }

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
        const EmbreeScene* scene = call.tracer ? EmbreeScene::of(*call.tracer) : nullptr;
        const VectorCall of{call.scene_buffers, call.kernel_buffers, call.unfinished, scene,
                            scene ? scene->largest_ray() : std::numeric_limits<float>::infinity()};
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

llvm::orc::JITTargetMachineBuilder processor() {
    static const bool ready = !llvm::InitializeNativeTarget() && !llvm::InitializeNativeTargetAsmPrinter();
    llvm::StringMap<bool> features;
    if (!ready || !llvm::sys::getHostCPUFeatures(features) || !features["avx2"])
        throw NotTranslated("the processor has no AVX2");
    auto target = check(llvm::orc::JITTargetMachineBuilder::detectHost());
    target.getOptions().AllowFPOpFusion = llvm::FPOpFusion::Strict;
    return target;
}

Object machine_code(const Spirv& spirv, llvm::TargetMachine& machine) {
    const Program program = take_apart(spirv);
    llvm::LLVMContext context;
    const auto module = lane_code(program, context);
    module->setDataLayout(machine.createDataLayout());
    module->setTargetTriple(machine.getTargetTriple().str());
    for (llvm::Function& function : *module) {
        function.addFnAttr("target-cpu", machine.getTargetCPU());
        function.addFnAttr("target-features", machine.getTargetFeatureString());
    }
    optimize(*module, machine);
    return check(llvm::orc::SimpleCompiler(machine)(*module));
}

ContentHash key_of(const Spirv& spirv, const llvm::TargetMachine& machine) {
    ContentHash key;
    for (const llvm::StringRef part : {llvm::StringRef(LAMPYRIS_VECTORS_VERSION), llvm::StringRef(LLVM_VERSION_STRING),
                                       machine.getTargetCPU(), machine.getTargetFeatureString()})
        key.add(std::string_view(part.data(), part.size()));
    key.add(std::string_view(reinterpret_cast<const char*>(spirv.data()), spirv.size() * sizeof(uint32_t)));
    return key;
}

Object find_code(const ShaderCache& cache, const ContentHash& key) {
    const auto words = cache.find(key);
    if (!words) return nullptr;
    return llvm::MemoryBuffer::getMemBufferCopy(
        llvm::StringRef(reinterpret_cast<const char*>(words->data()), words->size() * sizeof(uint32_t)));
}

void store_code(const ShaderCache& cache, const ContentHash& key, const llvm::MemoryBuffer& object) {
    shaders::Words words((object.getBufferSize() + 3) / 4);  // ELF does not mind the zeros at its end
    std::memcpy(words.data(), object.getBufferStart(), object.getBufferSize());
    cache.store(key, words);
}

std::shared_ptr<const VectorKernel> link(const llvm::orc::JITTargetMachineBuilder& target, Object object) {
    auto jit = check(llvm::orc::LLJITBuilder().setJITTargetMachineBuilder(target).create());
    llvm::orc::SymbolMap functions;
    functions[jit->mangleAndIntern(kClosest)] = llvm::JITEvaluatedSymbol::fromPointer(ClosestFunction(&closest));
    functions[jit->mangleAndIntern(kOccluded)] = llvm::JITEvaluatedSymbol::fromPointer(OccludedFunction(&occluded));
    check(jit->getMainJITDylib().define(llvm::orc::absoluteSymbols(std::move(functions))));
    check(jit->addObjectFile(std::move(object)));
    const auto address = check(jit->lookup(kFunctionName));
    return std::make_shared<JitKernel>(std::move(jit), address.toPtr<VectorFunction>());
}

// CPU seconds, within a factor of two of what was measured (docs/decisions/vectors.md): of machine code from SPIR-V; and of all from what is
// left of a kernel before its functions are inlined, half of which SPIRV-Tools takes.
double seconds_of_machine_code(size_t words) { return 3.5e-5 * double(words) + 2e-10 * double(words) * double(words); }
double seconds_of_all(size_t trimmed) { return 0.3 + 2.4e-9 * double(trimmed) * double(trimmed); }

struct TooLong {
    double expected_s;
};

void check_time(const VectorRequest& request, double expected_s) {
    if (expected_s > request.most_s) throw TooLong{expected_s};
}

std::shared_ptr<const VectorKernel> made(const VectorRequest& request) {
    const auto target = processor();
    const auto machine = check(llvm::orc::JITTargetMachineBuilder(target).createTargetMachine());
    shaders::ShaderOptions options;
    options.effects = request.effects;
    options.ray_query = true;
    options.local_size = 1;
    const ShaderCache shaders_kept(request.folder), code_kept(request.folder, ".vectors");
    std::optional<Spirv> spirv = shaders::find_shader(request.file, options, shaders_kept);
    if (!spirv) {
        if (request.most_s == 0) throw TooLong{0};
        spirv = shaders::compile_shader(request.file, options, shaders_kept, [&](size_t words) {
                    check_time(request, seconds_of_all(words));
                }).spirv;
    }
    const ContentHash key = key_of(*spirv, *machine);
    Object object = find_code(code_kept, key);
    if (!object) {
        check_time(request, seconds_of_machine_code(spirv->size()));
        object = machine_code(*spirv, *machine);
        store_code(code_kept, key, *object);
    }
    return link(target, std::move(object));
}

VectorResult compile_kernel(const VectorRequest& request) {
    try {
        return {made(request), 0};
    } catch (const TooLong& compiling) {
        return {nullptr, compiling.expected_s};
    }
}

}  // namespace
}  // namespace lampyris::vectors

extern "C" const lampyris::VectorCompiler* lampyris_vectors() {
    static const lampyris::VectorCompiler compiler{&lampyris::vectors::compile_kernel};
    return &compiler;
}
