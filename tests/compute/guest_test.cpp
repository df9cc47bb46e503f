// SPDX-License-Identifier: MIT
//
// GpuSolver as a guest of a renderer that owns device, memory and command buffers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vulkan/vulkan.h>

#include <cmath>
#include <glm/common.hpp>

#include "compute/device_fixture.h"
#include "compute/fake_host.h"
#include "compute/gpu_solver.h"
#include "compute/guest_solver.h"
#include "compute/near_reference.h"
#include "compute/test_models.h"
#include "compute/vulkan_info.h"

namespace relume::test {
namespace {

using testing::HasSubstr;

class GuestTest : public DeviceTest {
 protected:
  void submit(const std::function<void(VkCommandBuffer)>& record) {
    const auto submitted = device().submit(record);
    ASSERT_TRUE(submitted) << submitted.error().message;
  }

  void record_and_drop(const std::function<void(VkCommandBuffer)>& record) {
    VkDevice owner = device().host().device;
    auto pool_info = vulkan_info<VkCommandPoolCreateInfo>(VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO);
    pool_info.queueFamilyIndex = device().queue_family();
    VkCommandPool pool = VK_NULL_HANDLE;
    ASSERT_EQ(vkCreateCommandPool(owner, &pool_info, nullptr, &pool), VK_SUCCESS);
    auto info = vulkan_info<VkCommandBufferAllocateInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
    info.commandPool = pool, info.commandBufferCount = 1;
    VkCommandBuffer commands = VK_NULL_HANDLE;
    ASSERT_EQ(vkAllocateCommandBuffers(owner, &info, &commands), VK_SUCCESS);
    const auto begin = vulkan_info<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
    ASSERT_EQ(vkBeginCommandBuffer(commands, &begin), VK_SUCCESS);
    record(commands);
    EXPECT_EQ(vkEndCommandBuffer(commands), VK_SUCCESS);
    vkDestroyCommandPool(owner, pool, nullptr);
  }

