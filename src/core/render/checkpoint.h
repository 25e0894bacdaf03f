// Checkpoints: what a rendering needs to go on after the program has ended, in one file (docs/checkpoints.md).
#pragma once

#include "core/device/kernel_types.h"
#include "core/render/run_record.h"

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lampyris {

// All that the image depends on, as names and values: "seed", "1".
using RenderIdentity = std::vector<std::pair<std::string, std::string>>;

struct Checkpoint {
    RenderIdentity identity;
    SessionState session;
    std::vector<ConvergencePoint> convergence;
    double total_s = 0.0;  // RunRecord::total_s
    std::vector<kernel::FilmPixel> film;
};

// Throws MachineError. The file appears complete or not at all.
void write_checkpoint(const std::string& file, const Checkpoint& checkpoint);

// Nothing if there is no such file. Throws InputError if it is no checkpoint, or a damaged one; MachineError if it cannot be read.
std::optional<Checkpoint> read_checkpoint(const std::string& file);

// Of a file, without its last eight bytes, which are this: FNV-1a over words of eight bytes, the last of which is filled up with
// zeros. It finds damage, not forgery.
uint64_t checkpoint_hash(std::span<const std::byte> bytes);

// Throws InputError that names what differs.
void check_same_rendering(const std::string& file, const RenderIdentity& saved, const RenderIdentity& now);

// Throws InputError where a checkpoint must not be written: over one that is not resumed, or over no regular file; and what
// check_writable throws.
void check_checkpoint_file(const std::string& file, bool resume);

}  // namespace lampyris
