/* SPDX-License-Identifier: MIT
 *
 * Relume for C99 and for languages that call C: the functions of compute/gpu_solver.h, schedule.h,
 * direct_light.h and cost_model.h, whose headers say what begins and ends with which stage and access, what
 * is left bound, and who may call what from which thread. Here one solver holds a model's systems, its
 * schedule and its lights. Lightmaps, live materials and screens are in compute/relume_passes.h.
 *
 *   relume_model_read                     a .relume file
 *   relume_device_requirements            before the host makes its device
 *   relume_solver_create, _bind           memory through the host's relume_allocate
 *   relume_load_system, relume_add_lights for each system, at any time
 *   relume_record_upload                  until nothing is pending: a system takes part from then on
 *   each frame:
 *     relume_set_lights, relume_note_change
 *     relume_plan_frame, relume_record_frame, submit, relume_frame_submitted
 *
 * Nothing here submits, waits or reads back, and only the host's relume_allocate makes memory of a device.
 *
 * Errors: what can fail returns a relume_status and, if `error` is not null, writes the sentence that says
 * what failed, where, what was expected and what was found. Nothing is thrown. A handle that was asked for is
 * null after a failure; functions named _destroy take null.
 *
 * A solver and all that was made of it is used by one thread at a time. */
#ifndef RELUME_H
#define RELUME_H

#include <stddef.h>
#include <stdint.h>
#include <vulkan/vulkan_core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Errors ------------------------------------------------------------------------------------------- */

typedef enum relume_status {
  RELUME_OK = 0,
  RELUME_CHECK_FAILED = 1, /* well-formed data that breaks a promise */
  RELUME_USAGE = 2,        /* an argument that makes no sense */
  RELUME_BAD_INPUT = 3,    /* unreadable, malformed or stale file */
  RELUME_NO_DEVICE = 4,    /* the device lacks something, or was lost */
  RELUME_OUT_OF_MEMORY = 5
} relume_status;

typedef struct relume_error {
  relume_status status;
  char message[500]; /* UTF-8, ends with 0; longer ones are cut */
} relume_error;

/* ---- Model -------------------------------------------------------------------------------------------- */

typedef struct relume_model relume_model;

relume_status relume_model_read(const char* file, relume_model** model, relume_error* error);
/* These systems alone; the others keep their numbers, cannot be loaded and are black. */
relume_status relume_model_read_systems(const char* file, const char* const* names, uint32_t count,
                                        relume_model** model, relume_error* error);
void relume_model_destroy(relume_model* model);

uint32_t relume_model_system_count(const relume_model* model);
/* As long as the model. A system is a number below relume_model_system_count. */
const char* relume_model_system_name(const relume_model* model, uint32_t system);
uint32_t relume_model_cluster_count(const relume_model* model, uint32_t system);
/* Lumels, then sensors. */
uint32_t relume_model_gather_row_count(const relume_model* model, uint32_t system);
/* Light probes of all systems. */
uint32_t relume_model_probe_count(const relume_model* model);
uint32_t relume_model_sky_patch_count(const relume_model* model);
/* What RELUME_SKY wants, four floats per patch: pi x the mean of an equirectangular image over each patch.
 * Three floats a pixel, cd/m2; row 0 is +Y, the centre column -Z, +X to the right of it; neither side is 0.
 * An image of 1 x 1 is the same radiance from everywhere. */
relume_status relume_model_sky(const relume_model* model, const float* image, uint32_t width, uint32_t height,
                               float* patches, relume_error* error);
/* The same of a cube map: six faces of `size` x `size` pixels, +X, -X, +Y, -Y, +Z, -Z, each as Vulkan holds
 * it. */
relume_status relume_model_sky_faces(const relume_model* model, const float* faces, uint32_t size,
                                     float* patches, relume_error* error);
uint32_t relume_model_material_count(const relume_model* model);
/* As long as the model. A material is a number below relume_model_material_count. */
const char* relume_model_material_name(const relume_model* model, uint32_t material);

/* ---- The host's device -------------------------------------------------------------------------------- */

typedef struct relume_requirements {
  uint32_t api_version; /* at least */
  VkPhysicalDeviceFeatures features;
  VkQueueFlags queue_flags; /* of the queue that the command buffers go to */
  uint32_t extension_count;
  const char* extensions[16]; /* of the device; the names live as long as the program */
} relume_requirements;

/* To be asked before the device is created; fails with a sentence that says what the device lacks. */
relume_status relume_device_requirements(PFN_vkGetInstanceProcAddr get_instance_proc_addr,
                                         VkInstance instance, VkPhysicalDevice physical_device,
                                         relume_requirements* requirements, relume_error* error);

