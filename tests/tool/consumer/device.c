/* SPDX-License-Identifier: MIT */
#include "device.h"

#include <string.h>

static int find_queue_family(struct renderer* r, VkQueueFlags flags) {
  VkQueueFamilyProperties families[16];
  uint32_t count = 16;
  vkGetPhysicalDeviceQueueFamilyProperties(r->physical_device, &count, families);
  for (uint32_t i = 0; i < count; ++i) {
    r->queue_family = i;
    if ((families[i].queueFlags & flags) == flags) return 1;
  }
  return 0;
}

static int make_device(struct renderer* r, const relume_requirements* requirements) {
  const float priority = 1.0f;
  VkDeviceQueueCreateInfo queue = {0};
  queue.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
  queue.queueFamilyIndex = r->queue_family;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  VkDeviceCreateInfo info = {0};
  info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queue;
  info.enabledExtensionCount = requirements->extension_count;
  info.ppEnabledExtensionNames = requirements->extensions;
  info.pEnabledFeatures = &requirements->features;
  if (vkCreateDevice(r->physical_device, &info, NULL, &r->device) != VK_SUCCESS) return 0;
  vkGetDeviceQueue(r->device, r->queue_family, 0, &r->queue);
  return 1;
}

static int make_commands(struct renderer* r) {
  VkCommandPoolCreateInfo pool = {0};
  pool.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
  pool.queueFamilyIndex = r->queue_family;
  if (vkCreateCommandPool(r->device, &pool, NULL, &r->pool) != VK_SUCCESS) return 0;
  VkCommandBufferAllocateInfo info = {0};
  info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
  info.commandPool = r->pool;
  info.commandBufferCount = 1;
  return vkAllocateCommandBuffers(r->device, &info, &r->commands) == VK_SUCCESS;
}

int open_renderer(struct renderer* r, relume_error* error) {
  memset(r, 0, sizeof *r);
  error->message[0] = '\0';
  VkApplicationInfo application = {0};
  application.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
  application.apiVersion = VK_API_VERSION_1_1;
  VkInstanceCreateInfo instance = {0};
  instance.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
  instance.pApplicationInfo = &application;
  if (vkCreateInstance(&instance, NULL, &r->instance) != VK_SUCCESS) return 0;
  uint32_t count = 1;
  vkEnumeratePhysicalDevices(r->instance, &count, &r->physical_device);
  if (count == 0) return 0;
  relume_requirements requirements;
  if (relume_device_requirements(vkGetInstanceProcAddr, r->instance, r->physical_device, &requirements,
                                 error) != RELUME_OK)
    return 0;
  return find_queue_family(r, requirements.queue_flags) && make_device(r, &requirements) && make_commands(r);
}

void close_renderer(struct renderer* r) {
  if (r->sampler != VK_NULL_HANDLE) vkDestroySampler(r->device, r->sampler, NULL);
  for (uint32_t i = 0; i < r->image_count; ++i) {
    vkDestroyImageView(r->device, r->images[i].view, NULL);
    vkDestroyImage(r->device, r->images[i].image, NULL);
    vkFreeMemory(r->device, r->images[i].memory, NULL);
  }
  for (uint32_t i = 0; i < r->buffer_count; ++i) {
    vkDestroyBuffer(r->device, r->buffers[i].buffer, NULL);
    vkFreeMemory(r->device, r->buffers[i].memory, NULL);
  }
  if (r->pool != VK_NULL_HANDLE) vkDestroyCommandPool(r->device, r->pool, NULL);
  if (r->device != VK_NULL_HANDLE) vkDestroyDevice(r->device, NULL);
  if (r->instance != VK_NULL_HANDLE) vkDestroyInstance(r->instance, NULL);
}

static uint32_t memory_type(const struct renderer* r, uint32_t allowed, VkMemoryPropertyFlags flags) {
  VkPhysicalDeviceMemoryProperties memory;
  vkGetPhysicalDeviceMemoryProperties(r->physical_device, &memory);
  for (uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
    if ((allowed >> i & 1u) != 0 && (memory.memoryTypes[i].propertyFlags & flags) == flags) return i;
  }
  return UINT32_MAX;
}

static struct buffer* make_buffer(struct renderer* r, VkDeviceSize byte_size, VkBufferUsageFlags usage,
                                  VkMemoryPropertyFlags flags) {
  if (r->buffer_count == MAX_BUFFERS) return NULL;
  struct buffer* made = &r->buffers[r->buffer_count++];
  VkBufferCreateInfo info = {0};
  info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
  info.size = byte_size;
  info.usage = usage;
  if (vkCreateBuffer(r->device, &info, NULL, &made->buffer) != VK_SUCCESS) return NULL;
  VkMemoryRequirements needed;
  vkGetBufferMemoryRequirements(r->device, made->buffer, &needed);
  VkMemoryAllocateInfo memory = {0};
  memory.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
  memory.allocationSize = needed.size;
  memory.memoryTypeIndex = memory_type(r, needed.memoryTypeBits, flags);
  if (memory.memoryTypeIndex == UINT32_MAX) return NULL;
  if (vkAllocateMemory(r->device, &memory, NULL, &made->memory) != VK_SUCCESS) return NULL;
  return vkBindBufferMemory(r->device, made->buffer, made->memory, 0) == VK_SUCCESS ? made : NULL;
}

