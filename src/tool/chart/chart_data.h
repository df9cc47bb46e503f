// SPDX-License-Identifier: MIT
//
// What `relume chart` measures, as plain values between measuring and drawing.
//
// Errors are of indirect irradiance at sensors spread evenly over all surfaces, against the converged answer
// (measure/converged_answer.h), for lights that no precompute knew: |I - I*| / |I*| per light, root mean
// square over the lights.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/methods/methods.h"
#include "measure/device_check.h"

namespace relume {

/// Whose own iteration is within this of its own solution counts as converged, light by light.
inline constexpr double kConverged = 1e-3;

/// An error by cause. What rays and clusters did is told apart by a second precompute with another seed.
struct ErrorCauses {
  double clusters = 0.0, rays = 0.0, cut = 0.0, precision = 0.0, bounces = 0.0;
  bool estimated = false;  ///< by the precompute (all but bounces), not measured
};

struct MeasuredError {
  double all_lights = 0.0;   ///< root mean square over the lights
  double worst_light = 0.0;  ///< of one light
};

enum class PointRole { other, centre, program_default };

/// A whole relighting, from the start to a converged radiosity and all lumels.
struct RelightPoint {
  std::string axis;   ///< what is varied: "budget", "kernel", "method", ...
  std::string value;  ///< to what
  PointRole role = PointRole::other;
  std::optional<KernelVariant> kernel;  ///< absent: the reference, double precision on one core
  Method method = Method::bounces;
  std::uint32_t products = 0;  ///< until converged
  MeasuredError error;
  std::vector<double> milliseconds;           ///< one per repetition
  std::uint64_t form_factors = 0, bytes = 0;  ///< of both matrices
  std::optional<ErrorCauses> causes;
};

struct PrecomputePoint {
  std::string axis, value;
  PointRole role = PointRole::other;
  MeasuredError error;  ///< of f32 values, or of those that the error target asked for
  std::vector<double> seconds;
  std::uint64_t rays = 0, form_factors = 0, bytes = 0;
};

/// A light on a circle, each frame's bounces starting from the last frame's radiosity.
struct TrackingPoint {
  std::uint32_t frames_per_turn = 0;  ///< 0: every frame starts anew
  std::uint32_t products = 0;         ///< per frame
  double error = 0.0;                 ///< mean over frames, against the same model's own solution
  std::vector<double> milliseconds;   ///< of the frame's bounces and gather
};

enum class MethodEnd {
  converged,
  gave_way,  ///< plain bounces had to finish
  refused,   ///< says that it cannot
  too_many   ///< products
};

struct ProductsPoint {
  std::string method;
  double albedo = 0.0;
  std::uint32_t products = 0;
  MethodEnd end = MethodEnd::converged;
  std::string reason;  ///< where it is not converged
};

struct ChartData {
  std::vector<RelightPoint> relights;
  std::vector<PrecomputePoint> precomputes;
  std::vector<TrackingPoint> tracking;
  std::vector<ProductsPoint> products;
  double densest_alone = 0.0;  ///< error of the densest model before extrapolation: doubt of the answer
  std::uint32_t densest_clusters = 0;
  std::uint32_t sensors = 0, lights = 0;
  double texel_size = 0.0, cluster_size = 0.0;  ///< m, of the centre
  std::uint32_t clusters = 0, lumels = 0;       ///< of the centre
  std::uint32_t products_clusters = 0;          ///< of the matrix of the products
  std::string device, driver;
  std::vector<std::string> notes;  ///< what could not be measured, and why
};

}  // namespace relume
