// SPDX-License-Identifier: MIT
#include "core/halvings.h"
#include "core/model_checks.h"

namespace relume {

Result<void> check_halvings(const Model& model) {
  for (std::size_t index = 0; index < model.systems.size(); ++index) {
    const System& system = model.systems[index];
    if (system.bounce_halvings.empty() && system.gather_halvings.empty()) continue;
    for (const System& other : model.systems) {
      if (!other.loaded)
        return broken_model("system {}: expected no halvings where a system is not loaded", index);
    }
    const std::vector<std::uint32_t> leaves = leaves_of_columns(model, system);
    const auto fits = [&](const BlockMatrix& matrix, const std::vector<std::uint8_t>& bytes) {
      return bytes.empty() || halving_offsets(matrix, leaves, bytes).has_value();
    };
    if (!fits(system.bounce, system.bounce_halvings) || !fits(system.gather, system.gather_halvings)) {
      return broken_model(
          "system {}: expected halvings of all nodes that its rows see and zeros after them, found {} and {} "
          "bytes that are not",
          index, system.bounce_halvings.size(), system.gather_halvings.size());
    }
  }
  return {};
}

}  // namespace relume
