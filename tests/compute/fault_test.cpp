// SPDX-License-Identifier: MIT
//
// Every call of Vulkan that can fail is made to, once: one error comes out, nothing is left behind, and a
// solver that is made again gives the same bits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <set>
#include <string>

#include "compute/device_fixture.h"
#include "compute/direct_light.h"
#include "compute/guest_solver.h"
#include "compute/host_image.h"
#include "compute/light_cache.h"
#include "compute/lightmap_pass.h"
#include "compute/screen_pass.h"
#include "compute/test_models.h"
#include "support/quad_model.h"

namespace relume::test {
namespace {

using testing::HasSubstr;

class FaultTest : public DeviceTest {
 protected:
  void SetUp() override {
    DeviceTest::SetUp();
    inject_fault(-1, VK_SUCCESS);
  }

  HostDevice faulty_host(const CountingCallbacks& callbacks) {
    HostDevice host = device().host();
    host.get_instance_proc_addr = get_proc_addr_with_faults;
    host.allocation_callbacks = callbacks.get();
    return host;
  }

  /// Creates, binds and loads everything; the error of what failed first.
  Result<void> make(const HostDevice& host, std::optional<GpuSolver>& solver) {
    memory_.emplace(device(), VkDeviceSize{4} << 20, kUsage);
    const auto allocate = [this](const BufferRequirement& needed) { return memory_->allocate(needed); };
    auto made = GpuSolver::create(host, model_, {});
    if (!made) return tl::unexpected<Error>(made.error());
    solver.emplace(std::move(*made));
    if (auto bound = solver->bind(allocate); !bound) return bound;
    for (std::uint32_t s = 0; s < model_.systems.size(); ++s) {
      if (auto loaded = solver->load(model_, s, allocate); !loaded) return loaded;
    }
    return {};
  }

  /// Every call of `make` that can fail is made to, in each way, and the names of those calls are returned.
  /// `make` destroys what it makes, and finds new memory each time.
  std::set<std::string> failing_calls(const std::function<Result<void>(const HostDevice&)>& make) {
    CountingCallbacks callbacks;
    const HostDevice host = faulty_host(callbacks);
    memory_.emplace(device(), VkDeviceSize{16} << 20, kUsage);
    inject_fault(-1, VK_SUCCESS);
    const auto unharmed = make(host);
    EXPECT_TRUE(unharmed) << unharmed.error().message;
    const int calls = fallible_calls();
    std::set<std::string> failed;
    for (const VkResult result : {VK_ERROR_DEVICE_LOST, VK_ERROR_OUT_OF_DEVICE_MEMORY}) {
      for (int call = 0; call < calls; ++call) {
        memory_.emplace(device(), VkDeviceSize{16} << 20, kUsage);
        inject_fault(call, result);
        const auto made = make(host);
        EXPECT_FALSE(made) << "call " << call << ", " << failed_call();
        if (made) continue;
        EXPECT_EQ(made.error().code,
                  result == VK_ERROR_DEVICE_LOST ? ErrorCode::no_device : ErrorCode::out_of_memory);
        EXPECT_THAT(made.error().message, HasSubstr("failed: "));
        EXPECT_EQ(fallible_calls(), call + 1) << "nothing is called after the failure of " << failed_call();
        failed.insert(failed_call());
        EXPECT_EQ(callbacks.living(), 0) << failed_call();
      }
    }
    inject_fault(-1, VK_SUCCESS);
    return failed;
  }

  BufferRange range(VkDeviceSize bytes) { return *memory_->allocate({"range", bytes, 256, 0}); }
  ClusterColorRanges colors() { return {range(16), range(16)}; }
  std::vector<BufferRange> ranges_of(std::span<const BufferRequirement> needed) {
    std::vector<BufferRange> ranges;
    for (const BufferRequirement& buffer : needed) ranges.push_back(*memory_->allocate(buffer));
    return ranges;
  }

  Result<void> make_lightmap(const HostDevice& host, const System& system) {
    auto pass = LightmapPass::create(host, system, lightmap_texels(system), LightmapFormat::rgba16f);
    if (!pass) return fail(pass.error());
    HostImage image = make_lightmap_image(device(), pass->image());
    return pass->bind(ranges_of(pass->buffers()), {range(16 * system.lumels.size())},
                      image.view(pass->image().storage_view_format, VK_IMAGE_USAGE_STORAGE_BIT));
  }

  static constexpr VkBufferUsageFlags kUsage =
      VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT |
      VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;

