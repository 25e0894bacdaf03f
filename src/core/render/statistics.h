// A rendering's record as `--stats` writes it (schema lampyris.stats/1; docs/stats.md describes every key), and as the metadata of
// its image.
#pragma once

#include "core/render/run_record.h"

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <map>
#include <string>

namespace lampyris {

nlohmann::ordered_json statistics_json(const RunRecord& run);
// The same provenance as attributes of an image: "lampyris.scene", "lampyris.seed", ...
std::map<std::string, std::string> image_metadata(const RunRecord& run);

size_t peak_resident_bytes();  // of this process

}  // namespace lampyris
