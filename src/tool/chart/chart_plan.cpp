// SPDX-License-Identifier: MIT
#include "tool/chart/chart_plan.h"

#include <fmt/format.h>

#include <cmath>

namespace relume {
namespace {

/// The centre of all axes.
constexpr std::uint32_t kQuality = 512, kBudget = 128;
constexpr ValueCodec kCodec = ValueCodec::unorm16;

VariantPlan in_tiles(std::string axis, std::string value) {
  return {std::move(axis), std::move(value), {.codec = kCodec, .tile_rows = 8}};
}

std::vector<VariantPlan> centre_variants() {
  VariantPlan centre = in_tiles("centre", "centre");
  centre.role = PointRole::centre;
  std::vector<VariantPlan> all{centre};
  for (const ValueCodec codec : {ValueCodec::f32, ValueCodec::sqrt8})
    all.push_back({"value format", codec_name(codec), {.codec = codec, .tile_rows = 8}});
  const auto add = [&all](const char* axis, const KernelVariant& kernel) {
    const char* fetch = kernel.fetch == MatrixFetch::texels ? "texels" : "storage";
    const std::string name = fmt::format("{} {}", row_kernel_name(kernel.kernel), fetch);
    all.push_back({axis, kernel.tile_rows == 8 ? name : fmt::format("{} {}", name, codec_name(kernel.codec)),
                   kernel, true});
  };
  for (const RowKernel kernel : kRowKernels) {
    for (const MatrixFetch fetch : {MatrixFetch::storage, MatrixFetch::texels})
      add("kernel (tiles)", {kernel, fetch, kCodec, 8});
  }
  for (const ValueCodec codec : {ValueCodec::f32, kCodec}) {
    for (const MatrixFetch fetch : {MatrixFetch::storage, MatrixFetch::texels})
      add("kernel (plain CSR)", {RowKernel::row_per_thread, fetch, codec, 1});
  }
  return all;
}

class Axes {
 public:
  explicit Axes(const PrecomputeOptions& centre) : centre_(centre) {
    models_.push_back({"centre", "centre", PointRole::centre, centre, centre_variants()});
  }

  void vary(const char* axis, const std::string& value, const PrecomputeOptions& options) {
    models_.push_back({axis, value, PointRole::other, options, {in_tiles(axis, value)}});
  }
  void budget(std::uint32_t budget) {
    PrecomputeOptions options = centre_;
    options.budget = budget;
    vary("budget", std::to_string(budget), options);
  }
  void rays(std::uint32_t quality) {
    PrecomputeOptions options = centre_;
    options.quality = options.sensor_quality = quality;
    vary("rays", std::to_string(quality), options);
  }
  void cluster_size(double factor) {
    PrecomputeOptions options = centre_;
    options.cluster_size *= factor;
    vary("cluster size", fmt::format("{:.0f} cm", 100.0 * options.cluster_size), options);
  }
  void target(double error) {
    PrecomputeOptions options = centre_;
    options.error = error, options.codec.reset();
    options.budget = options.quality = options.sensor_quality = 0, options.cluster_size = 0.0;
    vary("--error", fmt::format("{:g} %", 100.0 * error), options);
    models_.back().variants.front().axis = "--error";
  }
  /// What the program does when nothing is asked for: all rows as the rays find them.
  void full_rows() {
    PrecomputeOptions options = centre_;
    options.budget = 0;
    VariantPlan stored{
        "budget", "full rows", {.codec = kCodec, .tile_rows = 1}, false, PointRole::program_default};
    models_.push_back({"budget", "full rows", PointRole::program_default, options, {stored}});
  }
  std::vector<ModelPlan> models() && { return std::move(models_); }

 private:
  PrecomputeOptions centre_;
  std::vector<ModelPlan> models_;
};

std::vector<ModelPlan> plan_models(const PrecomputeOptions& centre, bool quick) {
  using Counts = std::vector<std::uint32_t>;
  Axes axes(centre);
  for (const std::uint32_t budget : quick ? Counts{32, 64, 256} : Counts{32, 64, 256, 512})
    axes.budget(budget);
  axes.full_rows();
  for (const std::uint32_t rays : quick ? Counts{64, 1024} : Counts{64, 128, 256, 1024, 2048})
    axes.rays(rays);
  for (const double factor : quick ? std::vector{1.6, 0.7} : std::vector{2.0, 1.41, 0.71, 0.5})
    axes.cluster_size(factor);
  for (const double error : quick ? std::vector{0.1} : std::vector{0.1, 0.05, 0.03}) axes.target(error);
  return std::move(axes).models();
}

}  // namespace

ChartPlan make_chart_plan(const ChartOptions& options, double area) {
  const bool quick = options.quick;
  PrecomputeOptions centre;
  centre.quality = centre.sensor_quality = kQuality;
  centre.budget = kBudget;
  centre.codec = ValueCodec::f32;
  centre.threads = options.threads;
  const double texel_size =
      options.texel_size > 0.0 ? options.texel_size : std::sqrt(area / (quick ? 6000.0 : 40000.0));
  centre.texel_size = texel_size;
  centre.cluster_size = options.cluster_size > 0.0 ? options.cluster_size : texel_size * (quick ? 2.5 : 3.2);
  ChartPlan plan;
  plan.models = plan_models(centre, quick);
  plan.albedos = {0.5, 0.7, 0.8, 0.9, 0.95, 0.98, 0.99, 0.995, 0.998, 0.999};
  plan.paces = {240, 60};
  plan.products_per_frame = {1, 2, 3, 4, 6, 8};
  if (!quick) return plan;
  plan.answer = {5000.0, 256, 1u << 14};
  plan.sensors = 500;
  plan.precompute_repetitions = 1, plan.relight_repetitions = 7;
  plan.albedos = {0.5, 0.8, 0.95, 0.99, 0.999};
  plan.most_products = 1000, plan.products_clusters = 400.0;
  plan.frames = 12;
  return plan;
}

}  // namespace relume
