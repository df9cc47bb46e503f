// SPDX-License-Identifier: MIT
//
// What check_model and check_system share.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <span>
#include <utility>

#include "core/model.h"

namespace relume {

/// Nodes span at least two of the `leaves` leaves, and have a share for each.
Result<void> check_tree(const ClusterTreeNodes& tree, std::size_t leaves, const std::string& owner);

/// From 0 to 1, and together 1.
bool are_shares(std::span<const float> values);

/// The promises of core/opacity.h, over so many triangles.
Result<void> check_opacity(const Opacity& opacity, std::size_t triangles);

/// Texture coordinates of ascending triangles, of so many.
Result<void> check_texture(const std::vector<TextureTriangle>& texture, std::size_t triangles);

/// The promises of core/occluder_bvh.h; triangles and opacity are checked before.
Result<void> check_bvh(const Occluders& occluders);

/// A cluster, sky patch or node that there is. Whether a system that is not loaded has it is not known.
Result<void> check_sender(const Model& model, const SenderRef& sender, const std::string& owner);

/// The promises of the nodes above the systems; those of the systems are checked before.
Result<void> check_top_tree(const Model& model);

/// The promises of system `index`; those of the occluders are checked before.
Result<void> check_system(const Model& model, std::size_t index);

/// The promises of core/halvings.h; all systems and nodes are checked before.
Result<void> check_halvings(const Model& model);

/// The promises of core/probe_volume.h.
Result<void> check_probe_volume(const Model& model);

/// The promises of the probes of system `index`; its imports are checked before.
Result<void> check_probes(const Model& model, std::size_t index);

template <class... Values>
tl::unexpected<Error> broken_model(fmt::format_string<Values...> sentence, Values&&... values) {
  return fail(ErrorCode::check_failed, "model: " + fmt::format(sentence, std::forward<Values>(values)...));
}

template <int N, class T>
bool finite(const glm::vec<N, T>& v) {
  for (int k = 0; k < N; ++k) {
    if (!std::isfinite(v[k])) return false;
  }
  return true;
}

/// Of length 1, as far as 32 bits can say.
template <class T>
bool unit(const glm::vec<3, T>& v) {
  return finite(v) && std::abs(glm::length(glm::dvec3(v)) - 1.0) < 1e-3;
}

}  // namespace relume
