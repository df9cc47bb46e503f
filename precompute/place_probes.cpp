// SPDX-License-Identifier: MIT
#include "precompute/place_probes.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "core/probe_coefficients.h"
#include "core/quantities.h"
#include "precompute/cut.h"
#include "precompute/probe_cells.h"
#include "precompute/probe_lattice.h"
#include "precompute/progress.h"
#include "precompute/sphere_tracer.h"

namespace relume {
namespace {

constexpr double kMostProbes = 1e6;
/// Where probes are placed automatically, halving stops at so many.
constexpr std::size_t kMostPlaced = 200'000;
/// Halvings of a root cell at most; root cells are half as large as the scene is thin, but no less than a
/// sixteenth of its length.
constexpr std::uint32_t kDepth = 3;
constexpr double kRootsAlong = 16.0;
/// Rays of a probe that is only looked at: noise of about 1 % of its Y00.
constexpr std::uint32_t kRays = 1024;

/// A cell on its way: its lower corner and edge in steps of the lattice, and its entry among the nodes.
struct OpenCell {
  LatticePoint lower{};
  std::int32_t edge = 1;
  std::uint32_t node = 0;
};

LatticePoint corner_of(const OpenCell& cell, std::int32_t edge, std::uint32_t corner) {
  return {cell.lower[0] + ((corner & 1u) != 0 ? edge : 0), cell.lower[1] + ((corner & 2u) != 0 ? edge : 0),
          cell.lower[2] + ((corner & 4u) != 0 ? edge : 0)};
}

/// Grid of root cells over the box of the geometry.
ProbeVolume root_volume(const Geometry& geometry, double edge) {
  ProbeVolume volume;
  const glm::dvec3 size = glm::dvec3(geometry.upper) - glm::dvec3(geometry.lower);
  glm::dvec3 whole(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    volume.counts[std::size_t(axis)] = std::uint32_t(std::max(1.0, std::ceil(size[axis] / edge - 1e-6)));
    whole[axis] = edge * volume.counts[std::size_t(axis)];
  }
  volume.lower = glm::vec3(glm::dvec3(geometry.lower) - 0.5 * (whole - size));
  volume.edge = float(edge);
  return volume;
}

/// The tree while it grows, level by level.
class ProbeTree {
 public:
  ProbeTree(const Geometry& geometry, const RayCaster& caster, const ProbeVolume& roots, std::uint32_t depth)
      : geometry_(geometry),
        caster_(caster),
        volume_(roots),
        lattice_(geometry, caster, roots.lower, roots.edge / float(1u << depth)),
        step_(roots.edge / float(1u << depth)) {
    const auto edge = std::int32_t(1u << depth);
    for (std::uint32_t i = 0; i < roots.counts[0] * roots.counts[1] * roots.counts[2]; ++i) {
      const std::uint32_t x = i % roots.counts[0], yz = i / roots.counts[0];
      const std::uint32_t y = yz % roots.counts[1], z = yz / roots.counts[1];
      open_.push_back({{std::int32_t(x) * edge, std::int32_t(y) * edge, std::int32_t(z) * edge}, edge, i});
    }
    volume_.nodes.assign(open_.size(), kNoProbe);
    add_corners(open_, roots.edge);
  }

  const std::vector<OpenCell>& open() const { return open_; }
  float root_edge() const { return volume_.edge; }
  float edge_of(const OpenCell& cell) const { return step_ * float(cell.edge); }
  const ProbeLattice& lattice() const { return lattice_; }

  std::array<std::uint32_t, 8> probes_of(const OpenCell& cell) const {
    std::array<std::uint32_t, 8> probes;
    for (std::uint32_t c = 0; c < 8; ++c) probes[c] = lattice_.probe(corner_of(cell, cell.edge, c));
    return probes;
  }

  /// Cells as they are cut now, per open cell.
  std::vector<CutCell> cut() const {
    std::vector<CutCell> cells(open_.size());
    tbb::parallel_for(std::size_t{0}, open_.size(), [&](std::size_t i) {
      cells[i] = cut_cell(geometry_, caster_, probes_of(open_[i]), lattice_.positions(),
                          lattice_.place(open_[i].lower), edge_of(open_[i]));
    });
    return cells;
  }

  /// The 19 places between the corners of every open cell that can be halved.
  void add_middles() {
    std::vector<LatticePoint> points;
    for (const OpenCell& cell : open_) {
      if (cell.edge < 2) continue;
      for (int i = 0; i < 27; ++i) points.push_back(middle(cell, i));
    }
    if (!open_.empty()) lattice_.add(std::move(points), 0.5f * edge_of(open_.front()));
  }

  /// One of the 27 corners, middles of edges, of faces, and of the cell.
  static LatticePoint middle(const OpenCell& cell, int i) {
    const std::int32_t half = cell.edge / 2;
    return {cell.lower[0] + half * (i % 3), cell.lower[1] + half * (i / 3 % 3),
            cell.lower[2] + half * (i / 9)};
  }

