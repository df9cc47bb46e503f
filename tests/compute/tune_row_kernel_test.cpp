// SPDX-License-Identifier: MIT
#include "compute/standalone/tune_row_kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "compute/device_fixture.h"
#include "compute/row_kernels.h"
#include "compute/standalone/kernel_cache.h"
#include "compute/standalone/solve_on_device.h"
#include "compute/test_models.h"

namespace relume::test {
namespace {

std::filesystem::path empty_folder(const std::string& name) {
  const auto folder = std::filesystem::temp_directory_path() / ("relume-" + name);
  std::filesystem::remove_all(folder);
  return folder;
}

class TuneRowKernel : public DeviceTest {};

// A trial whose bits differ is left out, so that none may be missing.
TEST_F(TuneRowKernel, EveryTrialGivesTheSameBitsAndTakesTime) {
  const auto times = time_row_kernels(device(), ValueCodec::sqrt8);
  ASSERT_TRUE(times) << times.error().message;
  const bool shuffles = supports_row_kernel(device().host(), RowKernel::tile_shuffle);
  EXPECT_EQ(times->size(), shuffles ? 4u : 2u);
  EXPECT_GT(times->front().seconds, 0.0);
  EXPECT_TRUE(
      std::is_sorted(times->begin(), times->end(),
                     [](const RowKernelTime& a, const RowKernelTime& b) { return a.seconds < b.seconds; }));
}

TEST_F(TuneRowKernel, WhatWasMeasuredIsNotMeasuredAgain) {
  const Model model = random_model({}, 51, {ValueCodec::unorm16, kMaxBlockBytes, 8});
  const auto cache = empty_folder("tuned") / "kernels";
  const auto measured = tuned_row_kernel(device(), model, cache);
  ASSERT_TRUE(measured) << measured.error().message;
  std::string line;
  std::ifstream in(cache);
  ASSERT_TRUE(std::getline(in, line));
  // The slowest of all is believed once it is in the file.
  const std::string key = line.substr(0, line.find('\t'));
  const RowKernelChoice slow{RowKernel::tile_shared, MatrixFetch::storage};
  ASSERT_TRUE(write_kernel_cache(cache, key, slow));
  const auto known = tuned_row_kernel(device(), model, cache);
  ASSERT_TRUE(known);
  EXPECT_EQ(*known, slow);
}

TEST_F(TuneRowKernel, RowsThatStandAloneAreNotMeasured) {
  const Model model = random_model({}, 52, {ValueCodec::f32, kMaxBlockBytes, 1});
  const auto cache = empty_folder("untuned") / "kernels";
  const auto chosen = tuned_row_kernel(device(), model, cache);
  ASSERT_TRUE(chosen);
  EXPECT_EQ(chosen->kernel, default_row_kernel(device(), model));
  EXPECT_FALSE(std::filesystem::exists(cache));
}

TEST(KernelCache, KeepsOneLineAKey) {
  const auto file = empty_folder("kernel-cache") / "below" / "kernels";
  EXPECT_FALSE(read_kernel_cache(file, "card"));
  const RowKernelChoice a{RowKernel::tile_shuffle, MatrixFetch::texels};
  const RowKernelChoice b{RowKernel::tile_shared, MatrixFetch::storage};
  ASSERT_TRUE(write_kernel_cache(file, "card", a));
  ASSERT_TRUE(write_kernel_cache(file, "card 2", b));
  EXPECT_EQ(read_kernel_cache(file, "card"), a);
  EXPECT_EQ(read_kernel_cache(file, "card 2"), b);
  ASSERT_TRUE(write_kernel_cache(file, "card", b));
  EXPECT_EQ(read_kernel_cache(file, "card"), b);
  EXPECT_FALSE(read_kernel_cache(file, "car"));
}

TEST(KernelCache, WhatItDoesNotUnderstandIsMeasuredAgain) {
  const auto file = empty_folder("broken-cache") / "kernels";
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file) << "card\ttile_of_tomorrow\ttexels\nother\ttile_shared\tsomewhere\n";
  EXPECT_FALSE(read_kernel_cache(file, "card"));
  EXPECT_FALSE(read_kernel_cache(file, "other"));
  EXPECT_FALSE(write_kernel_cache("/proc/no/such/kernels", "card", {}));
}

}  // namespace
}  // namespace relume::test
