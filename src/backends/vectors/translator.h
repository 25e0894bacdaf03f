// What lane_code.h promises: parts of the translation share this state.
#pragma once

#include "backends/vectors/control_flow.h"
#include "backends/vectors/lane_code.h"

#include <llvm/IR/IRBuilder.h>

#include <map>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

namespace lampyris::vectors {

using llvm::Value;

// A value of SPIR-V: its scalars, each a vector over the lanes or one number for all lanes. Null where nothing uses one.
struct Scalars {
    std::vector<Value*> of;
};

// A pointer into a buffer or a local variable: bytes, and indices that are known when the kernel runs. In a local variable, a word is
// that of all lanes, side by side.
struct Pointer {
    struct Step {
        uint32_t index;   // a value
        uint64_t stride;  // bytes
    };
    uint32_t variable = 0;
    uint32_t type = 0;  // of what it points to
    uint64_t bytes = 0;
    std::vector<Step> steps;
};

class Translator {
 public:
    Translator(const Program& program, llvm::LLVMContext& context);
    std::unique_ptr<llvm::Module> run();

 private:
    // ---- Values (translate_values.cpp) ----
    // A bool that differs between lanes is a mask: words of 32 bits, 0 or -1. Vectors of single bits, which LLVM has for that, take
    // instructions to pack and to unpack wherever another block uses them.
    llvm::Type* wide(llvm::Type* scalar) const { return llvm::FixedVectorType::get(scalar, kLanes); }
    llvm::Type* mask_type() { return wide(b_.getInt32Ty()); }
    llvm::Type* scalar_type(uint32_t type);
    llvm::Type* type_of(uint32_t type, bool varying);
    Value* splat(Value* v);
    Value* as_mask(Value* compared);
    Value* choose(Value* mask, Value* yes, Value* no);
    Value* signs(Value* mask);  // a bit of each lane, in one word
    Value* any(Value* mask) { return b_.CreateICmpNE(signs(mask), b_.getInt32(0)); }
    Value* number(float x) { return llvm::ConstantFP::get(b_.getFloatTy(), x); }
    Scalars constant(uint32_t id);
    Scalars get(uint32_t id) { return get_at(id, place_); }
    Scalars get_at(uint32_t id, uint32_t place);
    std::vector<Value*> wide_of(uint32_t id);
    void set(const Instruction& one, std::vector<Value*> scalars);
    void find_uses();
    uint32_t type_id(uint32_t value) const { return p_.type_of.at(value); }
    // The scalar at which a member of a member... of a value begins, and its type.
    std::pair<uint32_t, uint32_t> part(uint32_t type, const std::vector<uint32_t>& operands, size_t first) const;

    // ---- Control flow (translate_flow.cpp) ----
    void make_function();
    void find_masks();
    void open_block(uint32_t place);
    void close_block(uint32_t place);
    void edge(uint32_t from, uint32_t to, Value* mask);
    std::map<uint32_t, Value*> lanes_by_target(const Instruction& end);
    bool is_small(uint32_t place) const;
    llvm::BasicBlock* behind(uint32_t from, const std::vector<uint32_t>& to);
    llvm::BasicBlock* check(uint32_t place) { return place < checks_.size() ? checks_[place] : exit_; }
    llvm::BasicBlock* new_block(const char* name) { return llvm::BasicBlock::Create(c_, name, function_); }
    llvm::AllocaInst* local(llvm::Type* type, const char* name);
    // Code for each lane that is here.
    template <typename Visit>
    void for_active_lanes(Visit&& visit) {
        Value* here = b_.CreateICmpSLT(exec_, llvm::Constant::getNullValue(mask_type()));
        for (uint32_t l = 0; l < kLanes; ++l) {
            llvm::BasicBlock *lane = new_block("lane"), *next = new_block("next");
            b_.CreateCondBr(b_.CreateExtractElement(here, l), lane, next);
            b_.SetInsertPoint(lane);
            visit(l);
            b_.CreateBr(next);
            b_.SetInsertPoint(next);
        }
    }

