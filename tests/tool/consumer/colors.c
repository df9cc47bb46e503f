/* SPDX-License-Identifier: MIT */
#include "colors.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define PI 3.14159265358979323846
/* From an element to a parallel unit square, one metre above its middle: four times that of a rectangle over
 * its corner (M. Modest, Radiative Heat Transfer, 2013, appendix D). */
static double form_factor(void) {
  const double a = 0.5 / sqrt(1.25);
  return 4.0 / (2.0 * PI) * 2.0 * a * atan(a);
}

struct stage {
  struct renderer* renderer;
  const relume_model* model;
  relume_solver* solver;
  relume_materials* materials;
  relume_screen* screen;
  uint32_t shown; /* image on the screen */
  relume_light_cache* cache;
  relume_lightmap* lightmap;
  relume_lightmap_image lightmap_info;
  const struct image* lightmap_image;
  relume_staging staging, inputs, irradiance, residuals, texels;
};

static int failed(const char* what, const relume_error* error) {
  fprintf(stderr, "%s: %s\n", what, error->message);
  return 1;
}

static uint32_t material_called(const relume_model* model, const char* name) {
  uint32_t material = 0;
  while (material < relume_model_material_count(model) &&
         strcmp(relume_model_material_name(model, material), name) != 0)
    ++material;
  return material;
}

static int upload(struct stage* s) {
  relume_error error;
  for (int pending = 1; pending != 0;) {
    if (relume_record_upload(s->solver, begin_commands(s->renderer), &s->staging, &pending, &error) !=
        RELUME_OK)
      return failed("upload", &error);
    if (submit_commands(s->renderer) != 0) return 1;
  }
  return 0;
}

static int make_solver(struct stage* s) {
  struct renderer* r = s->renderer;
  relume_error error;
  relume_host host;
  memset(&host, 0, sizeof host);
  host.instance = r->instance;
  host.physical_device = r->physical_device;
  host.device = r->device;
  host.get_instance_proc_addr = vkGetInstanceProcAddr;
  const relume_light_options lamps = {1, 0, 1};
  const relume_solver_options options = {RELUME_ROW_PER_THREAD, RELUME_FETCH_STORAGE, 1000, 0, 1e4, 2};
  if (relume_solver_create(&host, s->model, &options, 1e4, &s->solver, &error) != RELUME_OK ||
      relume_solver_bind(s->solver, allocate_buffer, r, &error) != RELUME_OK ||
      relume_load_system(s->solver, 0, 0.95, allocate_buffer, r, &error) != RELUME_OK ||
      relume_add_lights(s->solver, 0, &lamps, allocate_buffer, r, &error) != RELUME_OK ||
      relume_materials_create(s->solver, 0, 0, 0.95, &s->materials, &error) != RELUME_OK ||
      relume_materials_bind(s->materials, allocate_buffer, r, &error) != RELUME_OK)
    return failed("solver", &error);
  return 0;
}

/* One white texel on the upper square. */
static int make_screen(struct stage* s) {
  struct renderer* r = s->renderer;
  relume_error error;
  const relume_lightmap_image texel = {
      VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_UNDEFINED, {1, 1}, VK_IMAGE_USAGE_SAMPLED_BIT, 0};
  const struct image* image = make_image(r, &texel, texel.format, 1.0f);
  const VkSampler sampler = make_sampler(r);
  const relume_screen_info info = {0, material_called(s->model, "lid"), 64, 64, 0, 0.95, 1};
  if (image == NULL || sampler == VK_NULL_HANDLE) return 1;
  if (relume_screen_create(s->solver, &info, &s->screen, &error) != RELUME_OK ||
      relume_screen_bind(s->screen, allocate_buffer, r, &error) != RELUME_OK ||
      relume_screen_add_image(s->screen, sampler, image->view, VK_IMAGE_LAYOUT_GENERAL, &s->shown, &error) !=
          RELUME_OK)
    return failed("screen", &error);
  /* What cannot be is refused: a second image, and a screen that nothing shows. */
  relume_screen* none;
  uint32_t second;
  const relume_screen_info nowhere = {0, relume_model_material_count(s->model), 64, 64, 0, 0.95, 1};
  return relume_screen_add_image(s->screen, sampler, image->view, VK_IMAGE_LAYOUT_GENERAL, &second, &error) !=
             RELUME_USAGE ||
         relume_screen_create(s->solver, &nowhere, &none, &error) != RELUME_USAGE || none != NULL;
}