  Model model_ = random_model({}, 1, {ValueCodec::f32, 2000});
  Lighting lighting_ = random_lighting(model_, 2);
};

constexpr PassWishes three_bounces() {
  return {.restart = true, .bounces = 3, .residual = true, .gather = true};
}

// A sum of what is not negative, each rounded by 2^-11, is off by no more; four products follow each other.
TEST_F(GuestTest, HalfPrecisionSendersCostTheirRounding) {
  const Model model = random_model({.nodes = 9, .spanning_nodes = 4, .probes = 6, .directional = true}, 21,
                                   {ValueCodec::unorm16});
  const Lighting lighting = random_lighting(model, 22);
  SolverOptions options;
  Guest single(device(), device().host(), model, lighting, options);
  options.half_senders_up_to = largest_radiosity(lighting);
  Guest half(device(), device().host(), model, lighting, options);
  EXPECT_EQ(single.system_bytes(0) - half.system_bytes(0), 8 * model.systems[0].imports.size());
  single.together(three_bounces());
  half.together(three_bounces());
  const double allowed = std::pow(1.0 + std::exp2(-11.0), 4.0) - 1.0;
  const auto expect_close = [&](const char* what, const auto& found, const auto& exact) {
    const double error = compare(what, found.values, exact.values, exact.magnitudes).max_relative_error;
    EXPECT_LE(error, allowed) << what;
    EXPECT_GT(error, 1e-6) << what;
  };
  expect_close("moments", flat_moments(half.moments(), half.irradiance()),
               flat_moments(single.moments(), single.irradiance()));
  expect_close("probes", flat_coefficients(half.probes()), flat_coefficients(single.probes()));
  const double error = compare("irradiance", half.irradiance(), single.irradiance()).max_relative_error;
  EXPECT_LE(error, allowed);
  EXPECT_GT(error, 1e-6);
}

TEST_F(GuestTest, HalfPrecisionNeedsARange) {
  for (const double limit : {-1.0, std::nan(""), 1e31}) {
    const auto solver = GpuSolver::create(device().host(), model_, {.half_senders_up_to = limit});
    ASSERT_FALSE(solver);
    EXPECT_THAT(solver.error().message, HasSubstr("half_senders_up_to"));
  }
}

TEST_F(GuestTest, StaysInsideTheMemoryOfItsHost) {
  for (const RowKernel kernel : {RowKernel::row_per_thread, RowKernel::row_per_8_lanes}) {
    Guest guest(device(), device().host(), model_, lighting_, {.kernel = kernel});
    guest.together(three_bounces());
    EXPECT_TRUE(guest.correct(3));
    VkDeviceSize asked = 0;
    for (const BufferRequirement& buffer : guest.solver().buffers()) asked += buffer.byte_size;
    for (std::uint32_t s = 0; s < model_.systems.size(); ++s) asked += guest.system_bytes(s);
    EXPECT_EQ(guest.memory().handed_out(), asked);
  }
}

TEST_F(GuestTest, NodesOfTreesAndAboveTheSystemsAreMeans) {
  for (const std::uint32_t spanning : {0u, 9u}) {
    const Model model =
        random_model({.nodes = 30, .spanning_nodes = spanning, .probes = 9, .directional = true}, 8);
    const Lighting lighting = random_lighting(model, 9);
    Guest guest(device(), device().host(), model, lighting);
    guest.together(three_bounces());
    EXPECT_TRUE(guest.correct(3));
  }
}

TEST_F(GuestTest, TheResidualIsWhatTheLastBounceChanged) {
  std::vector<Rgb> weights;
  for (std::size_t i = 0; i < lighting_.albedo.size(); ++i) {
    // Powers of two, so that dividing by them rounds nothing.
    weights.emplace_back(i % 2 == 0 ? 0.5 : 0.125, 1.0, i % 3 == 0 ? 0.25 : 1.0);
  }
  Guest guest(device(), device().host(), model_, lighting_, {}, weights);
  guest.together({.restart = true, .bounces = 2, .residual = true});
  const std::vector<Rgb> after = guest.radiosity();
  const std::vector<Rgb> before = guest.radiosity(false);
  const std::vector<Residual> residuals = read_residuals(guest.memory().bytes(guest.solver().residuals()));
  ASSERT_EQ(residuals.size(), model_.systems.size());
  const std::vector<std::uint32_t> offsets = cluster_offsets(model_);
  for (std::size_t s = 0; s < residuals.size(); ++s) {
    Residual expected;
    for (std::size_t i = offsets[s]; i < offsets[s + 1]; ++i) {
      const Rgb change = glm::abs(after[i] - before[i]);
      expected.weighted_change = glm::max(expected.weighted_change, change / weights[i]);
      expected.change = glm::max(expected.change, change);
      expected.weighted_radiosity = glm::max(expected.weighted_radiosity, after[i] / weights[i]);
      expected.radiosity = glm::max(expected.radiosity, after[i]);
    }
    for (int channel = 0; channel < 3; ++channel) {
      // The device subtracts in 32 bits: half a unit in the last place of the difference.
      EXPECT_NEAR(residuals[s].change[channel], expected.change[channel], expected.change[channel] * 0x1p-23);
      EXPECT_NEAR(residuals[s].weighted_change[channel], expected.weighted_change[channel],
                  expected.weighted_change[channel] * 0x1p-23);
      EXPECT_EQ(residuals[s].radiosity[channel], expected.radiosity[channel]);
      EXPECT_EQ(residuals[s].weighted_radiosity[channel], expected.weighted_radiosity[channel]);
    }
  }
}

TEST_F(GuestTest, TwoSolversShareACommandBuffer) {
  const Model other_model =
      random_model({.clusters_of_system = {50}, .gather_rows = 30}, 3, {ValueCodec::unorm16});
  const Lighting other_lighting = random_lighting(other_model, 4);
  Guest one(device(), device().host(), model_, lighting_);
  Guest two(device(), device().host(), other_model, other_lighting, {.kernel = RowKernel::row_per_thread});
  for (int i = 0; i < 4; ++i) {
    const FramePlan plan_one =
        one.solver().plan(one.schedule(), PassWishes{.restart = i == 0, .bounces = 1, .gather = true});
    const FramePlan plan_two =
        two.solver().plan(two.schedule(), PassWishes{.restart = i == 0, .bounces = 2, .gather = true});
    submit([&](VkCommandBuffer commands) {
      EXPECT_TRUE(one.solver().record_frame(commands, {.plan = &plan_one}, {}));
      EXPECT_TRUE(two.solver().record_frame(commands, {.plan = &plan_two}, {}));
    });
    one.schedule() = plan_one.next;
    two.schedule() = plan_two.next;
  }
  EXPECT_TRUE(one.correct(4));
  EXPECT_TRUE(two.correct(8));
}

TEST_F(GuestTest, TwoDevicesInOneProcess) {
  auto second = StandaloneDevice::create({.validation = true});
  ASSERT_TRUE(second) << second.error().message;
  {
    Guest here(device(), device().host(), model_, lighting_);
    Guest there(*second, second->host(), model_, lighting_);
    here.together(three_bounces());
    there.together(three_bounces());
    EXPECT_TRUE(here.correct(3));
    EXPECT_TRUE(there.correct(3));
    EXPECT_EQ(here.radiosity(), there.radiosity());
  }
  EXPECT_THAT(second->validation_messages(), testing::IsEmpty());
}

TEST_F(GuestTest, ADroppedCommandBufferFalsifiesNothing) {
  Guest guest(device(), device().host(), model_, lighting_);
  guest.together({.restart = true, .bounces = 1});
  const FramePlan dropped =
      guest.solver().plan(guest.schedule(), PassWishes{.bounces = 5, .residual = true, .gather = true});
  record_and_drop([&](VkCommandBuffer commands) {
    EXPECT_TRUE(guest.solver().record_frame(commands, {.plan = &dropped}, {}));
  });
  guest.together({.bounces = 1, .gather = true});
  EXPECT_TRUE(guest.correct(2));
}

TEST_F(GuestTest, EveryKernelFetchAndSlicingGivesTheSameBits) {
  std::vector<SolverOptions> variants;
  for (const RowKernel kernel : {RowKernel::row_per_thread, RowKernel::row_per_8_lanes}) {
    for (const MatrixFetch fetch : {MatrixFetch::storage, MatrixFetch::texels}) {
      for (const std::uint64_t slice : {1, 333, 4'000'000}) variants.push_back({kernel, slice, fetch});
    }
  }
  std::vector<DeviceSolution> solutions;
  for (const SolverOptions& options : variants) {
    Guest guest(device(), device().host(), model_, lighting_, options);
    guest.together(three_bounces());
    solutions.push_back(guest.results(3));
    EXPECT_EQ(guest.memory().damaged_bytes(), 0u);
  }
  ASSERT_TRUE(agrees_with_reference(solutions[0], model_, lighting_));
  for (const DeviceSolution& solution : solutions) {
    EXPECT_EQ(solution.solution.radiosity, solutions[0].solution.radiosity);
    EXPECT_EQ(solution.irradiance, solutions[0].irradiance);
  }
}

TEST_F(GuestTest, PartsOfAPassMayGoIntoDifferentSubmissions) {
  Guest guest(device(), device().host(), model_, lighting_, {RowKernel::row_per_8_lanes, 200});
  Guest whole(device(), device().host(), model_, lighting_);
  PassWishes wishes = three_bounces();
  whole.together(wishes);
  wishes.max_form_factors = 500;
  FramePlan plan;
  int submissions = 0;
  for (; !plan.pass_complete; ++submissions) {
    plan = guest.solver().plan(guest.schedule(), wishes);
    EXPECT_LE(plan.cost, 500u);
    submit([&](VkCommandBuffer commands) {
      EXPECT_TRUE(guest.solver().record_frame(commands, {.plan = &plan}, {}));
    });
    guest.schedule() = plan.next;
  }
  EXPECT_GT(submissions, 20);
  EXPECT_TRUE(guest.correct(3));
  EXPECT_EQ(guest.radiosity(), whole.radiosity());
  EXPECT_EQ(guest.irradiance(), whole.irradiance());
  const auto residuals = [](Guest& of) {
    const auto bytes = of.memory().bytes(of.solver().residuals());
    return std::vector<std::byte>(bytes.begin(), bytes.end());
  };
  EXPECT_EQ(residuals(guest), residuals(whole));
}

TEST_F(GuestTest, ObjectsComeFromTheCallbacksOfTheHostAndGoBack) {
  CountingCallbacks callbacks;
  HostDevice host = device().host();
  host.allocation_callbacks = callbacks.get();
  {
    Guest guest(device(), host, model_, lighting_);
    const FramePlan plan = guest.solver().plan(guest.schedule(), three_bounces());
    submit([&](VkCommandBuffer commands) {
      const int before = callbacks.made();
      EXPECT_TRUE(guest.solver().record_frame(commands, {.plan = &plan}, {}));
      EXPECT_EQ(callbacks.made(), before) << "recording must not allocate";
    });
    guest.schedule() = plan.next;
    EXPECT_TRUE(guest.correct(3));
    const std::size_t bytes = callbacks.living_bytes();
    guest.unload(1);
    EXPECT_LT(callbacks.living_bytes(), bytes);
  }
  EXPECT_EQ(callbacks.living(), 0);
  EXPECT_EQ(callbacks.living_bytes(), 0u);
}

TEST_F(GuestTest, PipelinesGoThroughTheCacheOfTheHost) {
  const auto info = vulkan_info<VkPipelineCacheCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO);
  HostDevice host = device().host();
  ASSERT_EQ(vkCreatePipelineCache(host.device, &info, nullptr, &host.pipeline_cache), VK_SUCCESS);
  {
    Guest guest(device(), host, model_, lighting_);
    guest.together(three_bounces());
    EXPECT_TRUE(guest.correct(3));
  }
  vkDestroyPipelineCache(host.device, host.pipeline_cache, nullptr);
}

TEST_F(GuestTest, BindNamesTheBufferThatDoesNotFit) {
  auto solver = GpuSolver::create(device().host(), model_, {});
  ASSERT_TRUE(solver) << solver.error().message;
  std::vector<BufferRange> ranges;
  for (const BufferRequirement& buffer : solver->buffers())
    ranges.push_back({VK_NULL_HANDLE, 0, buffer.byte_size});
  ranges.pop_back();
  EXPECT_EQ(solver->bind(ranges).error().code, ErrorCode::usage);
  ranges.push_back({VK_NULL_HANDLE, 0, 1});
  EXPECT_THAT(solver->bind(ranges).error().message, HasSubstr(solver->buffers().back().name));
  ranges.back() = {VK_NULL_HANDLE, 3, 1u << 20};
  EXPECT_THAT(solver->bind(ranges).error().message, HasSubstr("at 3"));
}

TEST_F(GuestTest, TheErrorOfAnAllocatorComesThrough) {
  auto solver = GpuSolver::create(device().host(), model_, {});
  ASSERT_TRUE(solver) << solver.error().message;
  const auto nothing = [](const BufferRequirement&) -> Result<BufferRange> {
    return fail(ErrorCode::out_of_memory, "none left");
  };
  const auto bound = solver->bind(nothing);
  ASSERT_FALSE(bound);
  EXPECT_EQ(bound.error().message, "none left");
  const auto loaded = solver->load(model_, 0, nothing);
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().message, "none left");
  EXPECT_FALSE(solver->loaded(0));
}