  /// Open cells become leaves, or make room for their halves.
  void close(const std::vector<CutCell>& cells, const std::vector<bool>& halved) {
    std::vector<OpenCell> children;
    for (std::size_t i = 0; i < open_.size(); ++i) {
      if (!halved[i]) {
        close_leaf(open_[i], cells[i]);
        continue;
      }
      volume_.nodes[open_[i].node] = std::uint32_t(volume_.nodes.size());
      for (std::uint32_t c = 0; c < 8; ++c) {
        children.push_back({corner_of(open_[i], open_[i].edge / 2, c), open_[i].edge / 2,
                            std::uint32_t(volume_.nodes.size())});
        volume_.nodes.push_back(kNoProbe);
      }
    }
    open_ = std::move(children);
    if (!open_.empty()) add_corners(open_, edge_of(open_.front()));
  }

  /// Probes that no cell uses are left out.
  PlacedProbes finish() {
    std::vector<std::uint32_t> number(lattice_.positions().size(), kNoProbe);
    PlacedProbes placed;
    for (ProbeCell& cell : volume_.cells) {
      for (std::uint32_t& probe : cell.probes) {
        if (probe == kNoProbe) continue;
        if (number[probe] == kNoProbe) {
          number[probe] = std::uint32_t(placed.points.size());
          placed.points.push_back({fmt::format("{}", placed.points.size()),
                                   geometry_.origin + glm::dvec3(lattice_.positions()[probe])});
        }
        probe = number[probe];
      }
    }
    placed.volume = std::move(volume_);
    return placed;
  }

 private:
  void add_corners(const std::vector<OpenCell>& cells, float edge) {
    std::vector<LatticePoint> points;
    for (const OpenCell& cell : cells) {
      for (std::uint32_t c = 0; c < 8; ++c) points.push_back(corner_of(cell, cell.edge, c));
    }
    lattice_.add(std::move(points), edge);
  }

  void close_leaf(const OpenCell& open, const CutCell& cut) {
    if (!cut.in_use) return;
    volume_.nodes[open.node] = kProbeCellBit | std::uint32_t(volume_.cells.size());
    volume_.cells.push_back(cut.cell);
    volume_.cells.back().first_plane = std::uint32_t(volume_.planes.size());
    volume_.planes.insert(volume_.planes.end(), cut.planes.begin(), cut.planes.end());
  }

  const Geometry& geometry_;
  const RayCaster& caster_;
  ProbeVolume volume_;
  ProbeLattice lattice_;
  float step_;
  std::vector<OpenCell> open_;
};

/// What the probing emissions are at a probe: per harmonic, as far as irradiance knows it.
struct Glimpse {
  std::array<ProbingValues, kProbeHarmonics> light{};
  std::uint32_t room = kNoRoom;
};

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
/// is less than a tenth of the root mean square of the room, to that.
double squared_difference(const Glimpse& there, const Glimpse& told, const Probing& probing) {
  constexpr double kDark = 0.1;
  const ProbingValues& weights = weights_of_room(probing, there.room);
  double sum = 0.0;
  for (std::size_t p = 0; p < kProbings; ++p) {
    double off = 0.0, whole = 0.0;
    for (std::size_t h = 0; h < kProbeHarmonics; ++h) {
      const double difference = double(there.light[h][p]) - double(told.light[h][p]);
      off += difference * difference;
      whole += double(there.light[h][p]) * double(there.light[h][p]);
    }
    const double dark = weights[p] > 0.0f ? kDark / double(weights[p]) : 0.0;
    if (whole + dark * dark > 0.0) sum += off / (whole + dark * dark);
  }
  return sum / double(kProbings);
}

/// Looks at probes as they are added, and at how well those at the corners of a cell tell those between.
class Critic {
 public:
  Critic(const RowScene& scene, const Probing& probing, const ProbeTree& tree, double error)
      : scene_(scene), probing_(probing), tree_(tree), error_(error), points_(kRays, kRays) {}

  void look(RowCounts& counts) {
    const std::vector<glm::vec3>& positions = tree_.lattice().positions();
    const std::size_t known = glimpses_.size();
    glimpses_.resize(positions.size());
    tbb::enumerable_thread_specific<SphereTracer> tracers([&] { return SphereTracer(scene_); });
    tbb::parallel_for(known, positions.size(), [&](std::size_t i) {
      glimpses_[i] = glimpse_of(tracers.local().trace(positions[i], points_), probing_);
    });
    for (const SphereTracer& tracer : tracers) add_rays(tracer, counts);
  }

