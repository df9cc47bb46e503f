// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/result.h"

namespace relume {

/// Every view inside its buffer, every accessor inside its view, sparse parts included, in 64-bit arithmetic
/// and before any data is read. `document` has passed check_rules.
Result<void> check_ranges(const nlohmann::json& document, const std::string& file);

/// Indices have data behind them; what is packed in a way that is not read is named.
Result<void> check_primitives(const nlohmann::json& document, const std::string& file);

/// A camera has the object that its type names, and a spot light its cone.
Result<void> check_variants(const nlohmann::json& document, const std::string& file);

/// The nodes are a forest: no node has two parents, no cycles, and no root of a scene is a child.
Result<void> check_node_forest(const nlohmann::json& document, const std::string& file);

}  // namespace relume
