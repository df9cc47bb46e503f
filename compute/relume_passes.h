/* SPDX-License-Identifier: MIT
 *
 * What goes into frames and comes out of them, for C99: several lightings at once, and the functions of
 * compute/lightmap_pass.h, light_cache.h, material_pass.h and screen_pass.h, whose headers say more. Each
 * pass is of one system of a relume_solver and is recorded in the frames that name it, a light cache behind
 * or instead of them. Materials and screens write albedo and exitance of clusters:
 *
 *   relume_materials_create, _bind        memory through the host's relume_allocate
 *   relume_record_upload                  until nothing is pending: all is as stored
 *   when a colour changes:
 *     write relume_material_state         into relume_materials_states
 *     relume_note_change, then a frame with the materials in it
 *
 * Errors, handles and threads as in compute/relume.h. What is _destroyed must not be in use by a command
 * buffer that runs, and goes before its system is unloaded. */
#ifndef RELUME_PASSES_H
#define RELUME_PASSES_H

#include "compute/relume.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Several lightings -------------------------------------------------------------------------------- */

/* A solver of several lightings (relume_solver_options) takes all of them forward in each frame and reads its
 * matrices once for all: responses of several lights for a relume_light_cache, times of the day, before and
 * after an edit. Each has RELUME_EXITANCE, RELUME_DIRECT and RELUME_SKY and all results of its own; albedo
 * and weights are of all. Bounds of plans hold for the worst, relume_note_change takes the largest change of
 * any, and a form factor counts once for each.
 *
 * Lightings are numbers from 0. What does not name one means number 0, where relume_add_lights and the passes
 * below write and read too: a relume_input_copy whose source is relume_input takes what they wrote in the
 * frame before to another. Null buffers for a lighting that is not there. */
relume_buffer_range relume_input_of(const relume_solver* solver, uint32_t system, relume_quantity quantity,
                                    uint32_t lighting);
relume_buffer_range relume_radiosity_of(const relume_solver* solver, uint32_t system, uint32_t lighting);
relume_buffer_range relume_irradiance_of(const relume_solver* solver, uint32_t system, uint32_t lighting);
relume_buffer_range relume_directional_irradiance_of(const relume_solver* solver, uint32_t system,
                                                     uint32_t lighting);
relume_buffer_range relume_probe_coefficients_of(const relume_solver* solver, uint32_t lighting);

/* ---- Lightmaps ---------------------------------------------------------------------------------------- */

typedef struct relume_lightmap relume_lightmap;

typedef enum relume_lightmap_format {
  RELUME_RGBA16F = 0,
  RELUME_R11G11B10F = 1,
  RELUME_RGB9E5 = 2,
  RELUME_DIRECTION_RGBA16F = 3 /* where most indirect light comes from, of files made with --directional */
} relume_lightmap_format;

/* What the host's image is made with, at least: 2D, optimal tiling, one layer, one sample. */
typedef struct relume_lightmap_image {
  VkFormat format;
  VkFormat storage_view_format; /* of the view that relume_lightmap_bind gets */
  VkExtent2D extent;
  VkImageUsageFlags usage;
  VkImageCreateFlags flags;
} relume_lightmap_image;

/* Of a loaded system. To be destroyed before the solver, when no command buffer uses it. */
relume_status relume_lightmap_create(relume_solver* solver, uint32_t system, relume_lightmap_format format,
                                     relume_lightmap** lightmap, relume_lightmap_image* image,
                                     relume_error* error);
void relume_lightmap_destroy(relume_lightmap* lightmap);

/* Once, followed by relume_record_upload. `add_direct` not 0: with the light of relume_add_lights. */
relume_status relume_lightmap_bind(relume_lightmap* lightmap, relume_allocate allocate, void* user,
                                   int add_direct, VkImageView storage_view, relume_error* error);

/* Between frames: from the irradiance as it is now. Begins and ends with COMPUTE_SHADER work; the image is in
 * layout GENERAL. Fails with RELUME_USAGE before it is bound and uploaded. */
relume_status relume_lightmap_record(const relume_lightmap* lightmap, VkCommandBuffer commands,
                                     relume_error* error);

/* ---- Light cache -------------------------------------------------------------------------------------- */

/* For lights that change their colour or intensity and nothing else: irradiance is the sum of what each gives
 * alone, times its colour. A light is whatever is switched together: a lamp, surfaces that glow, the sky.
 *
 *   relume_light_cache_create, _bind
 *   for each light: frames in which it alone shines, white and with an intensity of 1, until output_error is
 *                   small enough (relume_pass_wishes.tolerance); relume_light_cache_keep behind the last
 *   each frame:     relume_light_cache_combine, relume_lightmap_record; no product
 *
 * Other albedos or places need new responses. */
