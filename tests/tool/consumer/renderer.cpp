// SPDX-License-Identifier: MIT
//
// What a renderer programmer links: core and compute, from an installed package.
#include <compute/gpu_solver.h>
#include <core/model_file.h>
#include <core/reference_solver.h>

#ifdef WITH_BAKER
bool bakes();
#endif

int main() {
  const relume::Model empty;
  const bool reads = relume::decode_model(relume::encode_model(empty), "empty").has_value();
  const bool names = relume::row_kernel_from_name("row_per_thread").has_value();
#ifdef WITH_BAKER
  return reads && names && bakes() ? 0 : 1;
#else
  return reads && names ? 0 : 1;
#endif
}
