// The order in which a kernel's blocks are translated, its loops, and which of its values differ between lanes.
#pragma once

#include "backends/vectors/spirv_program.h"

#include <unordered_set>
#include <vector>

namespace lampyris::vectors {

struct Place {                                       // of a block in the order
    std::vector<uint32_t> successors, predecessors;  // places
    uint32_t dominator = 0;                          // the immediate one
    uint32_t end = 0;                                // the first place behind all that the block dominates
    uint32_t post_dominator = ~0u;                   // ~0: the kernel's end
    uint32_t meets = ~0u;                            // where all lanes meet again within the same turn of a loop; or ~0
    uint32_t start = 0;     // the block before which no lane comes here, outside of loops that end before it
    uint32_t loop = ~0u;    // the header of the innermost loop around it (of a header: itself)
    uint32_t loop_end = 0;  // of a header: the place of the loop's merge block
    bool header = false;
    bool varying_branch = false;  // lanes go different ways
    bool mixed_join = false;      // lanes come different ways
};

class ControlFlow {
 public:
    explicit ControlFlow(const Program& program);
    const Program& program;
    std::vector<uint32_t> order;  // block of the program, by place
    std::vector<Place> places;
    const Block& block(uint32_t place) const { return program.blocks[order[place]]; }
    uint32_t place_of(uint32_t label) const { return place_of_label_.at(label); }
    bool dominates(uint32_t a, uint32_t b) const { return a <= b && b < places[a].end; }
    bool in_loop(uint32_t place, uint32_t header) const { return place >= header && place < places[header].loop_end; }
    bool is_varying(uint32_t id) const { return varying_.contains(id); }
    // Values of a loop that are needed behind it, where lanes leave it at different times.
    bool outlives_loop(uint32_t id) const { return outlives_.contains(id); }
    // Whether a place is behind a loop around another one; around a value's definition.
    bool is_behind_loop_of(uint32_t from, uint32_t place) const;
    bool is_behind_loop(uint32_t id, uint32_t place) const {
        const auto found = defined_.find(id);
        return found != defined_.end() && is_behind_loop_of(found->second, place);
    }

 private:
    void find_order();
    void find_dominators();
    std::vector<uint32_t> post_dominators(bool turns) const;
    void find_loops();
    void find_varying();
    bool mark(uint32_t id) { return varying_.insert(id).second; }
    bool find_varying_once();
    bool find_varying_values(uint32_t place);
    void lanes_part_at(uint32_t place);
    bool find_outliving();
    std::unordered_map<uint32_t, uint32_t> place_of_label_, defined_;
    std::unordered_set<uint32_t> varying_, outlives_, varying_exit_;
};

std::vector<uint32_t> successors_of(const Block& block);

}  // namespace lampyris::vectors