int allocate_buffer(void* user, const relume_buffer_requirement* requirement, relume_buffer_range* range) {
  struct buffer* made =
      make_buffer(user, requirement->byte_size, requirement->usage, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
  if (made == NULL) return 1;
  range->buffer = made->buffer;
  range->offset = 0;
  range->byte_size = requirement->byte_size;
  return 0;
}

int allocate_staging(struct renderer* r, VkDeviceSize byte_size, relume_staging* staging) {
  struct buffer* made =
      make_buffer(r, byte_size, VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                  VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
  if (made == NULL) return 1;
  staging->range.buffer = made->buffer;
  staging->range.offset = 0;
  staging->range.byte_size = byte_size;
  return vkMapMemory(r->device, made->memory, 0, VK_WHOLE_SIZE, 0, &staging->mapped) == VK_SUCCESS ? 0 : 1;
}

VkCommandBuffer begin_commands(struct renderer* r) {
  vkResetCommandPool(r->device, r->pool, 0);
  VkCommandBufferBeginInfo info = {0};
  info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
  info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  vkBeginCommandBuffer(r->commands, &info);
  return r->commands;
}

int submit_commands(struct renderer* r) {
  VkMemoryBarrier barrier = {0};
  barrier.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER;
  barrier.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
  barrier.dstAccessMask = VK_ACCESS_HOST_READ_BIT;
  vkCmdPipelineBarrier(r->commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1,
                       &barrier, 0, NULL, 0, NULL);
  if (vkEndCommandBuffer(r->commands) != VK_SUCCESS) return 1;
  VkSubmitInfo submit = {0};
  submit.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
  submit.commandBufferCount = 1;
  submit.pCommandBuffers = &r->commands;
  if (vkQueueSubmit(r->queue, 1, &submit, VK_NULL_HANDLE) != VK_SUCCESS) return 1;
  return vkQueueWaitIdle(r->queue) == VK_SUCCESS ? 0 : 1;
}

static const VkImageSubresourceRange kWholeImage = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};

static int create_image(struct renderer* r, const relume_lightmap_image* wanted, VkFormat view_format,
                        struct image* made) {
  VkImageCreateInfo info = {0};
  info.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO;
  info.flags = wanted->flags;
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = wanted->format;
  info.extent.width = wanted->extent.width;
  info.extent.height = wanted->extent.height;
  info.extent.depth = 1;
  info.mipLevels = info.arrayLayers = 1;
  info.samples = VK_SAMPLE_COUNT_1_BIT;
  info.usage = wanted->usage | VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
  if (vkCreateImage(r->device, &info, NULL, &made->image) != VK_SUCCESS) return 1;
  VkMemoryRequirements needed;
  vkGetImageMemoryRequirements(r->device, made->image, &needed);
  VkMemoryAllocateInfo memory = {0};
  memory.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
  memory.allocationSize = needed.size;
  memory.memoryTypeIndex = memory_type(r, needed.memoryTypeBits, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
  if (memory.memoryTypeIndex == UINT32_MAX) return 1;
  if (vkAllocateMemory(r->device, &memory, NULL, &made->memory) != VK_SUCCESS) return 1;
  if (vkBindImageMemory(r->device, made->image, made->memory, 0) != VK_SUCCESS) return 1;
  VkImageViewCreateInfo view = {0};
  view.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO;
  view.image = made->image;
  view.viewType = VK_IMAGE_VIEW_TYPE_2D;
  view.format = view_format;
  view.subresourceRange = kWholeImage;
  return vkCreateImageView(r->device, &view, NULL, &made->view) == VK_SUCCESS ? 0 : 1;
}

static int fill_image(struct renderer* r, const struct image* image, float value) {
  const VkClearColorValue color = {{value, value, value, value}};
  VkImageMemoryBarrier barrier = {0};
  barrier.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER;
  barrier.dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
  barrier.newLayout = VK_IMAGE_LAYOUT_GENERAL;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image->image;
  barrier.subresourceRange = kWholeImage;
  VkCommandBuffer commands = begin_commands(r);
  vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0,
                       NULL, 0, NULL, 1, &barrier);
  vkCmdClearColorImage(commands, image->image, VK_IMAGE_LAYOUT_GENERAL, &color, 1, &kWholeImage);
  return submit_commands(r);
}

const struct image* make_image(struct renderer* r, const relume_lightmap_image* wanted, VkFormat view_format,
                               float value) {
  if (r->image_count == MAX_IMAGES) return NULL;
  struct image* made = &r->images[r->image_count++];
  if (create_image(r, wanted, view_format, made) != 0 || fill_image(r, made, value) != 0) return NULL;
  return made;
}

void copy_image(struct renderer* r, const struct image* image, VkExtent2D extent,
                const relume_staging* target) {
  VkMemoryBarrier barrier = {0};
  barrier.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER;
  barrier.srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT;
  barrier.dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT;
  vkCmdPipelineBarrier(r->commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0,
                       1, &barrier, 0, NULL, 0, NULL);
  VkBufferImageCopy copy = {0};
  copy.bufferOffset = target->range.offset;
  copy.imageSubresource.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT;
  copy.imageSubresource.layerCount = 1;
  copy.imageExtent.width = extent.width;
  copy.imageExtent.height = extent.height;
  copy.imageExtent.depth = 1;
  vkCmdCopyImageToBuffer(r->commands, image->image, VK_IMAGE_LAYOUT_GENERAL, target->range.buffer, 1, &copy);
}

VkSampler make_sampler(struct renderer* r) {
  VkSamplerCreateInfo nearest = {0};
  nearest.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO;
  if (vkCreateSampler(r->device, &nearest, NULL, &r->sampler) != VK_SUCCESS) return VK_NULL_HANDLE;
  return r->sampler;
}
