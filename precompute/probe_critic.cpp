// SPDX-License-Identifier: MIT
#include "precompute/probe_critic.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "core/quantities.h"

namespace relume {
namespace {

/// Rays of a place: noise of about 1 % of its Y00.
constexpr std::uint32_t kRaysPerPoint = 1024;
/// Samples of root cells, and of their halves.
constexpr std::size_t kRootSamples = 256, kCellSamples = 64;
/// What a place where no probe speaks counts for: all of its light is off.
constexpr double kBlack = 1.0;
/// A lighting by emitters counts for so many others, so that together they are half of all: lamps shine.
constexpr double kEmitterShare = 7.0;

Glimpse glimpse_of(const ProbeRow& row, const Probing& probing) {
  // Irradiance (probe_irradiance); squares add up to 4 pi times their mean over all normals.
  constexpr std::array<double, kProbeHarmonics> kLobe{1.0,  2.0 / 3, 2.0 / 3, 2.0 / 3, 0.25,
                                                      0.25, 0.25,    0.25,    0.25};
  Glimpse glimpse;
  FormFactorRow seen;
  for (const SeenSender& sender : row.senders) {
    seen.senders.push_back(sender.sender), seen.values.push_back(sender.solid_angle);
    const Harmonics y = mean_harmonics(glm::dvec3(sender.direction));
    for (std::size_t h = 0; h < kProbeHarmonics; ++h) {
      const auto worth = float(kLobe[h] * y[h] * double(sender.solid_angle) / std::sqrt(4.0 * kPi));
      for (std::size_t p = 0; p < kProbings; ++p)
        glimpse.light[h][p] += worth * probing.senders[sender.sender][p];
    }
  }
  glimpse.room = room_of(probing, seen);
  return glimpse;
}

/// Mean over probing emissions of the squared difference of irradiance, relative to what there is; where that
/// is less than a tenth of the root mean square of the room, to that. 0 of places that see no room. A
/// lighting by emitters counts for `emitter_share` others.
double squared_difference(const Glimpse& there, const Glimpse& told, const Probing& probing,
                          double emitter_share) {
  constexpr double kDark = 0.1;
  const ProbingValues& weights = weights_of_room(probing, there.room);
  double sum = 0.0, shares = 0.0;
  for (std::size_t p = 0; p < kProbings; ++p) {
    const double share = by_emitters(p) ? emitter_share : 1.0;
    shares += share;
    if (!(weights[p] > 0.0f)) continue;
    double off = 0.0, whole = 0.0;
    for (std::size_t h = 0; h < kProbeHarmonics; ++h) {
      const double difference = double(there.light[h][p]) - double(told.light[h][p]);
      off += difference * difference;
      whole += double(there.light[h][p]) * double(there.light[h][p]);
    }
    const double dark = kDark / double(weights[p]);
    sum += share * off / (whole + dark * dark);
  }
  return sum / shares;
}

}  // namespace

ProbeCritic::ProbeCritic(const RowScene& scene, const Probing& probing, ProbeTree& tree)
    : scene_(scene), probing_(probing), tree_(tree), points_(kRaysPerPoint, kRaysPerPoint), tracers_([this] {
        return SphereTracer(scene_);
      }) {}

void ProbeCritic::rate(std::size_t first) {
  glance(tree_.lattice().positions(), probes_);
  draw_samples(first);
  glance(samples_, seen_);
  tbb::parallel_for(first, tree_.cells().size(), [&](std::size_t i) { set_loss(tree_.cells()[i]); });
  tree_.propose(first);
  glance(tree_.lattice().positions(), probes_);
  tbb::parallel_for(first, tree_.cells().size(), [&](std::size_t i) { hand_down(i); });
}

void ProbeCritic::set_loss(OpenCell& cell) const {
  const double volume = double(cell.edges[0]) * double(cell.edges[1]) * double(cell.edges[2]);
  cell.free = volume * (cell.cut.covered + cell.cut.uncovered);
  cell.loss = volume * (cell.cut.covered * squared_error(cell) + kBlack * cell.cut.uncovered);
}

void ProbeCritic::add_counts(RowCounts& counts) const {
  for (const SphereTracer& tracer : tracers_) add_rays(tracer, counts);
}

/// Of those places that have no glimpse yet.
void ProbeCritic::glance(const std::vector<glm::vec3>& places, std::vector<Glimpse>& glimpses) {
  const std::size_t known = glimpses.size();
  glimpses.resize(places.size());
  tbb::parallel_for(known, places.size(), [&](std::size_t i) {
    glimpses[i] = glimpse_of(tracers_.local().trace(places[i], points_), probing_);
  });
}

/// Each cell gets its fill, beside what it had as a half of another.
void ProbeCritic::draw_samples(std::size_t first) {
  std::vector<std::vector<glm::vec3>> drawn(tree_.cells().size() - first);
  const std::size_t wanted = first == 0 ? kRootSamples : kCellSamples;
  tbb::parallel_for(std::size_t{0}, drawn.size(),
                    [&](std::size_t i) { drawn[i] = new_samples(first + i, wanted); });
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    for (const glm::vec3& point : drawn[i]) {
      tree_.cells()[first + i].samples.push_back(std::uint32_t(samples_.size()));
      samples_.push_back(point);
    }
  }
}

