// SPDX-License-Identifier: MIT
//
// GpuSolver as a guest of a renderer that owns device, memory and command buffers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vulkan/vulkan.h>

#include <glm/common.hpp>

#include "compute/device_fixture.h"
#include "compute/fake_host.h"
#include "compute/gpu_solver.h"
#include "compute/near_reference.h"
#include "compute/test_models.h"
#include "compute/vulkan_info.h"

namespace relume::test {
namespace {

using testing::HasSubstr;

/// So little that most pieces are cut.
constexpr VkDeviceSize kStagingBytes = 10000;
constexpr VkDeviceSize kHostBytes = VkDeviceSize{16} << 20;

/// A model on a device: memory with guards, a solver bound to it, and all of its data uploaded.
class Guest {
 public:
  Guest(StandaloneDevice& device, const HostDevice& host, const Model& model, const Lighting& lighting,
        const SolverOptions& options, const std::vector<Rgb>& weights = {})
      : device_(device), model_(model), lighting_(lighting) {
    auto made = GpuSolver::create(host, model, options);
    EXPECT_TRUE(made) << made.error().message;
    solver_.emplace(std::move(*made));
    memory_.emplace(device, kHostBytes, solver_->buffers()[0].usage);
    const auto bound = solver_->bind(
        [this](const BufferRequirement& requirement) { return memory_->allocate(requirement); });
    EXPECT_TRUE(bound) << bound.error().message;
    upload(solver_->model_data(model));
    upload(solver_->lighting_data(lighting, weights));
  }

  const GpuSolver& solver() const { return *solver_; }
  const GuardedMemory& memory() const { return *memory_; }

  DeviceSolution results(std::uint32_t bounces, RadiosityHalf half) const {
    DeviceSolution out;
    out.solution.bounces = bounces;
    out.solution.radiosity = memory_->read_rgb(solver_->radiosity(half));
    for (std::uint32_t system = 0; system < model_.systems.size(); ++system) {
      const std::vector<Rgb> irradiance = memory_->read_rgb(solver_->irradiance(system));
      out.irradiance.insert(out.irradiance.end(), irradiance.begin(), irradiance.end());
    }
    return out;
  }

  testing::AssertionResult correct(std::uint32_t bounces, RadiosityHalf half) const {
    if (const std::size_t damaged = memory_->damaged_bytes(); damaged > 0) {
      return testing::AssertionFailure() << damaged << " bytes outside of the buffers were written";
    }
    return agrees_with_reference(results(bounces, half), model_, lighting_);
  }

 private:
  void upload(const UploadData& data) {
    auto staging =
        make_device_buffer(device_, kStagingBytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, MemoryKind::upload);
    ASSERT_TRUE(staging) << staging.error().message;
    UploadCursor cursor;
    bool done = false;
    while (!done) {
      const auto submitted = device_.submit([&](VkCommandBuffer commands) {
        done = solver_->record_upload(commands, data, {staging->range(), staging->mapped}, cursor);
      });
      ASSERT_TRUE(submitted) << submitted.error().message;
    }
  }

