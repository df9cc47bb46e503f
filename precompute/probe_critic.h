// SPDX-License-Identifier: MIT
//
// How well the probes of a cell tell the light between them: seen with few rays from places drawn in it,
// under the probing emissions.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <array>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "core/probe_coefficients.h"
#include "precompute/cut.h"
#include "precompute/probe_tree.h"
#include "precompute/sphere_tracer.h"

namespace relume {

/// What the probing emissions are at a place: per harmonic, as far as irradiance knows it.
struct Glimpse {
  std::array<ProbingValues, kProbeHarmonics> light{};
  std::uint32_t room = kNoRoom;
};

class ProbeCritic {
 public:
  /// Borrows all.
  ProbeCritic(const RowScene& scene, const Probing& probing, ProbeTree& tree);

  /// Proposes splits of the cells from `first` on, which are new, and sets what both lose. In the calling
  /// task arena; the same for any number of threads.
  void rate(std::size_t first);

  /// Places that were looked from: probes, and those between them. Each takes about 600 bytes.
  std::size_t places() const { return probes_.size() + seen_.size(); }

  void add_counts(RowCounts& counts) const;

 private:
  void glance(const std::vector<glm::vec3>& places, std::vector<Glimpse>& glimpses);
  void draw_samples(std::size_t first);
  void hand_down(std::size_t cell) const;
  void set_loss(OpenCell& cell) const;
  std::vector<glm::vec3> new_samples(std::size_t cell, std::size_t wanted) const;
  double squared_error(const OpenCell& cell) const;
  std::optional<Glimpse> between(const OpenCell& cell, const glm::vec3& position,
                                 const glm::vec3& within) const;

  const RowScene& scene_;
  const Probing& probing_;
  ProbeTree& tree_;
  SobolPoints points_;
  tbb::enumerable_thread_specific<SphereTracer> tracers_;
  std::vector<Glimpse> probes_;     ///< per probe of the lattice
  std::vector<glm::vec3> samples_;  ///< places in cells
  std::vector<Glimpse> seen_;       ///< per sample
};

}  // namespace relume
