// SPDX-License-Identifier: MIT
#include "precompute/rows_keeper.h"

#include "precompute/geometry_keys.h"

namespace relume {

RowsKeeper::RowsKeeper(const Scene& scene, std::uint64_t seed, const Surfaces& surfaces,
                       const RayCaster& caster, const SenderLookup& lookup)
    : scene_(scene),
      seed_(seed),
      surfaces_(surfaces),
      caster_(caster),
      triangle_keys_(triangle_keys(surfaces.geometry)),
      element_keys_(element_keys(triangle_keys_, surfaces.charts, surfaces.layouts, surfaces.systems)),
      memory_{{std::uint32_t(triangle_keys_.size()), lookup.element_count()}, std::nullopt, nullptr, 0} {}

Result<std::unique_ptr<RowsKeeper>> RowsKeeper::start(const Scene& scene, const PrecomputeOptions& options,
                                                      const Surfaces& surfaces, const RayCaster& caster,
                                                      const SenderLookup& lookup, PrecomputeReport& report) {
  std::unique_ptr<RowsKeeper> keeper(new RowsKeeper(scene, options.seed, surfaces, caster, lookup));
  if (options.keep_rows) keeper->memory_.record.emplace(keeper->memory_.codes);
  if (options.old_rows == nullptr) return keeper;
  auto kept =
      KeptRays::compare(*options.old_rows, options.old_rows_name, scene, options.seed, report.texel_size,
                        surfaces, caster, lookup, keeper->triangle_keys_, keeper->element_keys_);
  if (!kept) return tl::unexpected(kept.error());
  report.changed_nodes = kept->changed_nodes();
  keeper->kept_.emplace(std::move(*kept));
  keeper->memory_.kept = &*keeper->kept_;
  return keeper;
}

std::uint64_t RowsKeeper::memory_of(std::uint64_t rays) const {
  // As they are, and once more in the file's bytes; those of the old file are there already.
  return memory_.record ? 2 * rays * memory_.codes.width() : 0;
}

std::vector<std::byte> RowsKeeper::finish(const PrecomputeReport& report) {
  const Geometry& geometry = surfaces_.geometry;
  RowsFile file;
  file.settings.offset = geometry.offset;
  file.settings.seed = seed_;
  file.settings.texel_size = report.texel_size, file.settings.cluster_size = report.cluster_size;
  file.settings.origin = geometry.origin;
  file.settings.emitters = memory_.emitters;
  file.scene_file = scene_.file_name, file.ray_tracer = caster_.description();
  for (const SceneNode& node : scene_.nodes) file.nodes.push_back(node.path);
  file.positions = geometry.positions, file.triangles = geometry.triangles;
  file.triangle_keys = std::move(triangle_keys_), file.triangle_nodes = geometry.node;
  file.ties = caster_.ties();
  file.element_keys = std::move(element_keys_);
  memory_.record->move_into(file);
  return encode_rows(file);
}

}  // namespace relume
