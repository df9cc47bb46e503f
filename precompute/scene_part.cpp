// SPDX-License-Identifier: MIT
#include "precompute/scene_part.h"

#include <utility>

#include "precompute/embree_bvh.h"
#include "precompute/rig.h"
#include "scene/surface_color.h"

namespace relume {

void ScenePart::start() {
  tasks_.run([this] {
    auto bvh = build_occluder_bvh(geometry_.positions, geometry_.triangles, geometry_.opacity.stored());
    if (bvh) {
      made_.model.occluders.bvh = std::move(*bvh);
    } else {
      built_ = tl::unexpected(bvh.error());
    }
    GeometryHash hash = geometry_hash(scene_);
    made_.model.nodes = std::move(hash.nodes);
    made_.model.geometry_hash = hash.total;
  });
}

ScenePart::~ScenePart() {
  try {
    tasks_.wait();
  } catch (...) {  // whoever did not ask for it goes on without
  }
}

void ScenePart::light(const RayCaster& caster, std::optional<EarlierLooks> earlier) {
  tasks_.run([this, &caster, earlier = std::move(earlier)] {
    light_model(scene_, geometry_, caster, earlier ? &*earlier : nullptr, made_.model, made_.warnings,
                &made_.looked);
  });
}

Result<const ScenePart::Made*> ScenePart::get() {
  tasks_.wait();
  if (!built_) return tl::unexpected(built_.error());
  return &made_;
}

}  // namespace relume
