// SPDX-License-Identifier: MIT
//
// Sealed rooms where clusters, rays and cut follow from an error target.
#include <tuple>

#include "verification/sealed_rooms.h"

namespace relume::test {
namespace {

class SealedRoomsToAnError : public testing::TestWithParam<std::tuple<double, double>> {};

TEST_P(SealedRoomsToAnError, StayDarkBesideALitOne) {
  const auto [thickness, error] = GetParam();
  const Scene scene = sealed_rooms(thickness);
  PrecomputeOptions options;
  options.texel_size = kLumel;
  options.error = error;
  const Model model = precompute_or_throw(scene, options);
  expect_dark(light_first_room(model, scene, thickness));
  expect_one_sided(model, thickness);
}

INSTANTIATE_TEST_SUITE_P(Errors, SealedRoomsToAnError,
                         testing::Combine(kThicknesses, testing::Values(0.05, 0.01)));

}  // namespace
}  // namespace relume::test