TEST_F(GuestTest, LoadSaysWhatItCannotLoad) {
  Guest guest(device(), device().host(), model_, lighting_);
  const auto message = [&](const Model& model, std::uint32_t system) {
    const auto loaded = guest.solver().load(model, system, std::span<const BufferRange>{});
    EXPECT_FALSE(loaded);
    return loaded ? std::string() : loaded.error().message;
  };
  EXPECT_EQ(message(model_, 2), "system 2 is loaded already");
  EXPECT_EQ(message(unloaded(model_, 2), 2), "the model has no data of system 2");
  EXPECT_EQ(message(model_, 4), "the model has no data of system 4");
  EXPECT_THAT(message(random_model({.clusters_of_system = {3}}, 1), 0), HasSubstr("was made for one with 4"));
}

TEST_F(GuestTest, ALimitOfSendersIsKept) {
  // Systems of 37, 1, 120 and 64 clusters.
  auto solver = GpuSolver::create(device().host(), model_, {.sender_capacity = 130});
  ASSERT_TRUE(solver) << solver.error().message;
  GuardedMemory memory(device(), VkDeviceSize{1} << 20, solver->buffers()[0].usage);
  const auto allocate = [&](const BufferRequirement& requirement) { return memory.allocate(requirement); };
  ASSERT_TRUE(solver->bind(allocate));
  ASSERT_TRUE(solver->load(model_, 2, allocate));
  const auto refused = solver->load(model_, 0, allocate);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::out_of_memory);
  EXPECT_THAT(refused.error().message, HasSubstr("sender_capacity is 130"));
  EXPECT_TRUE(solver->load(model_, 1, allocate));
  solver->unload(2);
  EXPECT_TRUE(solver->load(model_, 0, allocate));
  EXPECT_TRUE(solver->load(model_, 3, allocate));
}

