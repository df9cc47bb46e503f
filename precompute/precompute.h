// SPDX-License-Identifier: MIT
//
// Scene -> model: charts, lumels, clusters, rays, rows (DESIGN of the method: precompute/README section of
// the project README).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/block_matrix.h"
#include "core/file_parts.h"
#include "core/model.h"
#include "core/result.h"
#include "scene/scene.h"

namespace relume {

struct RowsFile;

/// A sensor as given: world space; the normal need not be unit. Lifted off a surface that it lies on or just
/// under.
struct SensorPoint {
  std::string name;
  glm::dvec3 position{0.0};
  glm::dvec3 normal{0.0, 1.0, 0.0};
};

/// A light probe as given: world space.
struct ProbePoint {
  std::string name;
  glm::dvec3 position{0.0};
};

/// Return false to cancel. `stage` is a human word ("rays"), `fraction` 0..1 of that stage. Called from any
/// one thread at a time.
using ProgressObserver = std::function<bool(std::string_view stage, double fraction)>;

/// Rays of one receiver.
inline constexpr std::uint32_t kMaxQuality = 1u << 20;

struct PrecomputeOptions {
  double texel_size = 0.0;    ///< m, 0 = from the scene (about 40 k lumels)
  double cluster_size = 0.0;  ///< m, 0 = from the scene (about 4 k clusters); never below the texel size
  std::uint32_t quality =
      0;  ///< rays per lumel, a power of two is best; 0: as the error asks, or without one 512
  std::uint32_t sensor_quality =
      0;               ///< rays per sensor, 0 = as the error asks, or without one 16 x quality, at least 4096
  double error = 0.0;  ///< the target: of indirect irradiance, relative to its root mean square in the room,
                       ///< whatever the lights; 0: none. Chooses what is not asked for below.
  std::uint32_t budget =
      0;  ///< nodes that a tile of 8 neighbouring rows keeps, and a sensor; refused below one
          ///< for each cluster tree that a tile of the survey sees (a tile that turns out to
          ///< see more keeps one each); 0: as the error asks, or without one full rows
  std::uint32_t system_lumels = 1u << 16;  ///< of a system: larger ones are split where little light crosses;
                                           ///< 64 to 2^24
  std::optional<ValueCodec> codec;         ///< unless said: as the error asks, or without one f32
  double max_albedo = 0.95;                ///< above 0, at most 0.9999
  std::uint64_t seed = 0;
  std::uint32_t threads = 0;     ///< 0 = all
  std::uint64_t max_memory = 0;  ///< bytes that the process may have; 0: no limit. What is needed is
                                 ///< estimated before the long work, which is then refused (out_of_memory).
  std::vector<SensorPoint> sensors;
  std::vector<ProbePoint> probes;
  double probe_spacing = 0.0;  ///< m, above 0: in place of `probes`, a grid of them over the scene's box
  /// In place of both: denser where light between them would be off. Each then keeps about 256 nodes, unless
  /// error or budget ask for others.
  bool auto_probes = false;
  /// Rows of clusters obey reciprocity and keep their sums (reciprocal_rows.h): less noise of rays, and
  /// symmetric solvers converge. They are then held in memory together.
  bool reciprocal = false;
  bool bounds = false;        ///< cut rows tell how they share out what they see of nodes (core/halvings.h),
                              ///< and those between clusters are cut twice as fine
  bool directional = false;   ///< the gather matrix gets directions (core/directional_irradiance.h)
  bool keep_hollows = false;  ///< the insides of solids receive and send light, too (find_hollows.h)
  bool keep_rows = false;     ///< the report gets rows
  /// Rows of an earlier precompute (rows_file.h), whose sizes count as asked for where none are. Only rays
  /// that what has changed since may have changed are traced; the model is the one that it would be without,
  /// bit for bit. Fails (bad_input) when they were traced with another seed, texel size or ray tracer, or in
  /// a scene that has nothing in common with this one.
  const RowsFile* old_rows = nullptr;
  std::string old_rows_name;  ///< for messages
};

/// Estimated errors of indirect irradiance by cause, relative to its root mean square in the room.
struct ErrorEstimate {
  double clusters = 0.0;   ///< their size
  double rays = 0.0;       ///< noise of the rows of lumels
  double cut = 0.0;        ///< nodes in place of their leaves
  double precision = 0.0;  ///< of stored values
  double total() const;    ///< of independent causes
};

/// What the projection of PrecomputeOptions::reciprocal found and did.
struct Projection {
  /// Of the rays' form factors, S_ij = A_i F_ij: |S - S^T| / |S + S^T|, Frobenius norms. 0 afterwards, but
  /// for rounding.
  double asymmetry = 0.0;
  double change = 0.0;  ///< that it made: |S'' - S| / |S|
  double left = 0.0;    ///< share of the area whose rows keep their sums, but are not reciprocal
  std::uint32_t iterations = 0;
};

/// What the precompute did; not part of the model because times differ between runs.
struct PrecomputeReport {
  double texel_size = 0.0;
  double cluster_size = 0.0;
  std::uint64_t rays = 0;            ///< closest-hit rays of rows
  std::uint64_t occlusion_rays = 0;  ///< towards emitters and between neighbours
  std::uint64_t traced_rays = 0;     ///< of both kinds, those that were traced; each once where rows are kept
  std::uint64_t kept_rays = 0;       ///< that old rows knew
  std::vector<std::string> changed_nodes;  ///< paths of those whose geometry is not that of the old rows
  std::uint64_t invalid_lumels = 0;
  std::uint64_t split_lumels = 0;
  double hollow_area = 0.0;              ///< m2 of backs left out, inside of solids (find_hollows.h)
  ErrorEstimate error;                   ///< 0 where nothing was estimated
  std::optional<Projection> projection;  ///< where asked for
  double seconds_surfaces = 0.0;         ///< charts, lumels, clusters
  double seconds_rays = 0.0;             ///< rays and rows
  double seconds_rows = 0.0;             ///< trees, cut, matrices
  double seconds_total = 0.0;
  std::uint64_t peak_memory = 0;  ///< bytes that the process has had at most so far
  std::vector<std::string> warnings;
  FileParts rows;  ///< where asked for: the bytes of a .rows file (rows_file.h)
};

/// The same scene and options give the same model, bit for bit, for any number of threads.
Result<Model> precompute(const Scene& scene, const PrecomputeOptions& options, PrecomputeReport& report,
                         const ProgressObserver& observer = {});

/// What a precompute will take, extrapolated from a small sample of its rows and light probes.
struct PrecomputeEstimate {
  std::uint64_t rows = 0;      ///< of all matrices
  std::uint64_t nonzeros = 0;  ///< form factors, and entries of probes
  std::uint64_t file_bytes = 0;
  std::uint64_t memory_bytes = 0;  ///< that the process has at most, until the file is written
  std::uint64_t rays = 0;          ///< of rows, towards emitters too
  double seconds = 0.0;            ///< on this machine
};

/// Surfaces, survey and sample of a precompute; the model is thrown away. `report` gets sizes and warnings.
Result<PrecomputeEstimate> estimate_precompute(const Scene& scene, const PrecomputeOptions& options,
                                               PrecomputeReport& report,
                                               const ProgressObserver& observer = {});

}  // namespace relume