typedef struct relume_light_cache relume_light_cache;

/* Of a loaded system, for 1 to 4096 lights. */
relume_status relume_light_cache_create(relume_solver* solver, uint32_t system, uint32_t lights,
                                        relume_light_cache** cache, relume_error* error);
void relume_light_cache_destroy(relume_light_cache* cache);

/* Once; nothing is uploaded. */
relume_status relume_light_cache_bind(relume_light_cache* cache, relume_allocate allocate, void* user,
                                      relume_error* error);

/* Records that the irradiance as it is now becomes the response to light number `light`. */
relume_status relume_light_cache_keep(const relume_light_cache* cache, VkCommandBuffer commands,
                                      uint32_t light, relume_error* error);

/* The same of another lighting of a solver of several, which does so many lights at a time. */
relume_status relume_light_cache_keep_of(const relume_light_cache* cache, VkCommandBuffer commands,
                                         uint32_t light, uint32_t lighting, relume_error* error);

/* Records the irradiance of lights of these colours times intensities, three floats each, from the first on;
 * all of them have been kept, the others are off. All three begin and end with COMPUTE_SHADER and TRANSFER
 * work.
 */
relume_status relume_light_cache_combine(const relume_light_cache* cache, VkCommandBuffer commands,
                                         const float* colors, uint32_t count, relume_error* error);

/* ---- Materials ---------------------------------------------------------------------------------------- */

typedef struct relume_materials relume_materials;

/* What becomes of a stored colour, as the number in a relume_material_state. */
typedef enum relume_color_rule {
  RELUME_KEEP_STORED = 0,    /* the colour means nothing */
  RELUME_REPLACE_STORED = 1, /* the colour is the value */
  RELUME_SCALE_STORED = 2    /* the colour multiplies it: what textures made of it stays */
} relume_color_rule;

/* An element of the states, 32 bytes. NaN and what is below 0 become 0. */
typedef struct relume_material_state {
  float albedo[3];
  float albedo_rule;
  float exitance[3]; /* lm/m2: pi x radiance */
  float exitance_rule;
} relume_material_state;

/* Of a loaded system. `per_cluster` 0: a state per material, numbered as those of the model; else one per
 * cluster of the system. Albedo above `max_albedo` (at most 0.9999) is lowered to it: no more than was said
 * to relume_load_system. */
relume_status relume_materials_create(relume_solver* solver, uint32_t system, int per_cluster,
                                      double max_albedo, relume_materials** materials, relume_error* error);
void relume_materials_destroy(relume_materials* materials);

/* Once, followed by relume_record_upload. */
relume_status relume_materials_bind(relume_materials* materials, relume_allocate allocate, void* user,
                                    relume_error* error);

/* Where the states are: the host writes them by its own copies (usage TRANSFER_DST) or kernels, in front of
 * relume_record_frame without a barrier; a null buffer before relume_materials_bind. */
relume_buffer_range relume_materials_states(const relume_materials* materials);

/* ---- Screens ------------------------------------------------------------------------------------------ */

/* A material that shows an image: it sets the exitance, or the albedo, of the clusters that show it. */
typedef struct relume_screen relume_screen;

typedef struct relume_screen_info {
  uint32_t system;
  uint32_t material;
  uint32_t width, height; /* of its images, about */
  int sets_albedo;        /* 0: exitance */
  double max_albedo;      /* at most 0.9999 */
  uint32_t max_images;    /* that are ever added */
} relume_screen_info;

/* Fails with RELUME_USAGE when no cluster of the system shows an image: the material is not in it, or has no
 * texture coordinates. */
relume_status relume_screen_create(relume_solver* solver, const relume_screen_info* info,
                                   relume_screen** screen, relume_error* error);
void relume_screen_destroy(relume_screen* screen);

/* Once, followed by relume_record_upload. */
relume_status relume_screen_bind(relume_screen* screen, relume_allocate allocate, void* user,
                                 relume_error* error);

/* After relume_screen_bind. Level 0 of the view is sampled, in `layout`, as the sampler says; sRGB codes need
 * an sRGB format. Gives the number of the image in frames. */
relume_status relume_screen_add_image(relume_screen* screen, VkSampler sampler, VkImageView view,
                                      VkImageLayout layout, uint32_t* image, relume_error* error);

typedef struct relume_screen_frame {
  const relume_screen* screen;
  uint32_t image;
  double factor[3]; /* what a texel of 1 is worth; cd/m2 for exitance */
} relume_screen_frame;

#ifdef __cplusplus
}
#endif

#endif