  Model model_ = random_model({.clusters_of_system = {20, 30}, .gather_rows = 12, .nodes = 3}, 1);
  std::optional<GuardedMemory> memory_;
};

TEST_F(FaultTest, EveryFailureIsOneErrorAndLeavesNothing) {
  // Creation of modules, layouts, pipelines, views, pools and sets.
  EXPECT_EQ(failing_calls([this](const HostDevice& host) {
              std::optional<GpuSolver> solver;
              return make(host, solver);
            }).size(),
            7u);
}

TEST_F(FaultTest, PassesFailInTheSameWay) {
  Model model;
  add_quad(model, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 4);
  model.occluders.texture = {{0, {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1)}},
                             {1, {glm::vec2(0, 0), glm::vec2(1, 1), glm::vec2(0, 1)}}};
  System& system = model.systems[0];
  system.lightmap_width = system.lightmap_height = 16;
  for (const auto& make_pass : std::vector<std::function<Result<void>(const HostDevice&)>>{
           [&](const HostDevice& host) { return make_lightmap(host, system); },
           [&](const HostDevice& host) {
             auto pass = MaterialPass::create(host, model, 0, {});
             return pass ? pass->bind(ranges_of(pass->buffers()), colors()) : fail(pass.error());
           },
           [&](const HostDevice& host) {
             auto cache = LightCache::create(host, 16, 2);
             return cache ? cache->bind(ranges_of(cache->buffers()), range(256)) : fail(cache.error());
           },
           [&](const HostDevice& host) {
             auto pass = ScreenPass::create(host, system, texture_footprint(model, 0, 0, 8, 8), {});
             return pass ? pass->bind(ranges_of(pass->buffers()), colors()) : fail(pass.error());
           },
           [&](const HostDevice& host) {
             auto light = DirectLight::create(host, model, {.max_pairs = 64});
             return light ? light->bind(ranges_of(light->buffers())) : fail(light.error());
           }}) {
    // Modules, layouts, pipelines, pools and sets.
    EXPECT_GE(failing_calls(make_pass).size(), 5u);
  }
}

TEST_F(FaultTest, ALoadThatRanOutOfMemoryMayBeTriedAgain) {
  CountingCallbacks callbacks;
  const HostDevice host = faulty_host(callbacks);
  std::optional<GpuSolver> solver;
  ASSERT_TRUE(make(host, solver));
  const auto allocate = [this](const BufferRequirement& needed) { return memory_->allocate(needed); };
  solver->unload(1);
  inject_fault(0, VK_ERROR_OUT_OF_DEVICE_MEMORY);
  const auto failed = solver->load(model_, 1, allocate);
  ASSERT_FALSE(failed);
  EXPECT_FALSE(solver->loaded(1));
  EXPECT_TRUE(solver->loaded(0));
  EXPECT_TRUE(solver->load(model_, 1, allocate));
}

TEST_F(FaultTest, ALostDeviceIsRememberedAndTheFileGivesTheSameOnANewOne) {
  const Lighting lighting = random_lighting(model_, 2);
  CountingCallbacks callbacks;
  const HostDevice host = faulty_host(callbacks);
  const PassWishes wishes{.restart = true, .bounces = 3, .gather = true};
  std::vector<Rgb> irradiance;
  {
    Guest guest(device(), host, model_, lighting);
    guest.together(wishes);
    irradiance = guest.irradiance();
    guest.unload(1);
    inject_fault(0, VK_ERROR_DEVICE_LOST);
    GuardedMemory memory(device(), VkDeviceSize{4} << 20, kUsage);
    const auto allocate = [&](const BufferRequirement& needed) { return memory.allocate(needed); };
    const auto lost = guest.solver().load(model_, 1, allocate);
    ASSERT_FALSE(lost);
    EXPECT_THAT(lost.error().message, HasSubstr("the device was lost"));
    // The first error again, and nothing is asked of the device any more.
    const auto again = guest.solver().load(model_, 1, allocate);
    ASSERT_FALSE(again);
    EXPECT_EQ(again.error().message, lost.error().message);
    EXPECT_EQ(fallible_calls(), 1);
    const FramePlan plan = guest.solver().plan(make_schedule(2, 0.0), FrameWishes{});
    EXPECT_EQ(guest.solver().record_frame(VK_NULL_HANDLE, {.plan = &plan}, {}).error().message,
              lost.error().message);
  }
  EXPECT_EQ(callbacks.living(), 0);
  auto fresh = StandaloneDevice::create({.validation = true});
  ASSERT_TRUE(fresh);
  {
    Guest guest(*fresh, fresh->host(), model_, lighting);
    guest.together(wishes);
    EXPECT_EQ(guest.irradiance(), irradiance);
  }
  EXPECT_THAT(fresh->validation_messages(), testing::IsEmpty());
}

TEST_F(FaultTest, AHostMayLearnOfALostDeviceFirst) {
  std::optional<GpuSolver> solver;
  ASSERT_TRUE(make(device().host(), solver));
  solver->latch({ErrorCode::no_device, "the swapchain says that the device is lost"});
  solver->latch({ErrorCode::no_device, "a later one"});
  const FramePlan plan = solver->plan(make_schedule(2, 0.0), FrameWishes{});
  EXPECT_EQ(solver->record_frame(VK_NULL_HANDLE, {.plan = &plan}, {}).error().message,
            "the swapchain says that the device is lost");
}

}  // namespace
}  // namespace relume::test