  /// Whether some place between the corners needs a probe of its own.
  bool asks_to_halve(const OpenCell& cell) const {
    const std::array<std::uint32_t, 8> corners = tree_.probes_of(cell);
    const glm::vec3 lower = tree_.lattice().place(cell.lower);
    double squares = 0.0;
    int places = 0;
    for (int i = 0; i < 27; ++i) {
      const std::uint32_t probe = tree_.lattice().probe(ProbeTree::middle(cell, i));
      if (probe == kNoProbe || std::find(corners.begin(), corners.end(), probe) != corners.end()) continue;
      const glm::vec3 position = tree_.lattice().positions()[probe];
      const std::optional<Glimpse> told =
          between(corners, position, (position - lower) / tree_.edge_of(cell));
      if (!told) return true;
      const double off = squared_difference(glimpses_[probe], *told, probing_);
      squares += off;
      ++places;
    }
    // What is off in a small cell concerns few points: it counts by the area of its faces.
    const double size = double(tree_.edge_of(cell)) / double(tree_.root_edge());
    return squares * size * size > error_ * error_ * places;
  }

 private:
  /// Nothing where no corner sees the place.
  std::optional<Glimpse> between(const std::array<std::uint32_t, 8>& corners, const glm::vec3& position,
                                 const glm::vec3& within) const {
    Glimpse sum;
    float weights = 0.0f;
    for (std::uint32_t c = 0; c < 8; ++c) {
      if (corners[c] == kNoProbe) continue;
      if (scene_.caster.occluded(tree_.lattice().positions()[corners[c]], position)) continue;
      const glm::vec3 upper((c & 1u) != 0, (c & 2u) != 0, (c & 4u) != 0);
      const glm::vec3 share = glm::clamp(glm::mix(1.0f - within, within, upper), 0.0f, 1.0f);
      const float weight = std::max(share.x * share.y * share.z, kLeastCornerWeight);
      weights += weight;
      for (std::size_t h = 0; h < kProbeHarmonics; ++h) {
        for (std::size_t p = 0; p < kProbings; ++p)
          sum.light[h][p] += weight * glimpses_[corners[c]].light[h][p];
      }
    }
    if (!(weights > 0.0f)) return std::nullopt;
    for (ProbingValues& values : sum.light) {
      for (float& value : values) value /= weights;
    }
    return sum;
  }

  const RowScene& scene_;
  const Probing& probing_;
  const ProbeTree& tree_;
  double error_;
  SobolPoints points_;
  std::vector<Glimpse> glimpses_;  ///< per probe of the lattice
};

}  // namespace

Result<PlacedProbes> place_probe_grid(const Geometry& geometry, const RayCaster& caster, double spacing) {
  const ProbeVolume roots = root_volume(geometry, spacing);
  const glm::dvec3 size = glm::dvec3(geometry.upper) - glm::dvec3(geometry.lower);
  const glm::dvec3 corners = glm::ceil(size / spacing - 1e-6) + 1.0;
  if (!(corners.x * corners.y * corners.z <= kMostProbes)) {
    return fail(
        ErrorCode::usage,
        fmt::format("probe spacing {} m: expected at most {:.0f} probes in a scene of {:.4g} x {:.4g} x "
                    "{:.4g} m, found {:.3g}",
                    spacing, kMostProbes, size.x, size.y, size.z, corners.x * corners.y * corners.z));
  }
  ProbeTree tree(geometry, caster, roots, 0);
  tree.close(tree.cut(), std::vector<bool>(tree.open().size(), false));
  return tree.finish();
}

Result<PlacedProbes> place_probes(const RowScene& scene, const Probing& probing, double error,
                                  RowCounts& counts, const ProgressObserver& observer) {
  const glm::vec3 size = scene.geometry.upper - scene.geometry.lower;
  const double longest = std::max({size.x, size.y, size.z}), thinnest = std::min({size.x, size.y, size.z});
  const double edge = std::max(0.5 * thinnest, longest / kRootsAlong);
  ProbeTree tree(scene.geometry, scene.caster, root_volume(scene.geometry, edge), kDepth);
  Critic critic(scene, probing, tree, error);
  for (std::uint32_t depth = 0; !tree.open().empty(); ++depth) {
    if (observer && !observer("probe places", double(depth) / (kDepth + 1)))
      return fail(ErrorCode::cancelled, "stopped while placing probes");
    const std::vector<CutCell> cells = tree.cut();
    std::vector<bool> halved(cells.size(), false);
    if (depth < kDepth && tree.lattice().positions().size() < kMostPlaced) {
      tree.add_middles();
      critic.look(counts);
      std::vector<char> asked(cells.size(), 0);
      tbb::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t i) {
        asked[i] = cells[i].uncovered > 0 || critic.asks_to_halve(tree.open()[i]) ? 1 : 0;
      });
      halved.assign(asked.begin(), asked.end());
    }
    tree.close(cells, halved);
  }
  return tree.finish();
}

}  // namespace relume