static int make_lightmap(struct stage* s) {
  struct renderer* r = s->renderer;
  relume_error error;
  if (relume_lightmap_create(s->solver, 0, RELUME_RGBA16F, &s->lightmap, &s->lightmap_info, &error) !=
      RELUME_OK)
    return failed("lightmap", &error);
  s->lightmap_image = make_image(r, &s->lightmap_info, s->lightmap_info.storage_view_format, 0.0f);
  if (s->lightmap_image == NULL) return 1;
  if (relume_lightmap_bind(s->lightmap, allocate_buffer, r, 0, s->lightmap_image->view, &error) != RELUME_OK)
    return failed("lightmap", &error);
  const VkExtent2D extent = s->lightmap_info.extent;
  return allocate_staging(r, (VkDeviceSize)8 * extent.width * extent.height, &s->texels);
}

static int set_up(struct stage* s) {
  struct renderer* r = s->renderer;
  if (make_solver(s) || make_screen(s) || make_lightmap(s)) return 1;
  const VkDeviceSize rows = relume_model_gather_row_count(s->model, 0);
  return allocate_staging(r, 1 << 20, &s->staging) || allocate_staging(r, 1 << 16, &s->inputs) ||
         allocate_staging(r, 16 * rows, &s->irradiance) ||
         allocate_staging(r, relume_residual_bytes(s->solver), &s->residuals) || upload(s);
}

/* Of a half-precision number that is normal, or 0. */
static double from_half(uint16_t bits) {
  return (bits & 0x7c00) == 0 ? 0.0 : ldexp(1024.0 + (bits & 0x3ff), (bits >> 10 & 31) - 25);
}

/* The brightest texel of the lightmap is the brightest lumel, rounded to 11 bits. */
static int lightmap_is_right(const struct stage* s) {
  const uint16_t* texels = s->texels.mapped;
  const float* rows = s->irradiance.mapped;
  double shown = 0.0, gathered = 0.0;
  for (VkDeviceSize i = 0; i < s->texels.range.byte_size / 8; ++i)
    shown = fmax(shown, from_half(texels[4 * i + 1]));
  for (uint32_t i = 0; i + 1 < relume_model_gather_row_count(s->model, 0); ++i)
    gathered = fmax(gathered, rows[4 * i + 1]);
  return fabs(shown - gathered) <= gathered / 2048.0;
}

/* One frame that starts anew and is within 0.001 lm/m2; irradiance at the sensor, which is the last gather
 * row. */
static int light(struct stage* s, relume_frame* frame, int copy_states, double expected, const char* what) {
  relume_error error;
  /* At most a hundred bounces, restart, residual, gather. */
  const relume_pass_wishes wishes = {0, 100, 1, 1, 1, 1e-3};
  relume_frame_report report;
  const relume_irradiance_target target = {0, s->irradiance.range};
  frame->irradiance = &target;
  frame->irradiance_count = 1;
  frame->residuals = s->residuals.range;
  frame->lightmaps = &s->lightmap;
  frame->lightmap_count = 1;
  frame->staging = s->staging;
  relume_note_change(s->solver, 0, 1e3);
  if (relume_plan_together(s->solver, &wishes, &report, &error) != RELUME_OK) return failed("plan", &error);
  if (report.pass_complete == 0 || report.form_factors == 0 || report.output_error > 1e-3) return 1;
  VkCommandBuffer commands = begin_commands(s->renderer);
  const relume_buffer_range states = relume_materials_states(s->materials);
  const VkBufferCopy copy = {s->inputs.range.offset, states.offset,
                             sizeof(relume_material_state) * relume_model_material_count(s->model)};
  if (copy_states) vkCmdCopyBuffer(commands, s->inputs.range.buffer, states.buffer, 1, &copy);
  if (relume_record_frame(s->solver, commands, frame, &error) != RELUME_OK) return failed("frame", &error);
  copy_image(s->renderer, s->lightmap_image, s->lightmap_info.extent, &s->texels);
  if (submit_commands(s->renderer) != 0) return 1;
  relume_frame_submitted(s->solver);
  const float* sensor = (const float*)s->irradiance.mapped + s->irradiance.range.byte_size / 4 - 4;
  printf("%s: %g lux, expected %g\n", what, sensor[1], expected);
  return fabs(sensor[1] - expected) <= 0.01 * expected && lightmap_is_right(s) ? 0 : 1;
}

/* As stored, with 10 cd/m2; black squares bounce nothing. */
static int light_as_stored(struct stage* s) {
  relume_frame frame;
  memset(&frame, 0, sizeof frame);
  if (light(s, &frame, 0, PI * 10.0 * form_factor(), "stored") != 0) return 1;
  const relume_residual residual = relume_read_residual(s->residuals.mapped, 0);
  return residual.change[0] == 0.0 && fabs(residual.radiosity[0] - PI * 10.0) <= 1e-4 ? 0 : 1;
}

