// SPDX-License-Identifier: MIT
//
// Reading and writing .relume files; the format is on src/FILE_FORMAT.md.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/file_parts.h"
#include "core/model.h"
#include "core/result.h"

namespace relume {

/// The bytes of a file that holds `model`. The same model gives the same bytes.
std::vector<std::byte> encode_model(const Model& model);

/// The same bytes, for the most part borrowed from the model.
FileParts encode_model_parts(const Model& model);

/// Verifies structure, sizes (before anything is allocated), every checksum, then check_model. `name` is used
/// in messages.
Result<Model> decode_model(std::span<const std::byte> bytes, const std::string& name);

/// Writes to a temporary name in the same folder, syncs, renames: an existing file is replaced whole or not
/// at all. A model of which systems are not loaded is refused (usage).
Result<void> write_model(const Model& model, const std::filesystem::path& file);

Result<Model> read_model(const std::filesystem::path& file);

/// The names of the systems in a file, in their order. Reads no more than the table and the names.
Result<std::vector<std::string>> read_system_names(const std::filesystem::path& file);

/// The model with the systems `names` alone: only their sections and those of the model are read and checked.
/// The others keep their numbers, but System::loaded is false and nothing shines from them; missing_share.h
/// says what that leaves open. Fails (usage) for a name that is not there, or without any.
Result<Model> read_systems(const std::filesystem::path& file, std::span<const std::string> names);

/// The bytes of a file.
Result<std::vector<std::byte>> read_file(const std::filesystem::path& file);

/// The same crash-safe write for any bytes; every file that Relume writes goes through it.
Result<void> write_file(const std::filesystem::path& file, std::span<const std::byte> bytes);
Result<void> write_parts(const std::filesystem::path& file,
                         std::span<const std::span<const std::byte>> parts);

}  // namespace relume