TEST_F(GuestTest, RecordingSaysWhatIsNotThere) {
  Guest guest(device(), device().host(), model_, lighting_);
  const FramePlan plan = guest.solver().plan(guest.schedule(), FrameWishes{});
  const VkBuffer buffer = guest.solver().residuals().buffer;
  const InputCopy too_long[] = {{Quantity::direct, 1, 0, {buffer, 0, 32}}};
  const InputCopy too_late[] = {{Quantity::direct, 0, 37, {buffer, 0, 16}}};
  submit([&](VkCommandBuffer commands) {
    EXPECT_THAT(guest.solver().record_frame(commands, {}, {}).error().message, HasSubstr("needs a plan"));
    for (const auto& copies : {too_long, too_late}) {
      const auto recorded = guest.solver().record_frame(commands, {.plan = &plan, .copies = {copies, 1}}, {});
      ASSERT_FALSE(recorded);
      EXPECT_EQ(recorded.error().code, ErrorCode::usage);
    }
  });
  guest.unload(3);
  submit([&](VkCommandBuffer commands) {
    const auto recorded = guest.solver().record_frame(commands, {.plan = &plan}, {});
    ASSERT_FALSE(recorded);
    EXPECT_EQ(recorded.error().message, "the schedule has system 3 active, but it is not loaded");
  });
}