/// Halves of a cell take over its samples.
void ProbeCritic::hand_down(std::size_t cell) const {
  for (CellSplit& split : tree_.splits(cell)) {
    const auto axis = int(split.axis);
    const float meet = tree_.lattice().place(split.halves[1].lower)[axis];
    for (const std::uint32_t s : tree_.cells()[cell].samples)
      split.halves[samples_[s][axis] >= meet ? 1 : 0].samples.push_back(s);
    for (OpenCell& half : split.halves) set_loss(half);
  }
}

/// In free space, by the generalised golden ratio (M. Roberts, The Unreasonable Effectiveness of Quasirandom
/// Sequences, 2018), another part of it in each cell.
std::vector<glm::vec3> ProbeCritic::new_samples(std::size_t index, std::size_t wanted) const {
  const OpenCell& cell = tree_.cells()[index];
  std::vector<glm::vec3> samples;
  if (!(cell.cut.covered > 0.0)) return samples;
  const std::size_t missing = wanted - std::min(wanted, cell.samples.size());
  const glm::vec3 lower = tree_.lattice().place(cell.lower);
  const float shift = 0.5f + 0.618034f * float(index % 1024);
  for (std::size_t k = 0; k < 2 * missing && samples.size() < missing; ++k) {
    const glm::vec3 within = glm::fract(shift + float(k + 1) * glm::vec3(0.8191725f, 0.6710436f, 0.5497005f));
    const glm::vec3 point = lower + tree_.edges_of(cell) * within;
    if (inside_box(scene_.geometry, point) && in_free_space(scene_.geometry, scene_.caster, point, 0.0f))
      samples.push_back(point);
  }
  return samples;
}

/// Mean square of what is off where some probe of the cell speaks.
double ProbeCritic::squared_error(const OpenCell& cell) const {
  const glm::vec3 lower = tree_.lattice().place(cell.lower);
  const double share = scene_.emitters.list.empty() ? 1.0 : kEmitterShare;
  double squares = 0.0, told_samples = 0.0;
  for (const std::uint32_t s : cell.samples) {
    const std::optional<Glimpse> told =
        between(cell, samples_[s], (samples_[s] - lower) / tree_.edges_of(cell));
    if (!told) continue;
    squares += squared_difference(seen_[s], *told, probing_, share);
    told_samples += 1.0;
  }
  return told_samples > 0.0 ? squares / told_samples : 0.0;
}

/// What the cell's probes tell; nothing where none speaks.
std::optional<Glimpse> ProbeCritic::between(const OpenCell& cell, const glm::vec3& position,
                                            const glm::vec3& within) const {
  Glimpse sum;
  float total = 0.0f;
  const std::array<float, 8> weights =
      corner_weights(cell.cut.cell, cell.cut.planes, tree_.edges_of(cell), position, within);
  for (std::uint32_t c = 0; c < 8; ++c) {
    if (!(weights[c] > 0.0f)) continue;
    total += weights[c];
    const Glimpse& seen = probes_[cell.cut.cell.probes[c]];
    for (std::size_t h = 0; h < kProbeHarmonics; ++h) {
      for (std::size_t p = 0; p < kProbings; ++p) sum.light[h][p] += weights[c] * seen.light[h][p];
    }
  }
  if (!(total > 0.0f)) return std::nullopt;
  for (ProbingValues& values : sum.light) {
    for (float& value : values) value /= total;
  }
  return sum;
}

}  // namespace relume
