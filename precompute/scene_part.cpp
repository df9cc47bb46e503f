// SPDX-License-Identifier: MIT
#include "precompute/scene_part.h"

#include <utility>

#include "precompute/embree_bvh.h"
#include "precompute/rig.h"
#include "scene/surface_color.h"

namespace relume {

ScenePart::ScenePart(const Scene& scene, const Geometry& geometry, const RayCaster& caster,
                     std::optional<EarlierLooks> earlier) {
  tasks_.run([&] {
    auto bvh = build_occluder_bvh(geometry.positions, geometry.triangles, geometry.opacity.stored());
    if (bvh) {
      made_.model.occluders.bvh = std::move(*bvh);
    } else {
      built_ = tl::unexpected(bvh.error());
    }
    GeometryHash hash = geometry_hash(scene);
    made_.model.nodes = std::move(hash.nodes);
    made_.model.geometry_hash = hash.total;
  });
  tasks_.run([&, earlier = std::move(earlier)] {
    light_model(scene, geometry, caster, earlier ? &*earlier : nullptr, made_.model, made_.warnings,
                &made_.looked);
  });
}

ScenePart::~ScenePart() {
  try {
    tasks_.wait();
  } catch (...) {  // whoever did not ask for it goes on without
  }
}

Result<const ScenePart::Made*> ScenePart::get() {
  tasks_.wait();
  if (!built_) return tl::unexpected(built_.error());
  return &made_;
}

}  // namespace relume
