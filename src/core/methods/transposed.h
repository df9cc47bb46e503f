// SPDX-License-Identifier: MIT
#pragma once

#include "core/block_matrix.h"

namespace relume {

/// Rows become columns.
CsrMatrix transposed(const CsrMatrix& matrix);

}  // namespace relume