    // ---- Memory (translate_memory.cpp, translate_loads.cpp) ----
    Pointer pointer(uint32_t id) const;
    Pointer chain(const Instruction& one) const;
    uint32_t storage(const Pointer& pointer) const { return p_.variables.at(pointer.variable).storage; }
    bool is_local(const Pointer& pointer) const;
    uint32_t words_before(uint32_t type, uint32_t scalar) const;
    Value* base(uint32_t variable) { return bases_.at(variable); }
    Value* at(Value* address, uint64_t bytes) { return b_.CreateConstGEP1_64(b_.getInt8Ty(), address, bytes); }
    bool differs(const Pointer& pointer);
    Value* active_lane();                                   // the number of the first one that is here, in all lanes
    Value* address(const Pointer& pointer);                 // the same for all lanes
    std::vector<Value*> addresses(const Pointer& pointer);  // of each lane
    Value* from_lanes(const std::vector<Value*>& lanes);
    void load(const Instruction& one);
    std::vector<Value*> load_local(const Pointer& from);
    std::vector<Value*> load_buffer(const Instruction& one, const Pointer& from);
    void load_group(uint32_t group);
    void group_loads(uint32_t place);
    std::vector<Value*> gather(const std::vector<Value*>& lanes, const std::vector<int64_t>& offsets);
    void store(const Instruction& one);
    void store_local(const Pointer& to, const std::vector<Value*>& scalars);
    void atomic(const Instruction& one);

    // ---- Instructions (translate_instructions.cpp, translate_arithmetic.cpp, translate_rays.cpp) ----
    void instruction(const Instruction& one);
    bool composite(const Instruction& one);
    bool arithmetic(const Instruction& one);
    Value* calculate(const Instruction& one, llvm::Type* type, const std::vector<Value*>& in);
    Value* compare(spv::Op op, Value* x, Value* y);
    Value* to_integer(Value* x, bool is_unsigned);
    void extended(const Instruction& one);
    bool ray_query(const Instruction& one);
    void trace(const Instruction& one);

    const Program& p_;
    ControlFlow flow_;
    llvm::LLVMContext& c_;
    llvm::IRBuilder<> b_;
    std::unique_ptr<llvm::Module> module_;
    llvm::Function* function_ = nullptr;
    Value *call_ = nullptr, *begin_ = nullptr, *count_ = nullptr, *first_ = nullptr;  // its parameters
    llvm::BasicBlock *entry_ = nullptr, *exit_ = nullptr;

    uint32_t place_ = 0;     // of the block that is translated
    Value* exec_ = nullptr;  // its lanes
    Value* active_lane_ = nullptr;
    // By place: where lanes are counted, and where the block begins.
    std::vector<llvm::BasicBlock*> checks_, bodies_;
    std::vector<llvm::AllocaInst*> masks_;  // lanes that have come to the block
    std::vector<Value*> execs_;
    std::vector<bool> inherits_, restores_;  // its lanes are those of the block before it; those of its dominator

    std::unordered_map<uint32_t, Scalars> values_;
    std::unordered_map<uint32_t, std::vector<llvm::AllocaInst*>> phis_, outlived_;
    std::unordered_map<uint32_t, Pointer> pointers_;
    std::unordered_map<uint32_t, Value*> bases_;             // of buffers and local variables
    std::unordered_map<uint32_t, std::set<uint32_t>> used_;  // scalars of a value
    std::set<uint32_t> written_;                             // buffers
    // Of the last ray of a ray query: whether it hits, instance, geometry, primitive; and the place where it begins.
    std::unordered_map<uint32_t, std::vector<Value*>> hits_;
    std::unordered_map<uint32_t, uint32_t> traced_at_;

    // Loads of the block from the same element of a buffer, or from elements a constant apart, are made together.
    struct Load {
        const Instruction* one;
        Pointer from;
    };
    std::vector<std::vector<Load>> groups_;
    std::unordered_map<uint32_t, uint32_t> group_of_;              // by result
    std::map<std::pair<uint32_t, uint32_t>, Value*> from_groups_;  // by result and scalar
    std::set<uint32_t> loaded_groups_;
};

}  // namespace lampyris::vectors
