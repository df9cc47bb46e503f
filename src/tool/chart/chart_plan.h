// SPDX-License-Identifier: MIT
//
// What will be measured: one thing at a time is varied from the centre.
#pragma once

#include <vector>

#include "measure/converged_answer.h"
#include "precompute/precompute.h"
#include "tool/chart/chart_data.h"

namespace relume {

struct ChartOptions {
  bool quick = false;
  double texel_size = 0.0;    ///< m; 0: about 40 k lumels, quick 6 k
  double cluster_size = 0.0;  ///< m, of the centre; 0: about 4 k clusters, quick 1 k
  std::uint32_t threads = 0;  ///< of precomputes; 0 = all
  std::string device_name{};  ///< part of the name of the Vulkan device; empty: any
};

/// A way to store and multiply the matrices of a model.
struct VariantPlan {
  std::string axis, value;
  KernelVariant kernel;  ///< codec and tiles count; with `own_kernel`, the rest as well
  bool own_kernel = false;
  PointRole role = PointRole::other;
};

struct ModelPlan {
  std::string axis, value;
  PointRole role = PointRole::other;
  PrecomputeOptions options;
  std::vector<VariantPlan> variants;
};

struct ChartPlan {
  std::vector<ModelPlan> models;  ///< the centre first
  AnswerSize answer;
  std::uint32_t sensors = 2000;
  std::uint32_t precompute_repetitions = 3, relight_repetitions = 15;
  std::vector<double> albedos;
  std::uint32_t most_products = 2000;  ///< of the chart of products
  double products_clusters = 500.0;    ///< of its matrix, about
  std::vector<std::uint32_t> paces;    ///< frames per turn of the moving light
  std::vector<std::uint32_t> products_per_frame;
  std::uint32_t frames = 40;
};

/// `area` of the scene, m2.
ChartPlan make_chart_plan(const ChartOptions& options, double area);

}  // namespace relume
