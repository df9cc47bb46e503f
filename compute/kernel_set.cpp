// SPDX-License-Identifier: MIT
#include "compute/kernel_set.h"

#include <string>
#include <utility>

#include "compute/vulkan_error.h"
#include "compute/vulkan_info.h"

namespace relume {
namespace {

SetShape times(const SetShape& shape, std::uint32_t sets) {
  return {shape.storage_buffers * sets, shape.texel_buffers * sets, shape.storage_images * sets,
          shape.sampled_images * sets};
}

std::string counts(std::size_t buffers, std::size_t texels, std::size_t images, std::size_t sampled) {
  return std::to_string(buffers) + " storage buffers, " + std::to_string(texels) + " texel buffers, " +
         std::to_string(images) + " storage images and " + std::to_string(sampled) + " sampled images";
}

}  // namespace

Result<KernelSet> KernelSet::create(const HostDevice& host, const DeviceFunctions& functions,
                                    const KernelSetInfo& info) {
  KernelSet made(host, functions, info.shape);
  auto set_layout = make_set_layout(host, functions, info.shape);
  if (!set_layout) return tl::unexpected<Error>(set_layout.error());
  made.set_layout_ = std::move(*set_layout);
  const VkDescriptorSetLayout set = made.set_layout_.get();
  auto layout = make_pipeline_layout(host, functions, {&set, 1}, info.push_constant_bytes);
  if (!layout) return tl::unexpected<Error>(layout.error());
  made.layout_ = std::move(*layout);
  for (const KernelChoice& choice : info.kernels) {
    auto pipeline =
        make_compute_pipeline(host, functions, made.layout_.get(), choice.kernel, choice.constants);
    if (!pipeline) return tl::unexpected<Error>(pipeline.error());
    made.pipelines_.push_back(std::move(*pipeline));
  }
  auto pool = make_descriptor_pool(host, functions, info.max_sets, times(info.shape, info.max_sets));
  if (!pool) return tl::unexpected<Error>(pool.error());
  made.pool_ = std::move(*pool);
  return made;
}

Result<std::vector<VkBufferView>> KernelSet::make_views(std::span<const TexelRange> texels) {
  std::vector<VkBufferView> views;
  for (const TexelRange& part : texels) {
    auto view = make_texel_view(host_, functions_, part.range, part.format);
    if (!view) return tl::unexpected<Error>(view.error());
    views.push_back(view->get());
    views_.push_back(std::move(*view));
  }
  return views;
}

Result<VkDescriptorSet> KernelSet::allocate_set() {
  const VkDescriptorSetLayout layout = set_layout_.get();
  auto info = vulkan_info<VkDescriptorSetAllocateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO);
  info.descriptorPool = pool_.get();
  info.descriptorSetCount = 1;
  info.pSetLayouts = &layout;
  VkDescriptorSet set = VK_NULL_HANDLE;
  const VkResult result = functions_.allocate_descriptor_sets(host_.device, &info, &set);
  if (result != VK_SUCCESS) {
    return tl::unexpected<Error>(vulkan_error(result, "allocating a descriptor set"));
  }
  return set;
}

Result<VkDescriptorSet> KernelSet::make_set(std::span<const BufferRange> buffers,
                                            std::span<const TexelRange> texels,
                                            std::span<const VkImageView> images,
                                            std::span<const SampledImage> sampled) {
  if (buffers.size() != shape_.storage_buffers || texels.size() != shape_.texel_buffers ||
      images.size() != shape_.storage_images || sampled.size() != shape_.sampled_images) {
    return fail(ErrorCode::usage, "a descriptor set needs " +
                                      counts(shape_.storage_buffers, shape_.texel_buffers,
                                             shape_.storage_images, shape_.sampled_images) +
                                      ", found " +
                                      counts(buffers.size(), texels.size(), images.size(), sampled.size()));
  }
  const auto views = make_views(texels);
  if (!views) return tl::unexpected<Error>(views.error());
  auto set = allocate_set();
  if (!set) return set;
  std::vector<VkDescriptorBufferInfo> buffer_infos;
  for (const BufferRange& range : buffers)
    buffer_infos.push_back({range.buffer, range.offset, range.byte_size});
  std::vector<VkDescriptorImageInfo> image_infos;
  for (VkImageView view : images) image_infos.push_back({VK_NULL_HANDLE, view, VK_IMAGE_LAYOUT_GENERAL});

  std::vector<VkDescriptorImageInfo> sampled_infos;
  for (const SampledImage& image : sampled)
    sampled_infos.push_back({image.sampler, image.view, image.layout});

  std::vector<VkWriteDescriptorSet> writes;
  std::uint32_t binding = 0;
  const auto add = [&](VkDescriptorType type, std::size_t count) -> VkWriteDescriptorSet& {
    auto write = vulkan_info<VkWriteDescriptorSet>(VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET);
    write.dstSet = *set;
    write.dstBinding = binding;
    write.descriptorCount = static_cast<std::uint32_t>(count);
    write.descriptorType = type;
    binding += write.descriptorCount;
    return writes.emplace_back(write);
  };
  if (!buffers.empty())
    add(VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, buffers.size()).pBufferInfo = buffer_infos.data();
  if (!texels.empty())
    add(VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, texels.size()).pTexelBufferView = views->data();
  if (!images.empty()) add(VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, images.size()).pImageInfo = image_infos.data();
  if (!sampled.empty())
    add(VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, sampled.size()).pImageInfo = sampled_infos.data();
  functions_.update_descriptor_sets(host_.device, static_cast<std::uint32_t>(writes.size()), writes.data(), 0,
                                    nullptr);
  return set;
}

void KernelSet::record(VkCommandBuffer commands, std::uint32_t kernel, VkDescriptorSet set,
                       std::span<const std::byte> push_constants, std::uint32_t workgroups_x,
                       std::uint32_t workgroups_y) const {
  functions_.cmd_bind_pipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipelines_[kernel].get());
  functions_.cmd_bind_descriptor_sets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout_.get(), 0, 1, &set, 0,
                                      nullptr);
  if (!push_constants.empty()) {
    functions_.cmd_push_constants(commands, layout_.get(), VK_SHADER_STAGE_COMPUTE_BIT, 0,
                                  static_cast<std::uint32_t>(push_constants.size()), push_constants.data());
  }
  functions_.cmd_dispatch(commands, workgroups_x, workgroups_y, 1);
}

}  // namespace relume
