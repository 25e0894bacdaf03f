// The one header that includes vulkan_raii.hpp, which takes ten seconds to compile per file: include it only in
// src/backends/vulkan/.
#pragma once

#include <vulkan/vulkan_raii.hpp>
