// SPDX-License-Identifier: MIT
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "compute/standalone/standalone_device.h"

namespace relume::test {

/// Whether this program is the pass with GPU-assisted validation; else core and synchronization.
#ifdef RELUME_GPU_ASSISTED
inline constexpr bool kGpuAssisted = true;
#else
inline constexpr bool kGpuAssisted = false;
#endif

/// A device with validation. Any message of the layer fails the test, unless the
/// test expects it.
class DeviceTest : public testing::Test {
 protected:
  void SetUp() override {
    auto made = StandaloneDevice::create({.validation = true, .gpu_assisted = kGpuAssisted});
    if (!made && made.error().code == ErrorCode::no_device) GTEST_SKIP() << made.error().message;
    ASSERT_TRUE(made) << made.error().message;
    device_.emplace(std::move(*made));
    if (!device_->validating()) GTEST_SKIP() << "the Khronos validation layer is not installed";
  }

  void TearDown() override {
    if (!device_ || expects_messages_) return;
    const std::vector<std::string> messages = device_->validation_messages();
    EXPECT_TRUE(messages.empty()) << messages.size()
                                  << " validation messages, the first: " << messages.front();
  }

  StandaloneDevice& device() { return *device_; }
  void expect_validation_messages() { expects_messages_ = true; }

 private:
  std::optional<StandaloneDevice> device_;
  bool expects_messages_ = false;
};

}  // namespace relume::test
