// SPDX-License-Identifier: MIT
//
// Models made from models, to change one thing at a time.
#pragma once

#include "core/model.h"

namespace relume {

/// Every value in another codec. Rows in tiles of eight stay so, or are stored row by row (`tile_rows` 1:
/// CSR); rows that stand alone stay alone.
Model recoded(Model model, ValueCodec codec, std::uint32_t tile_rows);

/// Without its sensors: their rows are no part of a relighting.
Model without_sensors(Model model);

/// Bytes of the bounce and gather matrices of all systems.
std::uint64_t matrix_bytes(const Model& model);

/// Form factors of the bounce and gather matrices of all systems.
std::uint64_t form_factors(const Model& model);

}  // namespace relume
