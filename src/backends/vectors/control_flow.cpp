#include "backends/vectors/control_flow.h"

#include <algorithm>
#include <functional>

namespace lampyris::vectors {

std::vector<uint32_t> successors_of(const Block& block) {
    const std::vector<uint32_t>& o = block.end.operands;
    switch (block.end.op) {
        case spv::OpBranch: return {o[0]};
        case spv::OpBranchConditional: return {o[1], o[2]};
        case spv::OpSwitch: {
            std::vector<uint32_t> all{o[1]};
            for (size_t i = 3; i < o.size(); i += 2) all.push_back(o[i]);
            return all;
        }
        default: return {};
    }
}

ControlFlow::ControlFlow(const Program& of) : program(of) {
    find_order();
    find_dominators();
    find_loops();
    find_varying();
}

void ControlFlow::find_order() {
    std::unordered_map<uint32_t, uint32_t> index;
    for (uint32_t i = 0; i < program.blocks.size(); ++i) index[program.blocks[i].label] = i;
    // Depth first, and what follows a construct first of all, so that it comes last in the reversed order.
    std::vector<uint32_t> post;
    std::vector<bool> seen(program.blocks.size());
    const std::function<void(uint32_t)> visit = [&](uint32_t at) {
        if (seen[at]) return;
        seen[at] = true;
        const Block& block = program.blocks[at];
        if (block.merge) visit(index.at(block.merge));
        if (block.next_turn) visit(index.at(block.next_turn));
        for (const uint32_t label : successors_of(block)) visit(index.at(label));
        post.push_back(at);
    };
    visit(0);
    // What follows a construct may be reached by nothing.
    std::vector<bool> reached(program.blocks.size());
    const std::function<void(uint32_t)> reach = [&](uint32_t at) {
        if (reached[at]) return;
        reached[at] = true;
        for (const uint32_t label : successors_of(program.blocks[at])) reach(index.at(label));
    };
    reach(0);
    std::erase_if(post, [&](uint32_t at) { return !reached[at]; });
    order.assign(post.rbegin(), post.rend());
}

void ControlFlow::find_dominators() {
    // First in the order of the search; then again in preorder of the dominators' tree.
    for (int round = 0; round < 2; ++round) {
        const uint32_t count = uint32_t(order.size());
        place_of_label_.clear();
        for (uint32_t i = 0; i < count; ++i) place_of_label_[block(i).label] = i;
        places.assign(count, {});
        for (uint32_t i = 0; i < count; ++i)
            for (const uint32_t label : successors_of(block(i))) {
                const uint32_t to = place_of(label);
                if (std::ranges::find(places[i].successors, to) == places[i].successors.end()) {
                    places[i].successors.push_back(to);
                    places[to].predecessors.push_back(i);
                }
            }
        // Cooper, Harvey and Kennedy 2001, "A simple, fast dominance algorithm".
        std::vector<uint32_t> idom(count, ~0u);
        idom[0] = 0;
        for (bool changed = true; changed;) {
            changed = false;
            for (uint32_t i = 1; i < count; ++i) {
                uint32_t found = ~0u;
                for (uint32_t from : places[i].predecessors) {
                    if (idom[from] == ~0u) continue;
                    if (found == ~0u) {
                        found = from;
                        continue;
                    }
                    uint32_t other = found;
                    while (from != other) {
                        while (from > other) from = idom[from];
                        while (other > from) other = idom[other];
                    }
                    found = from;
                }
                if (found != idom[i]) idom[i] = found, changed = true;
            }
        }
        for (uint32_t i = 0; i < count; ++i) places[i].dominator = idom[i];
        if (round == 0) {
            std::vector<std::vector<uint32_t>> children(count);
            for (uint32_t i = 1; i < count; ++i) children[idom[i]].push_back(i);
            std::vector<uint32_t> again;
            const std::function<void(uint32_t)> visit = [&](uint32_t at) {
                again.push_back(order[at]);
                for (const uint32_t child : children[at]) visit(child);
            };
            visit(0);
            order = again;
            continue;
        }
        for (uint32_t i = 0; i < count; ++i) places[i].end = i + 1;
        for (uint32_t i = count; i-- > 1;) {
            Place& above = places[places[i].dominator];
            above.end = std::max(above.end, places[i].end);
        }
        const std::vector<uint32_t> with_turns = post_dominators(true), without = post_dominators(false);
        for (uint32_t i = 0; i < count; ++i) places[i].post_dominator = with_turns[i], places[i].meets = without[i];
    }
}

// The dominators of the reversed graph, whose root is the end of the kernel. Without `turns`, a loop's last block goes there, too.
std::vector<uint32_t> ControlFlow::post_dominators(bool turns) const {
    const uint32_t end = uint32_t(order.size());
    std::vector<uint32_t> result(end + 1, ~0u);
    result[end] = end;
    for (bool changed = true; changed;) {
        changed = false;
        for (uint32_t i = end; i-- > 0;) {
            uint32_t found = ~0u;
            std::vector<uint32_t> next;
            for (const uint32_t to : places[i].successors) next.push_back(to > i || turns ? to : end);
            if (next.empty()) next = {end};
            for (uint32_t to : next) {
                if (result[to] == ~0u) continue;
                if (found == ~0u) {
                    found = to;
                    continue;
                }
                // Places grow along forward edges, so that a post-dominator has a larger one.
                while (to != found) {
                    while (to < found) to = result[to];
                    while (found < to) found = result[found];
                }
            }
            if (found != result[i]) result[i] = found, changed = true;
        }
    }
    for (uint32_t& to : result)
        if (to == end) to = ~0u;
    return result;
}

void ControlFlow::find_loops() {
    for (uint32_t i = 0; i < places.size(); ++i) {
        if (std::ranges::none_of(places[i].predecessors, [&](uint32_t from) { return from >= i; })) continue;
        if (!place_of_label_.contains(block(i).merge)) throw NotTranslated("a loop without an end");
        places[i].header = true;
        places[i].loop_end = place_of(block(i).merge);
        for (uint32_t in = i; in < places[i].loop_end; ++in) places[in].loop = i;  // inner loops come later
    }
    for (uint32_t i = 0; i < places.size(); ++i) {
        uint32_t& start = places[i].start;
        start = places[i].dominator;
        for (uint32_t header = 0; header < places.size(); ++header)
            if (places[header].header && in_loop(start, header) && !in_loop(i, header))
                start = places[header].dominator;
        for (const Instruction& phi : block(i).phis) defined_[phi.result] = i;
        for (const Instruction& one : block(i).body)
            if (one.result) defined_[one.result] = i;
    }
}

bool ControlFlow::is_behind_loop_of(uint32_t from, uint32_t at) const {
    for (uint32_t header = 0; header <= from; ++header)
        if (places[header].header && in_loop(from, header) && !in_loop(at, header)) return true;
    return false;
}

void ControlFlow::find_varying() {
    while (find_varying_once()) {}
}

bool ControlFlow::find_varying_once() {
    bool changed = false;
    for (uint32_t i = 0; i < places.size(); ++i) {
        changed |= find_varying_values(i);
        const Instruction& end = block(i).end;
        if (places[i].successors.size() < 2 || places[i].varying_branch || !varying_.contains(end.operands[0]))
            continue;
        places[i].varying_branch = changed = true;
        lanes_part_at(i);
    }
    return find_outliving() || changed;
}

bool ControlFlow::find_varying_values(uint32_t i) {
    bool changed = false;
    const auto varies = [&](const Instruction& one) {
        return std::ranges::any_of(values_of(one), [&](uint32_t id) { return varying_.contains(id); });
    };
    for (const Instruction& phi : block(i).phis)
        if (places[i].mixed_join || varies(phi)) changed |= mark(phi.result);
    for (const Instruction& one : block(i).body) {
        if (!one.result) continue;
        bool is = varies(one) || is_atomic(one.op) || (is_ray_query(one.op) && one.op != spv::OpRayQueryProceedKHR);
        if (one.op == spv::OpLoad || one.op == spv::OpAccessChain) {
            const auto variable = program.variables.find(one.operands[0]);
            if (variable != program.variables.end())
                is = is || variable->second.storage == spv::StorageClassInput ||
                     variable->second.storage == spv::StorageClassFunction ||
                     variable->second.storage == spv::StorageClassPrivate;
        }
        if (is) changed |= mark(one.result);
    }
    return changed;
}

// Lanes may meet again in all blocks up to the post-dominator, and leave loops around this one at different times.
void ControlFlow::lanes_part_at(uint32_t i) {
    std::vector<bool> seen(places.size());
    const std::function<void(uint32_t)> visit = [&](uint32_t at) {
        if (seen[at]) return;
        seen[at] = true;
        if (std::ranges::count_if(places[at].predecessors, [&](uint32_t from) { return from < at; }) > 1)
            places[at].mixed_join = true;
        if (at == places[i].post_dominator) return;
        for (const uint32_t to : places[at].successors)
            if (to > at) visit(to);  // and not back to a header
    };
    for (const uint32_t to : places[i].successors)
        if (to > i) visit(to);
    for (uint32_t header = 0; header <= i; ++header)
        if (places[header].header && in_loop(i, header) &&
            std::find(seen.begin() + places[header].loop_end, seen.end(), true) != seen.end())
            varying_exit_.insert(header);
}

bool ControlFlow::find_outliving() {
    bool changed = false;
    const auto use = [&](uint32_t id, uint32_t at) {
        const auto found = defined_.find(id);
        if (found == defined_.end()) return;
        for (uint32_t header = 0; header <= found->second; ++header)
            if (varying_exit_.contains(header) && in_loop(found->second, header) && !in_loop(at, header)) {
                changed |= outlives_.insert(id).second;
                changed |= mark(id);
            }
    };
    for (uint32_t i = 0; i < places.size(); ++i) {
        for (const Instruction& phi : block(i).phis)  // at the end of the block from which they come
            for (size_t k = 0; k < phi.operands.size(); k += 2) use(phi.operands[k], place_of(phi.operands[k + 1]));
        for (const Instruction& one : block(i).body)
            for (const uint32_t id : values_of(one)) use(id, i);
        for (const uint32_t id : values_of(block(i).end)) use(id, i);
    }
    return changed;
}

}  // namespace lampyris::vectors
