// SPDX-License-Identifier: MIT
//
// Any bytes as the CSV of sensors and as that of probes.
#include <cmath>

#include "fuzz/input_file.h"
#include "tool/sensors_csv.h"

namespace {

using namespace relume;

template <class Points>
void check(const Result<Points>& points) {
  if (!points) return test::require_one_line(points.error(), "points.csv");
  for (const auto& point : *points) {
    test::require(!point.name.empty(), "points have names");
    test::require(std::isfinite(point.position.x + point.position.y + point.position.z), "points are finite");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const auto file = test::input_file("points.csv", bytes, size);
  check(read_sensors(file));
  check(read_probes(file));
  return 0;
}
