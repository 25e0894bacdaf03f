// Control flow: blocks in the order of ControlFlow, each under the mask of the lanes that have come to it.
#include "backends/vectors/translator.h"
#include "core/device/kernel_types.h"

#include <glslang/SPIRV/GLSL.std.450.h>

#include <fmt/format.h>
#include <llvm/IR/Verifier.h>
#include <llvm/Support/raw_ostream.h>

#include <algorithm>

namespace lampyris::vectors {
namespace {

// A block of fewer operations runs for no lane at all rather than to be skipped: a branch that is often mispredicted costs more.
constexpr int kSmallBlock = 12;

}  // namespace

Translator::Translator(const Program& program, llvm::LLVMContext& context)
    : p_(program), flow_(program), c_(context), b_(context), module_(new llvm::Module("kernel", context)) {}

std::unique_ptr<llvm::Module> lane_code(const Program& program, llvm::LLVMContext& context) {
    return Translator(program, context).run();
}

std::unique_ptr<llvm::Module> Translator::run() {
    find_uses();
    make_function();
    find_masks();
    b_.CreateBr(bodies_[0]);
    for (uint32_t i = 0; i < flow_.places.size(); ++i) {
        place_ = i;
        open_block(i);
        group_loads(i);
        for (const Instruction& one : flow_.block(i).body) instruction(one);
        close_block(i);
    }
    b_.SetInsertPoint(exit_);
    b_.CreateRetVoid();
    std::string problem;
    llvm::raw_string_ostream stream(problem);
    if (llvm::verifyModule(*module_, &stream)) throw NotTranslated("code that LLVM refuses: " + stream.str());
    return std::move(module_);
}

llvm::AllocaInst* Translator::local(llvm::Type* type, const char* name) {
    llvm::IRBuilder<> first(entry_, entry_->begin());
    return first.CreateAlloca(type, nullptr, name);
}

void Translator::make_function() {
    llvm::Type* word = b_.getInt32Ty();
    function_ =
        llvm::Function::Create(llvm::FunctionType::get(b_.getVoidTy(), {b_.getPtrTy(), word, word, word}, false),
                               llvm::Function::ExternalLinkage, kFunctionName, *module_);
    function_->addFnAttr("denormal-fp-math", "preserve-sign,preserve-sign");  // as the CPU backend sets it
    function_->addFnAttr(llvm::Attribute::NoUnwind);
    call_ = function_->getArg(0), begin_ = function_->getArg(1), count_ = function_->getArg(2),
    first_ = function_->getArg(3);
    entry_ = new_block("entry");
    llvm::BasicBlock* start = new_block("start");
    for (size_t i = 0; i < flow_.places.size(); ++i)
        checks_.push_back(new_block("check")), bodies_.push_back(new_block("body"));
    exit_ = new_block("exit");
    b_.SetInsertPoint(entry_);  // for variables
    b_.CreateBr(start);
    b_.SetInsertPoint(checks_[0]);
    b_.CreateUnreachable();
    b_.SetInsertPoint(start);
    std::vector<llvm::Constant*> numbers;
    for (uint32_t i = 0; i < kLanes; ++i) numbers.push_back(b_.getInt32(i));
    Value* index = b_.CreateAdd(splat(first_), llvm::ConstantVector::get(numbers));
    exec_ = as_mask(b_.CreateICmpULT(index, splat(count_)));
    const auto pointer_at = [&](Value* from, size_t bytes) { return b_.CreateLoad(b_.getPtrTy(), at(from, bytes)); };
    for (const auto& [id, variable] : p_.variables) {
        const uint32_t type = p_.type(variable.type).element;
        switch (variable.storage) {
            case spv::StorageClassStorageBuffer:
                if (variable.set == 0 && variable.binding == kernel::BINDING_UNFINISHED)
                    bases_[id] = pointer_at(call_, offsetof(VectorCall, unfinished));
                else
                    bases_[id] = pointer_at(pointer_at(call_, variable.set == 0 ? offsetof(VectorCall, scene_buffers)
                                                                                : offsetof(VectorCall, kernel_buffers)),
                                            variable.binding * sizeof(void*));
                break;
            case spv::StorageClassFunction:
            case spv::StorageClassPrivate: {
                if (p_.type(type).op == spv::OpTypeRayQueryKHR) break;
                llvm::AllocaInst* words =
                    local(llvm::ArrayType::get(mask_type(), words_before(type, p_.scalars(type))), "variable");
                words->setAlignment(llvm::Align(4 * kLanes));
                bases_[id] = words;
                break;
            }
            case spv::StorageClassInput:
                if (variable.built_in != spv::BuiltInGlobalInvocationId) throw NotTranslated("an input");
                values_[id] = {{index, splat(b_.getInt32(0)), splat(b_.getInt32(0))}};
                break;
            default: break;
        }
    }
}

void Translator::find_masks() {
    const size_t count = flow_.places.size();
    masks_.resize(count), execs_.resize(count), inherits_.resize(count), restores_.resize(count);
    for (uint32_t i = 1; i < count; ++i) {
        const Place& place = flow_.places[i];
        std::vector<uint32_t> before;
        for (const uint32_t from : place.predecessors)
            if (from < i) before.push_back(from);
        inherits_[i] = before.size() == 1 && flow_.places[before[0]].successors.size() == 1;
        const Place& dominator = flow_.places[place.dominator];
        restores_[i] = !inherits_[i] && !place.header && dominator.meets == i && dominator.loop == place.loop;
    }
}

bool Translator::is_small(uint32_t i) const {
    const Place& place = flow_.places[i];
    if (place.end != i + 1 || place.header || place.successors.empty()) return false;
    if (std::ranges::any_of(place.successors, [&](uint32_t to) { return to <= i; })) return false;
    int cost = 0;
    for (const Instruction& one : flow_.block(i).body) {
        switch (one.op) {
            case spv::OpCompositeExtract:
            case spv::OpCompositeConstruct:
            case spv::OpCompositeInsert:
            case spv::OpVectorShuffle:
            case spv::OpBitcast: continue;
            case spv::OpLoad:
            case spv::OpStore:
            case spv::OpAccessChain:
            case spv::OpUDiv:
            case spv::OpUMod:
            case spv::OpSDiv:
            case spv::OpSRem: return false;
            case spv::OpFDiv: cost += 8; break;
            case spv::OpExtInst: cost += one.operands[1] == GLSLstd450Sqrt ? 8 : 2; break;
            default: cost += 1;
        }
        if (!one.type || is_atomic(one.op) || is_ray_query(one.op)) return false;
        cost += int(p_.scalars(one.type)) - 1;
    }
    return cost <= kSmallBlock;
}

void Translator::open_block(uint32_t i) {
    const Place& place = flow_.places[i];
    if (i > 0) {
        b_.SetInsertPoint(checks_[i]);
        if (inherits_[i] || restores_[i] || is_small(i))
            b_.CreateBr(bodies_[i]);
        else  // if no lane is here, none is in what the block dominates
            b_.CreateCondBr(any(b_.CreateLoad(mask_type(), masks_[i])), bodies_[i], check(place.end));
        b_.SetInsertPoint(bodies_[i]);
        if (inherits_[i] && !place.header)
            exec_ = execs_[*std::ranges::min_element(place.predecessors)];
        else if (restores_[i])
            exec_ = execs_[place.dominator];
        else
            exec_ = b_.CreateLoad(mask_type(), masks_[i]);
    } else {
        b_.SetInsertPoint(bodies_[0]);
    }
    execs_[i] = exec_;
    active_lane_ = nullptr;
    for (const Instruction& phi : flow_.block(i).phis) {
        std::vector<Value*> scalars;
        for (llvm::AllocaInst* a : phis_.at(phi.result)) scalars.push_back(b_.CreateLoad(a->getAllocatedType(), a));
        set(phi, std::move(scalars));
    }
    // No lane has come to blocks below this one, and phis there have no value; it is said so that LLVM carries none through loops.
    for (uint32_t below = i + 1; below < place.end; ++below) {
        if (flow_.places[below].start != i) continue;
        if (!masks_[below]) masks_[below] = local(mask_type(), "mask");
        b_.CreateStore(llvm::Constant::getNullValue(mask_type()), masks_[below]);
        for (const Instruction& phi : flow_.block(below).phis)
            for (uint32_t s = 0; s < p_.scalars(phi.type); ++s) {
                llvm::Type* type = type_of(p_.scalar_type(phi.type, s), flow_.is_varying(phi.result));
                phis_[phi.result].push_back(local(type, "phi"));
                b_.CreateStore(llvm::PoisonValue::get(type), phis_[phi.result].back());
            }
    }
}

// Lanes go from a block to another one.
void Translator::edge(uint32_t from, uint32_t to, Value* mask) {
    const Place& target = flow_.places[to];
    const bool back = to <= from;
    // All lanes that come there at this time come from here.
    const bool alone = back || inherits_[to];
    for (const Instruction& phi : flow_.block(to).phis) {
        const std::vector<llvm::AllocaInst*>& into = phis_.at(phi.result);
        uint32_t id = 0;
        for (size_t k = 0; k < phi.operands.size(); k += 2)
            if (flow_.place_of(phi.operands[k + 1]) == from) id = phi.operands[k];
        if (p_.is_undefined(id)) {  // lanes may keep what they have, and LLVM need not know what that is
            if (alone)
                for (llvm::AllocaInst* a : into) b_.CreateStore(llvm::PoisonValue::get(a->getAllocatedType()), a);
            continue;
        }
        const Scalars value = get_at(id, from);
        for (size_t s = 0; s < into.size(); ++s) {
            llvm::Type* type = into[s]->getAllocatedType();
            Value* v = value.of[s];
            if (type->isVectorTy()) {
                v = splat(v);
                if (!alone) v = choose(mask, v, b_.CreateLoad(type, into[s]));
            }
            b_.CreateStore(v, into[s]);
        }
    }
    if (back || (target.header && inherits_[to]))
        b_.CreateStore(mask, masks_[to]);
    else if (!inherits_[to] && !restores_[to])
        b_.CreateStore(b_.CreateOr(b_.CreateLoad(mask_type(), masks_[to]), mask), masks_[to]);
}

// The first block in the order that lanes may have come to, behind one whose code ends.
llvm::BasicBlock* Translator::behind(uint32_t from, const std::vector<uint32_t>& to) {
    uint32_t next = flow_.places[from].end;
    for (const uint32_t t : to)
        if (t > from && t < flow_.places[from].end) next = std::min(next, t);
    return check(next);
}

std::map<uint32_t, Value*> Translator::lanes_by_target(const Instruction& end) {
    const std::vector<uint32_t>& o = end.operands;
    std::map<uint32_t, Value*> lanes;
    const auto add = [&](uint32_t label, Value* mask) {
        Value*& all = lanes[flow_.place_of(label)];
        all = all ? b_.CreateOr(all, mask) : mask;
    };
    // What lanes that are not here say must not reach the mask.
    Value* selector = b_.CreateFreeze(splat(get(o[0]).of[0]));
    if (end.op == spv::OpBranchConditional) {
        add(o[1], b_.CreateAnd(exec_, selector));
        add(o[2], b_.CreateAnd(exec_, b_.CreateNot(selector)));
        return lanes;
    }
    Value* rest = exec_;
    for (size_t k = 2; k + 1 < o.size(); k += 2) {
        Value* number = splat(llvm::ConstantInt::get(selector->getType()->getScalarType(), o[k]));
        Value* match = as_mask(b_.CreateICmpEQ(selector, number));
        add(o[k + 1], b_.CreateAnd(exec_, match));
        rest = b_.CreateAnd(rest, b_.CreateNot(match));
    }
    add(o[1], rest);
    return lanes;
}

void Translator::close_block(uint32_t i) {
    const Instruction& end = flow_.block(i).end;
    const Place& place = flow_.places[i];
    if (place.successors.empty()) {
        b_.CreateBr(check(place.end));
        return;
    }
    const auto go_on = [&](uint32_t to) { return to <= i ? bodies_[to] : behind(i, {to}); };
    if (place.successors.size() == 1) {
        edge(i, place.successors[0], exec_);
        b_.CreateBr(go_on(place.successors[0]));
        return;
    }
    if (end.op == spv::OpBranchConditional && !place.varying_branch) {
        llvm::BasicBlock* sides[] = {new_block("yes"), new_block("no")};
        b_.CreateCondBr(b_.CreateFreeze(get(end.operands[0]).of[0]), sides[0], sides[1]);
        for (int side = 0; side < 2; ++side) {
            const uint32_t to = flow_.place_of(end.operands[size_t(side + 1)]);
            b_.SetInsertPoint(sides[side]);
            edge(i, to, exec_);
            b_.CreateBr(go_on(to));
        }
        return;
    }
    const std::map<uint32_t, Value*> lanes = lanes_by_target(end);
    for (const auto& [to, mask] : lanes) edge(i, to, mask);
    if (lanes.begin()->first <= i)  // the next turn of a loop, if some lane takes it
        b_.CreateCondBr(any(lanes.begin()->second), bodies_[lanes.begin()->first], behind(i, place.successors));
    else
        b_.CreateBr(behind(i, place.successors));
}

}  // namespace lampyris::vectors