static int light_by_materials(struct stage* s) {
  relume_material_state* states = s->inputs.mapped;
  memset(states, 0, sizeof *states * relume_model_material_count(s->model));
  relume_material_state* lid = &states[material_called(s->model, "lid")];
  relume_frame frame;
  memset(&frame, 0, sizeof frame);
  frame.materials = &s->materials;
  frame.material_count = 1;
  lid->exitance_rule = RELUME_REPLACE_STORED;
  for (int c = 0; c < 3; ++c) lid->exitance[c] = (float)(PI * 100.0);
  if (light(s, &frame, 1, PI * 100.0 * form_factor(), "replaced") != 0) return 1;
  lid->exitance_rule = RELUME_SCALE_STORED;
  for (int c = 0; c < 3; ++c) lid->exitance[c] = 3.0f;
  if (light(s, &frame, 1, 3.0 * PI * 10.0 * form_factor(), "scaled") != 0) return 1;
  lid->exitance_rule = RELUME_KEEP_STORED;
  return light(s, &frame, 1, PI * 10.0 * form_factor(), "kept");
}

static int light_by_screen(struct stage* s) {
  const relume_screen_frame shown = {s->screen, s->shown, {50.0, 50.0, 50.0}};
  relume_frame frame;
  memset(&frame, 0, sizeof frame);
  frame.screens = &shown;
  frame.screen_count = 1;
  return light(s, &frame, 0, PI * 50.0 * form_factor(), "white image");
}

/* A frame in which the lid glows and the sky is white, in cd/m2. */
static int light_by_lid_and_sky(struct stage* s, float lid, float sky) {
  relume_material_state* states = s->inputs.mapped;
  const VkDeviceSize state_bytes = sizeof *states * relume_model_material_count(s->model);
  memset(states, 0, state_bytes);
  relume_material_state* lamp = &states[material_called(s->model, "lid")];
  lamp->exitance_rule = RELUME_REPLACE_STORED;
  for (int c = 0; c < 3; ++c) lamp->exitance[c] = (float)PI * lid;
  const float radiance[3] = {sky, sky, sky};
  relume_error error;
  relume_frame frame;
  memset(&frame, 0, sizeof frame);
  frame.materials = &s->materials;
  frame.material_count = 1;
  const relume_input_copy copy = {RELUME_SKY,
                                  relume_model_system_count(s->model),
                                  0,
                                  {s->inputs.range.buffer, s->inputs.range.offset + state_bytes,
                                   16 * relume_model_sky_patch_count(s->model)}};
  frame.copies = &copy;
  frame.copy_count = 1;
  if (state_bytes + copy.source.byte_size > s->inputs.range.byte_size ||
      relume_model_sky(s->model, radiance, 1, 1, (float*)((char*)s->inputs.mapped + state_bytes), &error) !=
          RELUME_OK)
    return 1;
  return light(s, &frame, 1, PI * (lid * form_factor() + sky * (1.0 - form_factor())), "lid and sky");
}

/* In one frame the lid alone, of 1 cd/m2, in lighting 0, and such a sky alone in lighting 1. */
static int light_lid_and_sky_apart(struct stage* s) {
  const uint32_t sky = relume_model_system_count(s->model);
  const VkDeviceSize patches = 16 * relume_model_sky_patch_count(s->model);
  const VkDeviceSize clusters = 16 * relume_model_cluster_count(s->model, 0);
  const VkDeviceSize black = sizeof(relume_material_state) * relume_model_material_count(s->model);
  const VkDeviceSize white = black + (patches > clusters ? patches : clusters);
  const relume_buffer_range* inputs = &s->inputs.range;
  if (white + patches > inputs->byte_size) return 1;
  memset(s->inputs.mapped, 0, inputs->byte_size);
  relume_material_state* states = s->inputs.mapped;
  relume_material_state* lamp = &states[material_called(s->model, "lid")];
  lamp->exitance_rule = RELUME_REPLACE_STORED;
  for (int c = 0; c < 3; ++c) lamp->exitance[c] = (float)PI;
  const float radiance[3] = {1.0f, 1.0f, 1.0f};
  relume_error error;
  if (relume_model_sky(s->model, radiance, 1, 1, (float*)((char*)s->inputs.mapped + white), &error) !=
      RELUME_OK)
    return failed("sky", &error);
  const relume_input_copy copies[3] = {
      {RELUME_SKY, sky, 0, {inputs->buffer, inputs->offset + black, patches}, 0},
      {RELUME_EXITANCE, 0, 0, {inputs->buffer, inputs->offset + black, clusters}, 1},
      {RELUME_SKY, sky, 0, {inputs->buffer, inputs->offset + white, patches}, 1}};
  relume_frame frame;
  memset(&frame, 0, sizeof frame);
  frame.materials = &s->materials;
  frame.material_count = 1;
  frame.copies = copies;
  frame.copy_count = 3;
  return light(s, &frame, 1, PI * form_factor(), "lid apart from sky");
}

