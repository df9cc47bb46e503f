/* SPDX-License-Identifier: MIT
 *
 * What a renderer in C has anyway: an instance, a device with one queue, and memory that the processor sees.
 */
#ifndef CONSUMER_DEVICE_H
#define CONSUMER_DEVICE_H

#include <compute/relume_passes.h>
#include <vulkan/vulkan.h>

#define MAX_BUFFERS 512
#define MAX_IMAGES 8

struct buffer {
  VkBuffer buffer;
  VkDeviceMemory memory;
};

struct image {
  VkImage image;
  VkDeviceMemory memory;
  VkImageView view;
};

struct renderer {
  VkInstance instance;
  VkPhysicalDevice physical_device;
  VkDevice device;
  VkQueue queue;
  uint32_t queue_family;
  VkCommandPool pool;
  VkCommandBuffer commands;
  struct buffer buffers[MAX_BUFFERS];
  uint32_t buffer_count;
  struct image images[MAX_IMAGES];
  uint32_t image_count;
  VkSampler sampler;
};

/* 0: there is no Vulkan device here. `*error` says why not where Relume refuses it. */
int open_renderer(struct renderer* renderer, relume_error* error);
void close_renderer(struct renderer* renderer);

/* A relume_allocate whose user is a renderer. */
int allocate_buffer(void* user, const relume_buffer_requirement* requirement, relume_buffer_range* range);

/* Staging memory, or memory to read results from. */
int allocate_staging(struct renderer* renderer, VkDeviceSize byte_size, relume_staging* staging);

/* An image in layout GENERAL, each texel `value`, with a view of `view_format`; null when that fails. It
 * lives as long as the renderer. TRANSFER usages are added. */
const struct image* make_image(struct renderer* renderer, const relume_lightmap_image* wanted,
                               VkFormat view_format, float value);

/* Copies the whole image behind what was recorded. Texels must be 8 bytes. */
void copy_image(struct renderer* renderer, const struct image* image, VkExtent2D extent,
                const relume_staging* target);

/* Nearest; null when that fails. */
VkSampler make_sampler(struct renderer* renderer);

VkCommandBuffer begin_commands(struct renderer* renderer);
/* Submits and waits; not 0 when that fails. */
int submit_commands(struct renderer* renderer);

#endif