TEST_F(GuestTest, AMissingEntryPointIsNamed) {
  HostDevice host = device().host();
  host.get_instance_proc_addr = get_proc_addr_without_fill;
  const auto solver = GpuSolver::create(host, model_, {});
  ASSERT_FALSE(solver);
  EXPECT_EQ(solver.error().code, ErrorCode::no_device);
  EXPECT_THAT(solver.error().message, HasSubstr("vkCmdFillBuffer"));
}

TEST_F(GuestTest, ADeviceWithTooFewBindingsIsNamed) {
  HostDevice host = device().host();
  host.get_instance_proc_addr = get_proc_addr_of_few_storage_buffers;
  const auto solver = GpuSolver::create(host, model_, {});
  ASSERT_FALSE(solver);
  EXPECT_EQ(solver.error().code, ErrorCode::no_device);
  EXPECT_THAT(solver.error().message, HasSubstr(device().name()));
  EXPECT_THAT(solver.error().message,
              HasSubstr("maxPerStageDescriptorStorageBuffers of at least 17 (it offers 4)"));
}

TEST_F(GuestTest, ShortTexelBuffersAreNotUsedForLongBlocks) {
  // 1024 rows of 256 entries.
  const Model model = furnace_model(1024, 256);
  const Lighting lighting = random_lighting(model, 5);
  HostDevice host = device().host();
  host.get_instance_proc_addr = get_proc_addr_of_short_texel_buffers;
  auto demanding = GpuSolver::create(host, model, {.fetch = MatrixFetch::texels});
  ASSERT_TRUE(demanding) << demanding.error().message;
  GuardedMemory memory(device(), VkDeviceSize{8} << 20, demanding->buffers()[0].usage);
  const auto refused = demanding->load(
      model, 0, [&](const BufferRequirement& requirement) { return memory.allocate(requirement); });
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("262144 elements, but the device has at most 65536"));

  Guest guest(device(), host, model, lighting);
  guest.together(three_bounces());
  EXPECT_TRUE(guest.correct(3));
}

}  // namespace
}  // namespace relume::test