/* Borrowed: all of it must outlive what is made from it. */
typedef struct relume_host {
  VkInstance instance;
  VkPhysicalDevice physical_device;
  VkDevice device;
  PFN_vkGetInstanceProcAddr get_instance_proc_addr;
  VkPipelineCache pipeline_cache;                    /* may be null */
  const VkAllocationCallbacks* allocation_callbacks; /* may be null */
} relume_host;

typedef struct relume_buffer_requirement {
  const char* name; /* only during the call */
  VkDeviceSize byte_size;
  VkDeviceSize alignment; /* of the offset of the range */
  VkBufferUsageFlags usage;
} relume_buffer_requirement;

typedef struct relume_buffer_range {
  VkBuffer buffer;
  VkDeviceSize offset;
  VkDeviceSize byte_size;
} relume_buffer_range;

/* Gives device-local memory for one buffer; not 0 when there is none. The host frees it after the solver, or
 * the system that it is for, is gone. */
typedef int (*relume_allocate)(void* user, const relume_buffer_requirement* requirement,
                               relume_buffer_range* range);

/* Memory of the host that the processor writes and the device reads (usage TRANSFER_SRC). It belongs to the
 * command buffer until that has run. Not coherent: the host flushes it before it submits. */
typedef struct relume_staging {
  relume_buffer_range range;
  void* mapped; /* address of the range */
} relume_staging;

/* ---- Solver ------------------------------------------------------------------------------------------- */

typedef struct relume_solver relume_solver;

/* How the rows of a matrix are spread over invocations: a choice of speed, all give the same bits. */
typedef enum relume_row_kernel {
  RELUME_KERNEL_DEFAULT = 0,
  RELUME_ROW_PER_THREAD = 1,
  RELUME_ROW_PER_8_LANES = 2,
  RELUME_TILE_SHARED = 3,
  RELUME_TILE_SHUFFLE = 4 /* by subgroups; refused by a device that cannot */
} relume_row_kernel;

typedef enum relume_fetch {
  RELUME_FETCH_DEFAULT = 0, /* texels, where they fit */
  RELUME_FETCH_STORAGE = 1,
  RELUME_FETCH_TEXELS = 2
} relume_fetch;

typedef struct relume_solver_options {
  relume_row_kernel kernel;
  relume_fetch fetch;
  uint64_t max_dispatch_form_factors; /* 0: 4 million */
  uint32_t sender_capacity;           /* see SolverOptions; 0: room for all loaded systems of the model */
  double half_senders_up_to;          /* lm/m2; see SolverOptions; 0: single precision */
  uint32_t lightings;                 /* at once, at most 4; 0: one. See compute/relume_passes.h */
} relume_solver_options;

/* `options` may be null. `largest_radiosity`: no surface or sky patch will have more, in lm/m2, whatever the
 * lights do. The model must outlive the solver. Fails when the device does not meet
 * relume_device_requirements. */
relume_status relume_solver_create(const relume_host* host, const relume_model* model,
                                   const relume_solver_options* options, double largest_radiosity,
                                   relume_solver** solver, relume_error* error);
/* No command buffer of it may be running. */
void relume_solver_destroy(relume_solver* solver);

/* Once, before all else. */
relume_status relume_solver_bind(relume_solver* solver, relume_allocate allocate, void* user,
                                 relume_error* error);

/* For systems that come and go: from now on relume_load_system, and what is made for systems, reads `model`,
 * which is of the same file (relume_model_read_systems) and lives as long as what is loaded of it. */
void relume_use_model(relume_solver* solver, const relume_model* model);

/* `max_albedo`: no cluster will have more, below 1; 0: none will have more than is stored. Fails with
 * RELUME_USAGE when the system is loaded. Frames in flight do not matter. */
relume_status relume_load_system(relume_solver* solver, uint32_t system, double max_albedo,
                                 relume_allocate allocate, void* user, relume_error* error);

typedef struct relume_light_options {
  uint32_t max_lights; /* 0: 16384 */
  uint32_t max_pairs;  /* of a light and a block of surfaces: see DirectLightOptions. 0: for 64 far lights */
  int by_mask;         /* not 0: nothing is traced, the host writes relume_light_mask */
  double patches_per_element; /* about so many shadow rays a light and lumel, at most 16; 0: 16 */
} relume_light_options;

/* Direct light with shadows for a loaded system, traced on the device. Without it the host writes
 * RELUME_DIRECT itself. `options` may be null. The first call asks for "occluder tree", "occluder triangles"
 * and "occluder opacity" too, which all systems share: they live as long as the solver. */
relume_status relume_add_lights(relume_solver* solver, uint32_t system, const relume_light_options* options,
                                relume_allocate allocate, void* user, relume_error* error);

/* Of a system with by_mask: the share of the light that arrives, a float per light and cluster, clusters of
 * one light side by side. After it was written: relume_retrace_lights, before the next plan. */
