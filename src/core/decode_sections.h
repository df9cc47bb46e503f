// SPDX-License-Identifier: MIT
//
// From sections that were read, all or some, to a model.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/model.h"
#include "core/result.h"
#include "core/section_table.h"

namespace relume {

/// The name in a SYST section.
Result<std::string> decode_system_name(const Section& section);

/// The model in `sections`, which are in the order of the file, checked by check_model. `chosen` per system:
/// whether its sections are all there, or only SYST; empty: all of all. `name` is used in messages.
Result<Model> decode_sections(const std::vector<Section>& sections, const std::vector<bool>& chosen,
                              const std::string& name);

/// Memory ran out while `file` was read, which is there at once with what is made from it: says how much that
/// takes.
tl::unexpected<Error> no_memory_to_read(const std::filesystem::path& file);

}  // namespace relume