  StandaloneDevice& device_;
  const Model& model_;
  const Lighting& lighting_;
  std::optional<GuardedMemory> memory_;
  std::optional<GpuSolver> solver_;
};

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
    info.commandPool = pool;
    info.commandBufferCount = 1;
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

TEST_F(GuestTest, StaysInsideTheMemoryOfItsHost) {
  for (const RowKernel kernel : {RowKernel::row_per_thread, RowKernel::row_per_8_lanes}) {
    const Guest guest(device(), device().host(), model_, lighting_, {.kernel = kernel});
    RadiosityHalf half{};
    submit([&](VkCommandBuffer commands) {
      half = guest.solver().record_bounces(commands, 3, guest.solver().record_start(commands));
      guest.solver().record_residual(commands, half);
      guest.solver().record_gather(commands, half);
    });
    EXPECT_EQ(half, RadiosityHalf::b);
    EXPECT_TRUE(guest.correct(3, half));
    VkDeviceSize asked = 0;
    for (const BufferRequirement& buffer : guest.solver().buffers()) asked += buffer.byte_size;
    EXPECT_EQ(guest.memory().handed_out(), asked);
  }
}

TEST_F(GuestTest, TheResidualIsWhatTheLastBounceChanged) {
  std::vector<Rgb> weights;
  for (std::size_t i = 0; i < lighting_.albedo.size(); ++i) {
    // Powers of two, so that dividing by them rounds nothing.
    weights.emplace_back(i % 2 == 0 ? 0.5 : 0.125, 1.0, i % 3 == 0 ? 0.25 : 1.0);
  }
  const Guest guest(device(), device().host(), model_, lighting_, {}, weights);
  RadiosityHalf half{};
  submit([&](VkCommandBuffer commands) {
    half = guest.solver().record_bounces(commands, 2, guest.solver().record_start(commands));
    guest.solver().record_residual(commands, half);
    guest.solver().record_gather(commands, half);
  });
  const std::vector<Rgb> after = guest.results(2, half).solution.radiosity;
  const std::vector<Rgb> before = guest.results(1, other_half(half)).solution.radiosity;
  Residual expected;
  for (std::size_t i = 0; i < after.size(); ++i) {
    const Rgb change = glm::abs(after[i] - before[i]);
    expected.weighted_change = glm::max(expected.weighted_change, change / weights[i]);
    expected.change = glm::max(expected.change, change);
    expected.weighted_radiosity = glm::max(expected.weighted_radiosity, after[i] / weights[i]);
    expected.radiosity = glm::max(expected.radiosity, after[i]);
  }
  const Residual residual = read_residual(guest.memory().bytes(guest.solver().residual()));
  for (int channel = 0; channel < 3; ++channel) {
    // The device subtracts in 32 bits: half a unit in the last place of the difference.
    EXPECT_NEAR(residual.change[channel], expected.change[channel], expected.change[channel] * 0x1p-23);
    EXPECT_NEAR(residual.weighted_change[channel], expected.weighted_change[channel],
                expected.weighted_change[channel] * 0x1p-23);
    EXPECT_EQ(residual.radiosity[channel], expected.radiosity[channel]);
    EXPECT_EQ(residual.weighted_radiosity[channel], expected.weighted_radiosity[channel]);
  }
}

TEST_F(GuestTest, TwoSolversShareACommandBuffer) {
  const Model other_model =
      random_model({.clusters_of_system = {50}, .gather_rows = 30}, 3, {ValueCodec::unorm16});
  const Lighting other_lighting = random_lighting(other_model, 4);
  const Guest one(device(), device().host(), model_, lighting_, {});
  const Guest two(device(), device().host(), other_model, other_lighting,
                  {.kernel = RowKernel::row_per_thread});
  RadiosityHalf half_one{};
  RadiosityHalf half_two{};
  submit([&](VkCommandBuffer commands) {
    half_one = one.solver().record_start(commands);
    half_two = two.solver().record_start(commands);
    for (int i = 0; i < 4; ++i) {
      half_one = one.solver().record_bounces(commands, 1, half_one);
      half_two = two.solver().record_bounces(commands, 2, half_two);
    }
    two.solver().record_gather(commands, half_two);
    one.solver().record_gather(commands, half_one);
  });
  EXPECT_TRUE(one.correct(4, half_one));
  EXPECT_TRUE(two.correct(8, half_two));
}

TEST_F(GuestTest, TwoDevicesInOneProcess) {
  auto second = StandaloneDevice::create({.validation = true});
  ASSERT_TRUE(second) << second.error().message;
  {
    const Guest here(device(), device().host(), model_, lighting_, {});
    const Guest there(*second, second->host(), model_, lighting_, {});
    RadiosityHalf half{};
    const auto record = [&half](const Guest& guest) {
      return [&](VkCommandBuffer commands) {
        half = guest.solver().record_bounces(commands, 2, guest.solver().record_start(commands));
        guest.solver().record_gather(commands, half);
      };
    };
    submit(record(here));
    ASSERT_TRUE(second->submit(record(there)));
    EXPECT_TRUE(here.correct(2, half));
    EXPECT_TRUE(there.correct(2, half));
  }
  EXPECT_THAT(second->validation_messages(), testing::IsEmpty());
}

TEST_F(GuestTest, ADroppedCommandBufferFalsifiesNothing) {
  const Guest guest(device(), device().host(), model_, lighting_, {});
  RadiosityHalf half{};
  submit([&](VkCommandBuffer commands) {
    half = guest.solver().record_bounces(commands, 1, guest.solver().record_start(commands));
  });
  record_and_drop([&](VkCommandBuffer commands) {
    guest.solver().record_bounces(commands, 5, half);
    guest.solver().record_residual(commands, half);
  });
  submit([&](VkCommandBuffer commands) {
    half = guest.solver().record_bounces(commands, 1, half);
    guest.solver().record_gather(commands, half);
  });
  EXPECT_TRUE(guest.correct(2, half));
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
    const Guest guest(device(), device().host(), model_, lighting_, options);
    RadiosityHalf half{};
    submit([&](VkCommandBuffer commands) {
      half = guest.solver().record_bounces(commands, 3, guest.solver().record_start(commands));
      guest.solver().record_gather(commands, half);
    });
    solutions.push_back(guest.results(3, half));
    EXPECT_EQ(guest.memory().damaged_bytes(), 0u);
  }
  ASSERT_TRUE(agrees_with_reference(solutions[0], model_, lighting_));
  for (const DeviceSolution& solution : solutions) {
    EXPECT_EQ(solution.solution.radiosity, solutions[0].solution.radiosity);
    EXPECT_EQ(solution.irradiance, solutions[0].irradiance);
  }
}

TEST_F(GuestTest, PartsOfABounceMayGoIntoDifferentSubmissions) {
  const Guest guest(device(), device().host(), model_, lighting_, {RowKernel::row_per_8_lanes, 200});
  RadiosityHalf half{};
  submit([&](VkCommandBuffer commands) { half = guest.solver().record_start(commands); });
  PassCursor cursor;
  PassPart part;
  std::uint64_t cost = 0;
  int submissions = 0;
  for (; !part.complete; ++submissions) {
    submit([&](VkCommandBuffer commands) {
      part = guest.solver().record_bounce_part(commands, half, cursor, 500);
    });
    EXPECT_LE(part.cost, 500u);
    cost += part.cost;
  }
  EXPECT_GT(submissions, 5);
  EXPECT_EQ(cost, guest.solver().bounce_cost());
  half = other_half(half);
  submit([&](VkCommandBuffer commands) { guest.solver().record_gather(commands, half); });
  EXPECT_TRUE(guest.correct(1, half));
}

TEST_F(GuestTest, ObjectsComeFromTheCallbacksOfTheHostAndGoBack) {
  CountingCallbacks callbacks;
  HostDevice host = device().host();
  host.allocation_callbacks = callbacks.get();
  {
    const Guest guest(device(), host, model_, lighting_, {});
    RadiosityHalf half{};
    submit([&](VkCommandBuffer commands) {
      const int before = callbacks.made();
      half = guest.solver().record_bounces(commands, 2, guest.solver().record_start(commands));
      guest.solver().record_gather(commands, half);
      EXPECT_EQ(callbacks.made(), before) << "recording must not allocate";
    });
    EXPECT_TRUE(guest.correct(2, half));
    EXPECT_GT(callbacks.living(), 0);
  }
  EXPECT_EQ(callbacks.living(), 0);
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
  const auto bound = solver->bind([](const BufferRequirement&) -> Result<BufferRange> {
    return fail(ErrorCode::out_of_memory, "none left");
  });
  ASSERT_FALSE(bound);
  EXPECT_EQ(bound.error().message, "none left");
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
              HasSubstr("maxPerStageDescriptorStorageBuffers of at least 15 (it offers 4)"));
}

TEST_F(GuestTest, ShortTexelBuffersAreNotUsedForLongBlocks) {
  // 1024 rows of 256 entries.
  const Model model = furnace_model(1024, 256);
  const Lighting lighting = random_lighting(model, 5);
  HostDevice host = device().host();
  host.get_instance_proc_addr = get_proc_addr_of_short_texel_buffers;
  const auto refused = GpuSolver::create(host, model, {.fetch = MatrixFetch::texels});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("262144 elements, but the device has at most 65536"));

  const Guest guest(device(), host, model, lighting, {});
  RadiosityHalf half{};
  submit([&](VkCommandBuffer commands) {
    half = guest.solver().record_bounces(commands, 2, guest.solver().record_start(commands));
    guest.solver().record_gather(commands, half);
  });
  EXPECT_TRUE(guest.correct(2, half));
}

}  // namespace
}  // namespace relume::test