static int make_cache(struct stage* s, uint32_t lights) {
  relume_error error;
  if (relume_light_cache_create(s->solver, 0, lights, &s->cache, &error) != RELUME_OK)
    return failed("cache", &error);
  /* Nothing can be kept yet. */
  if (relume_light_cache_keep(s->cache, s->renderer->commands, 0, &error) != RELUME_USAGE) return 1;
  if (relume_light_cache_bind(s->cache, allocate_buffer, s->renderer, &error) != RELUME_OK)
    return failed("cache", &error);
  return relume_light_cache_keep(s->cache, s->renderer->commands, lights, &error) != RELUME_USAGE;
}

/* Of the lid in lighting 0, and of the sky in lighting 1; there is no other. */
static int keep_both(struct stage* s) {
  relume_error error;
  VkCommandBuffer commands = begin_commands(s->renderer);
  if (relume_light_cache_keep(s->cache, commands, 0, &error) != RELUME_OK ||
      relume_light_cache_keep_of(s->cache, commands, 1, 1, &error) != RELUME_OK)
    return failed("keep", &error);
  return submit_commands(s->renderer) != 0 ||
         relume_light_cache_keep_of(s->cache, commands, 1, 2, &error) != RELUME_USAGE ||
         relume_irradiance_of(s->solver, 0, 2).buffer != VK_NULL_HANDLE;
}

/* The lid and the sky each alone, then both as a sum without a product, in the lightmap too. */
static int light_by_cache(struct stage* s) {
  if (make_cache(s, 2) || light_lid_and_sky_apart(s) || keep_both(s)) return 1;
  relume_error error;
  const float colors[6] = {50.0f, 50.0f, 50.0f, 20.0f, 20.0f, 20.0f};
  VkCommandBuffer commands = begin_commands(s->renderer);
  if (relume_light_cache_combine(s->cache, commands, colors, 2, &error) != RELUME_OK ||
      relume_lightmap_record(s->lightmap, commands, &error) != RELUME_OK)
    return failed("combine", &error);
  const relume_buffer_range sum = relume_irradiance(s->solver, 0);
  const VkBufferCopy copy = {sum.offset, s->irradiance.range.offset, s->irradiance.range.byte_size};
  vkCmdCopyBuffer(commands, sum.buffer, s->irradiance.range.buffer, 1, &copy);
  copy_image(s->renderer, s->lightmap_image, s->lightmap_info.extent, &s->texels);
  if (submit_commands(s->renderer) != 0) return 1;
  const double expected = PI * (50.0 * form_factor() + 20.0 * (1.0 - form_factor()));
  const float* sensor = (const float*)s->irradiance.mapped + s->irradiance.range.byte_size / 4 - 4;
  printf("from the cache: %g lux, expected %g\n", sensor[1], expected);
  return fabs(sensor[1] - expected) <= 0.01 * expected && lightmap_is_right(s) ? 0 : 1;
}

/* A sky of 20 cd/m2 comes in beside the lid, which the screen left at 50; then one of 30, as six faces. */
static int light_by_sky(struct stage* s) {
  const float radiance[3] = {20.0f, 20.0f, 20.0f};
  float faces[18];
  for (int i = 0; i < 18; ++i) faces[i] = 30.0f;
  relume_error error;
  relume_frame frame;
  memset(&frame, 0, sizeof frame);
  const relume_input_copy copy = {
      RELUME_SKY,
      relume_model_system_count(s->model),
      0,
      {s->inputs.range.buffer, s->inputs.range.offset, 16 * relume_model_sky_patch_count(s->model)}};
  frame.copies = &copy;
  frame.copy_count = 1;
  const double lid = 50.0 * form_factor(), beside = 1.0 - form_factor();
  if (copy.source.byte_size > s->inputs.range.byte_size ||
      relume_model_sky(s->model, radiance, 1, 1, s->inputs.mapped, &error) != RELUME_OK ||
      light(s, &frame, 0, PI * (lid + 20.0 * beside), "sky") ||
      relume_model_sky_faces(s->model, faces, 1, s->inputs.mapped, &error) != RELUME_OK)
    return 1;
  return light(s, &frame, 0, PI * (lid + 30.0 * beside), "sky of six faces");
}

