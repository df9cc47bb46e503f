// SPDX-License-Identifier: MIT
#include "precompute/rows_keeper.h"

#include <algorithm>
#include <iterator>

#include "precompute/geometry_keys.h"

namespace relume {

RowsKeeper::RowsKeeper(const Scene& scene, const PrecomputeOptions& options, const Geometry& geometry)
    : scene_(scene), options_(options), triangle_keys_(triangle_keys(geometry)) {}

Result<std::unique_ptr<RowsKeeper>> RowsKeeper::start(const Scene& scene, const PrecomputeOptions& options,
                                                      const Geometry& geometry, PrecomputeReport& report) {
  std::unique_ptr<RowsKeeper> keeper(new RowsKeeper(scene, options, geometry));
  if (options.old_rows == nullptr) return keeper;
  auto change = SceneChange::find(*options.old_rows, options.old_rows_name, scene, geometry, options.seed,
                                  keeper->triangle_keys_);
  if (!change) return tl::unexpected(change.error());
  report.changed_nodes = change->nodes();
  keeper->change_.emplace(std::move(*change));
  return keeper;
}

std::optional<EarlierSurfaces> RowsKeeper::earlier() const {
  if (!change_) return std::nullopt;
  return EarlierSurfaces{*change_, triangle_keys_};
}

std::vector<std::uint8_t> RowsKeeper::known_ties(const Geometry& geometry) const {
  return change_ ? change_->known_ties(geometry) : std::vector<std::uint8_t>();
}

Result<void> RowsKeeper::follow(const Surfaces& surfaces, const SenderLookup& lookup, const RayCaster& caster,
                                const PrecomputeReport& report) {
  surfaces_ = &surfaces, caster_ = &caster;
  element_keys_ =
      element_keys({surfaces.geometry, triangle_keys_, surfaces.charts, surfaces.layouts}, surfaces.systems);
  memory_.codes = {std::uint32_t(triangle_keys_.size()), lookup.element_count()};
  if (options_.keep_rows) memory_.record.emplace(memory_.codes);
  if (!change_) return {};
  if (auto arrived = change_->old().await_rays(); !arrived) return arrived;
  auto kept = KeptRays::compare(*change_, options_.old_rows_name, report.texel_size, surfaces, caster, lookup,
                                element_keys_);
  if (!kept) return tl::unexpected(kept.error());
  memory_.kept = &kept_.emplace(std::move(*kept));
  return {};
}

WholeElements RowsKeeper::known_whole(const std::vector<std::vector<std::uint32_t>>& orders) const {
  WholeElements whole;
  std::uint32_t first = 0;
  for (const auto& order : orders) {
    whole.emplace_back(order.size(), 0);
    for (std::size_t i = 0; i < order.size() && kept_; ++i)
      whole.back()[i] = kept_->was_whole(first + order[i]) ? 1 : 0;
    first += std::uint32_t(order.size());
  }
  return whole;
}

void RowsKeeper::keep_whole(const std::vector<std::vector<std::uint32_t>>& orders, const WholeElements& whole,
                            std::vector<std::uint64_t> views) {
  patch_views_ = std::move(views);
  whole_.assign(element_keys_.size(), 0);
  std::uint32_t first = 0;
  for (std::size_t s = 0; s < orders.size(); ++s) {
    for (std::size_t i = 0; i < orders[s].size(); ++i) whole_[first + orders[s][i]] = whole[s][i];
    first += std::uint32_t(orders[s].size());
  }
}

std::optional<EarlierLooks> RowsKeeper::earlier_looks(const Geometry& geometry,
                                                      const RayCaster& caster) const {
  if (!change_ || !change_->comparable()) return std::nullopt;
  return EarlierLooks{change_->old(), change_->changed_boxes(geometry, caster)};
}

void RowsKeeper::keep_looks(EnclosedGrid grid) {
  looked_ = std::move(grid);
}

std::uint64_t RowsKeeper::memory_of(std::uint64_t rays) const {
  return memory_.record ? rays * memory_.codes.width() : 0;
}

void RowsKeeper::take_rays() {
  rays_ = memory_.record->take(memory_.emitters);
}

FileParts RowsKeeper::finish(const PrecomputeReport& report) {
  const Geometry& geometry = surfaces_->geometry;
  RowsFile file;
  file.settings.offset = geometry.offset;
  file.settings.seed = options_.seed;
  file.settings.texel_size = report.texel_size, file.settings.cluster_size = report.cluster_size;
  file.settings.origin = geometry.origin;
  file.settings.emitters = memory_.emitters;
  file.scene_file = scene_.file_name, file.ray_tracer = caster_->description();
  for (const SceneNode& node : scene_.nodes) file.nodes.push_back(node.path);
  file.positions = geometry.positions, file.triangles = geometry.triangles;
  file.triangle_keys = std::move(triangle_keys_), file.triangle_nodes = geometry.node;
  file.ties = caster_->ties(), file.hollow.assign(geometry.hollow.begin(), geometry.hollow.end());
  file.element_keys = std::move(element_keys_), file.whole_elements = std::move(whole_);
  std::set_union(surfaces_->views.begin(), surfaces_->views.end(), patch_views_.begin(), patch_views_.end(),
                 std::back_inserter(file.views));
  file.look_grid = looked_.grid, file.looks = std::move(looked_.looks);
  return encode_rows(file, std::move(rays_));
}

}  // namespace relume
