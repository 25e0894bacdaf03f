// The one place that includes vulkan_raii.hpp, which costs ten seconds a file: keep it below src/backends/vulkan/.
#pragma once

#include <vulkan/vulkan_raii.hpp>