/* A lamp between the squares, as much of it as a mask says: what the floor reflects of it and the lid gets.
 */
static int light_behind_mask(struct stage* s, float share, double* sum) {
  relume_error error;
  const relume_light lamp = {RELUME_POINT, {9.0, 9.0, 9.0}, {0.4, 0.5, 0.4}, {0.0, -1.0, 0.0}, 0.0, 0.0, 0.0};
  const relume_buffer_range mask = relume_light_mask(s->solver, 0);
  const uint32_t clusters = relume_model_cluster_count(s->model, 0);
  float* shares = s->inputs.mapped;
  for (uint32_t c = 0; c < clusters; ++c) shares[c] = share;
  const VkBufferCopy copy = {s->inputs.range.offset, mask.offset, 4 * clusters};
  vkCmdCopyBuffer(begin_commands(s->renderer), s->inputs.range.buffer, mask.buffer, 1, &copy);
  if (submit_commands(s->renderer) != 0) return 1;
  relume_retrace_lights(s->solver, 0);
  if (relume_set_lights(s->solver, &lamp, 1, &error) != RELUME_OK) return failed("lamp", &error);
  relume_material_state* states = s->inputs.mapped;
  memset(states, 0, sizeof *states * relume_model_material_count(s->model));
  for (uint32_t m = 0; m < relume_model_material_count(s->model); ++m)
    states[m].albedo_rule = states[m].exitance_rule = RELUME_REPLACE_STORED;
  relume_material_state* floor = &states[material_called(s->model, "floor")];
  for (int c = 0; c < 3; ++c) floor->albedo[c] = 0.5f;
  relume_frame frame;
  memset(&frame, 0, sizeof frame);
  frame.materials = &s->materials;
  frame.material_count = 1;
  if (light(s, &frame, 1, 0.0, "lamp") != 0) return 1;
  *sum = 0.0;
  const float* rows = s->irradiance.mapped;
  for (uint32_t i = 0; i < relume_model_gather_row_count(s->model, 0); ++i) *sum += rows[4 * i];
  return 0;
}

static int light_by_mask(struct stage* s) {
  relume_error error;
  double none, quarter, whole;
  if (light_behind_mask(s, 0.0f, &none) || light_behind_mask(s, 0.25f, &quarter) ||
      light_behind_mask(s, 1.0f, &whole) || relume_set_lights(s->solver, NULL, 0, &error) != RELUME_OK)
    return 1;
  printf("lid behind masks: %g, %g, %g\n", none, quarter, whole);
  return none == 0.0 && whole > 0.0 && fabs(quarter - 0.25 * whole) <= 1e-4 * whole ? 0 : 1;
}

static int refuses_what_is_not_there(struct stage* s) {
  relume_error error;
  const relume_frame_wishes wishes = {0, 1, 0.0};
  const relume_screen_frame shown = {s->screen, s->shown + 1, {1.0, 1.0, 1.0}};
  relume_frame frame;
  memset(&frame, 0, sizeof frame);
  frame.screens = &shown;
  frame.screen_count = 1;
  int wrong = relume_plan_frame(s->solver, &wishes, NULL, &error) != RELUME_OK ||
              relume_record_frame(s->solver, begin_commands(s->renderer), &frame, &error) != RELUME_USAGE;
  vkEndCommandBuffer(s->renderer->commands);
  frame.screen_count = 0;
  relume_device_lost(s->solver);
  wrong = wrong ||
          relume_record_frame(s->solver, begin_commands(s->renderer), &frame, &error) != RELUME_NO_DEVICE;
  vkEndCommandBuffer(s->renderer->commands);
  return wrong;
}

int check_colors(struct renderer* r, const relume_model* model) {
  struct stage s;
  memset(&s, 0, sizeof s);
  s.renderer = r;
  s.model = model;
  const int status = set_up(&s) || light_as_stored(&s) || light_by_mask(&s) || light_by_materials(&s) ||
                     light_by_cache(&s) || light_by_lid_and_sky(&s, 10.0f, 0.0f) || light_by_screen(&s) ||
                     light_by_sky(&s) || refuses_what_is_not_there(&s);
  relume_light_cache_destroy(s.cache);
  relume_lightmap_destroy(s.lightmap);
  relume_screen_destroy(s.screen);
  relume_materials_destroy(s.materials);
  relume_solver_destroy(s.solver);
  return status;
}
