/* SPDX-License-Identifier: MIT
 *
 * c_renderer ROOMS SQUARES: a renderer in C, from an installed package. Reads a model of rooms, asks what its
 * device must have and, where there is one, lights it for some frames: what a lamp adds must double with its
 * intensity. Then see colors.h. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "colors.h"

static int failed(const char* what, const relume_error* error) {
  fprintf(stderr, "%s: %s\n", what, error->message);
  return 1;
}

static int upload(struct renderer* r, relume_solver* solver, const relume_staging* staging) {
  relume_error error;
  for (int pending = 1; pending != 0;) {
    if (relume_record_upload(solver, begin_commands(r), staging, &pending, &error) != RELUME_OK)
      return failed("upload", &error);
    if (submit_commands(r) != 0) return 1;
  }
  return 0;
}

/* `first` has system 0 alone, as it would come while frames run. */
static int load(struct renderer* r, relume_solver* solver, const relume_model* model,
                const relume_model* first, const relume_staging* staging) {
  relume_error error;
  const relume_light_options lamps = {16, 0, 0};
  if (relume_solver_bind(solver, allocate_buffer, r, &error) != RELUME_OK) return failed("bind", &error);
  for (uint32_t s = 0; s < relume_model_system_count(model); ++s) {
    relume_use_model(solver, s == 0 ? first : model);
    if (relume_load_system(solver, s, 0.0, allocate_buffer, r, &error) != RELUME_OK ||
        relume_add_lights(solver, s, &lamps, allocate_buffer, r, &error) != RELUME_OK)
      return failed(relume_model_system_name(model, s), &error);
  }
  return upload(r, solver, staging);
}

/* So many frames with a lamp; the sum of the irradiance of system 0 in the last of them. */
static int light(struct renderer* r, relume_solver* solver, double candela, int frames,
                 const relume_staging* staging, const relume_irradiance_target* target,
                 const float* irradiance, double* sum) {
  relume_error error;
  relume_light lamp;
  memset(&lamp, 0, sizeof lamp);
  lamp.type = RELUME_POINT;
  lamp.position[0] = 1.31;
  lamp.position[1] = 1.42;
  lamp.position[2] = 1.73;
  for (int c = 0; c < 3; ++c) lamp.intensity[c] = candela;
  for (int i = 0; i < frames; ++i) {
    const relume_frame_wishes wishes = {0, 2, 0.0};
    relume_frame frame;
    memset(&frame, 0, sizeof frame);
    frame.staging = *staging;
    frame.irradiance = target;
    frame.irradiance_count = 1;
    if (relume_set_lights(solver, &lamp, 1, &error) != RELUME_OK ||
        relume_plan_frame(solver, &wishes, NULL, &error) != RELUME_OK ||
        relume_record_frame(solver, begin_commands(r), &frame, &error) != RELUME_OK)
      return failed("frame", &error);
    /* The second is thrown away. */
    if (i == 1) {
      vkEndCommandBuffer(r->commands);
      continue;
    }
    if (submit_commands(r) != 0) return 1;
    relume_frame_submitted(solver);
  }
  *sum = 0.0;
  for (VkDeviceSize i = 0; i < target->target.byte_size / 16; ++i) *sum += irradiance[4 * i];
  return 0;
}

static int run(struct renderer* r, const relume_model* model, const relume_model* first) {
  relume_error error;
  relume_host host;
  memset(&host, 0, sizeof host);
  host.instance = r->instance;
  host.physical_device = r->physical_device;
  host.device = r->device;
  host.get_instance_proc_addr = vkGetInstanceProcAddr;
  relume_solver* solver = NULL;
  if (relume_solver_create(&host, model, NULL, 1e6, &solver, &error) != RELUME_OK)
    return failed("create", &error);
  relume_staging staging, results;
  relume_irradiance_target target = {0};
  double none = 0.0, once = 0.0, twice = 0.0;
  int status = allocate_staging(r, 1 << 22, &staging) || load(r, solver, model, first, &staging);
  if (status == 0) {
    const VkDeviceSize bytes = relume_irradiance(solver, 0).byte_size;
    status = allocate_staging(r, bytes, &results);
    target.target = results.range;
  }
  if (status == 0)
    status = light(r, solver, 0.0, 24, &staging, &target, results.mapped, &none) ||
             light(r, solver, 100.0, 24, &staging, &target, results.mapped, &once) ||
             light(r, solver, 200.0, 24, &staging, &target, results.mapped, &twice);
  if (status == 0) printf("irradiance of system 0: %g, %g, %g\n", none, once, twice);
  if (status == 0 && !(once > none && fabs((twice - none) / (once - none) - 2.0) <= 1e-3)) status = 1;
  relume_solver_destroy(solver);
  return status;
}

/* Frames of 2 ms and a nanosecond a form factor. */
static int check_cost_model(void) {
  const relume_frame_time frames[2] = {{1000000, 0.003}, {3000000, 0.005}};
  const relume_cost_model model = relume_fit_cost_model(frames, 2);
  const double within = (double)relume_form_factors_within(&model, 0.004);
  return fabs(within - 2e6) <= 1e3 && relume_form_factors_within(&model, 0.001) == 1 ? 0 : 1;
}

/* The first system alone. */
static relume_model* read_first_system(const char* file, const relume_model* model) {
  relume_error error;
  relume_model* part = NULL;
  const char* name = relume_model_system_name(model, 0);
  const char* nobody = "no such system";
  if (relume_model_read_systems(file, &nobody, 1, &part, &error) != RELUME_USAGE || part != NULL) return NULL;
  if (relume_model_read_systems(file, &name, 1, &part, &error) != RELUME_OK) failed("read", &error);
  return part;
}

int main(int count, char** arguments) {
  relume_error error;
  relume_model* model = NULL;
  if (relume_model_read("/nowhere/model.relume", &model, &error) != RELUME_BAD_INPUT || model != NULL ||
      error.message[0] == '\0')
    return 1;
  if (check_cost_model() != 0) return 1;
  if (count < 3) return 0;
  relume_model* squares = NULL;
  if (relume_model_read(arguments[1], &model, &error) != RELUME_OK ||
      relume_model_read(arguments[2], &squares, &error) != RELUME_OK)
    return failed("read", &error);
  for (uint32_t s = 0; s < relume_model_system_count(model); ++s)
    printf("%s: %u clusters, %u gather rows\n", relume_model_system_name(model, s),
           relume_model_cluster_count(model, s), relume_model_gather_row_count(model, s));
  relume_model* first = read_first_system(arguments[1], model);
  if (first == NULL) return 1;
  struct renderer renderer;
  int status = 0;
  if (open_renderer(&renderer, &error))
    status = run(&renderer, model, first) || check_colors(&renderer, squares);
  else
    printf("no device: %s\n", error.message);
  close_renderer(&renderer);
  relume_model_destroy(first);
  relume_model_destroy(squares);
  relume_model_destroy(model);
  return status;
}