relume_buffer_range relume_light_mask(const relume_solver* solver, uint32_t system);
void relume_retrace_lights(relume_solver* solver, uint32_t system);

/* For a host that learns of a lost device first: from now on all that can fails with RELUME_NO_DEVICE. */
void relume_device_lost(relume_solver* solver);

/* From the next plan on the system is black to others. */
void relume_deactivate_system(relume_solver* solver, uint32_t system);
/* The fences of all frames that were planned before relume_deactivate_system must have signalled. Its lights
 * go with it; its lightmaps, materials and screens must be gone. */
void relume_unload_system(relume_solver* solver, uint32_t system);

/* Copies of what was bound and loaded last, as much as the staging memory holds. `pending` becomes 0 when
 * nothing is left. The command buffer must be submitted, before those of later frames. */
relume_status relume_record_upload(relume_solver* solver, VkCommandBuffer commands,
                                   const relume_staging* staging, int* pending, relume_error* error);

/* ---- What changes ------------------------------------------------------------------------------------- */

typedef enum relume_light_type {
  RELUME_POINT = 0,
  RELUME_SPOT = 1,
  RELUME_DIRECTIONAL = 2
} relume_light_type;

/* As KHR_lights_punctual, in world space. */
typedef struct relume_light {
  relume_light_type type;
  double intensity[3];                       /* cd (point, spot), lux (directional); linear Rec.709 */
  double position[3];                        /* m */
  double direction[3];                       /* unit, where it shines */
  double range;                              /* m, 0: no limit */
  double inner_cone_angle, outer_cone_angle; /* radians */
} relume_light;

/* The lights from the next plan on, for all systems that have relume_add_lights; only what a change reaches
 * is traced again. A light is known by its place in the list. */
relume_status relume_set_lights(relume_solver* solver, const relume_light* lights, uint32_t count,
                                relume_error* error);

/* Four floats per element, the last is ignored. */
typedef enum relume_quantity {
  RELUME_ALBEDO = 0,   /* per cluster of a system */
  RELUME_EXITANCE = 1, /* per cluster, lm/m2 */
  RELUME_DIRECT = 2,   /* H per cluster, lm/m2 */
  RELUME_WEIGHTS = 3,  /* per cluster, above 0; only relume_residual reads it */
  RELUME_SKY = 4       /* per sky patch, pi x radiance; its system is relume_model_system_count */
} relume_quantity;

/* M + rho H of clusters of the system (or the sky) changed, or will in the next frame, by at most so much,
 * lm/m2. To be said before the plan of that frame. Changes of the lights are known. */
void relume_note_change(relume_solver* solver, uint32_t system, double change);

typedef struct relume_input_copy {
  relume_quantity quantity;
  uint32_t system;
  uint32_t first;             /* cluster or patch */
  relume_buffer_range source; /* 16 bytes an element; usage TRANSFER_SRC */
  uint32_t lighting;          /* see compute/relume_passes.h */
} relume_input_copy;

/* Where inputs and results are, for kernels of the host; a null buffer for what is not there. Radiosity is in
 * the half that counts after the last submitted frame. */
relume_buffer_range relume_input(const relume_solver* solver, uint32_t system, relume_quantity quantity);
relume_buffer_range relume_radiosity(const relume_solver* solver, uint32_t system);
relume_buffer_range relume_irradiance(const relume_solver* solver, uint32_t system);
/* Three times four floats per gather row: first moments of its irradiance along x, y and z (lm/m2, the last
 * of four is 0), without the light of punctual lights; null unless the file was precomputed with
 * --directional. */
relume_buffer_range relume_directional_irradiance(const relume_solver* solver, uint32_t system);
/* Nine times four floats per light probe: coefficients of incident radiance (cd/m2 sr^1/2, the
 * last of four is 0), Y00; y, z, x; xy, yz, 3z2 - 1, xz, x2 - y2, without the light of punctual lights. */
relume_buffer_range relume_probe_coefficients(const relume_solver* solver);
/* Direct irradiance per gather row of a system with lights. */
relume_buffer_range relume_direct_irradiance(const relume_solver* solver, uint32_t system);

/* ---- Frames ------------------------------------------------------------------------------------------- */

typedef struct relume_frame_wishes {
  uint64_t max_form_factors; /* 0: no limit */
  uint32_t bounces;          /* per pass */
  double display_step;       /* lm/m2; what cannot move an output by more is left out. 0: nothing is */
} relume_frame_wishes;

/* What the planned frame will come to. Bounds in lm/m2, for the direct light that is traced by then. */
typedef struct relume_frame_report {
  uint64_t form_factors;
  double radiosity_error; /* after this frame, of any system */
  double output_error;    /* of what is published after this frame */
  double skipped;         /* of it, at most, for what is left out below the display step */
  int pass_complete;
} relume_frame_report;

