// SPDX-License-Identifier: MIT
#include "precompute/estimate_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "precompute/row_plan.h"

namespace relume {
namespace {

/// A target that is missed by more is told.
constexpr double kToldFrom = 1.2;

double root_mean_square(const std::vector<CutTile>& tiles) {
  double squares = 0.0, count = 0.0;
  for (const CutTile& tile : tiles) {
    for (const float error : tile.error) squares += double(error) * double(error), count += 1.0;
  }
  return count > 0.0 ? std::sqrt(squares / count) : 0.0;
}

}  // namespace

double ErrorEstimate::total() const {
  return std::sqrt(clusters * clusters + rays * rays + cut * cut + precision * precision);
}

void estimate_errors(const TracedRows& rows, const Surfaces& surfaces, const Probing& probing, double asked,
                     ValueCodec codec, PrecomputeReport& report) {
  double squares = 0.0, area = 0.0;
  for (std::size_t s = 0; s < rows.systems.size(); ++s) {
    for (std::size_t e = 0; e < rows.systems[s].element_rays.size(); ++e) {
      const double noise = rows.systems[s].element_rays[e].noise,
                   own = surfaces.systems[s].surface.elements[e].area;
      squares += own * std::min(noise * noise, kWhollyWrong);
      area += own;
    }
  }
  report.error.clusters = probing.cluster_error;
  report.error.precision = precision_error(codec);
  report.error.rays = area > 0.0 ? std::sqrt(squares / area) : 0.0;
  for (const SystemTiles& tiles : rows.tiles)
    report.error.cut = std::max(report.error.cut, root_mean_square(tiles.lumels));
  if (asked > 0.0 && report.error.total() > kToldFrom * asked) {
    report.warnings.push_back(
        fmt::format("asked for an error of {:.2g} %, estimated to reach {:.2g} %: clusters {:.2g} %, rays "
                    "{:.2g} %, cut {:.2g} %; clusters are "
                    "no smaller than lumels (--texel-size {:.3g})",
                    100.0 * asked, 100.0 * report.error.total(), 100.0 * report.error.clusters,
                    100.0 * report.error.rays, 100.0 * report.error.cut, report.texel_size));
  }
}

}  // namespace relume
