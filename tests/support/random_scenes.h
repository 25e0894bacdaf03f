// What must hold for any scene: integrators agree on its means, and backends on its pixels.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace lampyris::test {

// The means of kImages images by each integrator are compared with those of `path`: more than kLimit of their common standard errors is
// a failure. With 30 degrees of freedom that has a probability of 3e-8.
constexpr uint32_t kImages = 16;
constexpr double kLimit = 7.5;
void expect_integrators_agree(uint32_t seed, const std::vector<std::string>& integrators);

// The same seed on `backend` and on the CPU.
void expect_backends_agree(uint32_t seed, const std::string& backend, const std::string& integrator);

}  // namespace lampyris::test