/* Plans the next frame. `report` may be null. A plan that is not followed by relume_frame_submitted before
 * the next one counts as dropped: what it did is done again. */
relume_status relume_plan_frame(relume_solver* solver, const relume_frame_wishes* wishes,
                                relume_frame_report* report, relume_error* error);

/* Exactly this, by all active systems in step: for captures and bakes. */
typedef struct relume_pass_wishes {
  uint64_t max_form_factors; /* 0: no limit */
  uint32_t bounces;
  int restart;  /* first B = M + rho H */
  int residual; /* what the last bounce changed, for relume_frame.residuals */
  int gather;
  /* lm/m2. Above 0, for captures: of `bounces` only as many as bring output_error (without gather
   * radiosity_error) to it. Plan until it is; without a limit of form factors that is once. */
  double tolerance;
} relume_pass_wishes;

/* Instead of relume_plan_frame. When the limit cuts the pass (pass_complete is 0), planning on with any
 * wishes but a new limit continues it. */
relume_status relume_plan_together(relume_solver* solver, const relume_pass_wishes* wishes,
                                   relume_frame_report* report, relume_error* error);

typedef struct relume_irradiance_target {
  uint32_t system;
  relume_buffer_range target; /* 16 bytes per gather row; usage TRANSFER_DST */
  uint32_t lighting;          /* see compute/relume_passes.h */
} relume_irradiance_target;

/* Of compute/relume_passes.h. */
struct relume_lightmap;
struct relume_materials;
struct relume_screen_frame;

typedef struct relume_frame {
  const relume_input_copy* copies;
  uint32_t copy_count;
  relume_staging staging; /* of this frame, for lights: relume_light_staging_bytes */
  uint64_t max_rays;      /* shadow rays per system, about; 0: no limit */
  /* Written when their system is complete. */
  const relume_irradiance_target* irradiance;
  uint32_t irradiance_count;
  struct relume_lightmap* const* lightmaps; /* their images are in layout GENERAL */
  uint32_t lightmap_count;
  /* In front of the solver, materials first; relume_note_change for what they change. */
  struct relume_materials* const* materials;
  uint32_t material_count;
  const struct relume_screen_frame* screens;
  uint32_t screen_count;
  /* Gets the bytes for relume_read_residual, when it has a buffer (usage TRANSFER_DST). */
  relume_buffer_range residuals;
} relume_frame;

/* Staging memory for the lights of one frame: of all systems, with room for at least one block each. More
 * memory traces more in one frame. */
VkDeviceSize relume_light_staging_bytes(const relume_solver* solver);

/* Records the plan. What a dropped frame copied, its materials and screens go into the next again. Begins
 * with TRANSFER and COMPUTE_SHADER reads and writes, and ends with COMPUTE_SHADER and TRANSFER writes. */
relume_status relume_record_frame(relume_solver* solver, VkCommandBuffer commands, const relume_frame* frame,
                                  relume_error* error);

/* The recorded frame was submitted. */
void relume_frame_submitted(relume_solver* solver);

/* 1 when the planned frame completes the outputs of the system. */
int relume_frame_publishes(const relume_solver* solver, uint32_t system);

/* Not 0 while shadow rays are left for frames to come. */
int relume_lights_pending(const relume_solver* solver);

/* What the last bounce of a system changed, as maxima over its clusters, per channel; weighted: over its
 * RELUME_WEIGHTS. */
typedef struct relume_residual {
  double weighted_change[3];
  double change[3]; /* lm/m2 */
  double weighted_radiosity[3];
  double radiosity[3]; /* lm/m2 */
} relume_residual;

VkDeviceSize relume_residual_bytes(const relume_solver* solver);
/* From the bytes of relume_frame.residuals. `system` is below relume_model_system_count; for another
 * lighting, its number times relume_model_system_count more. */
relume_residual relume_read_residual(const void* bytes, uint32_t system);

/* ---- Time --------------------------------------------------------------------------------------------- */

/* A frame that the host measured, by timestamps around it. */
typedef struct relume_frame_time {
  uint64_t form_factors; /* relume_frame_report */
  double seconds;
} relume_frame_time;

/* seconds = per_frame + per_form_factor x form factors */
typedef struct relume_cost_model {
  double per_frame;
  double per_form_factor;
} relume_cost_model;

/* Least squares of relative errors, neither coefficient below 0. */
relume_cost_model relume_fit_cost_model(const relume_frame_time* frames, uint32_t count);

/* For max_form_factors: what fits into `seconds`. At least 1, which is the least that a frame can do. */
uint64_t relume_form_factors_within(const relume_cost_model* model, double seconds);

#ifdef __cplusplus
}
#endif

#endif
