// SPDX-License-Identifier: MIT
#include "scene/import/meshopt_decode.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <new>

#include "scene/import/import_error.h"

namespace relume {
namespace {

/// The densest stream spends 4 header bytes on 256 bytes of a vertex component and one byte on a triangle of
/// 12; a claim beyond this is false, and is refused before memory is taken for it.
constexpr std::size_t kMaxExpansion = 256;

/// What the stride must be for the decoder not to read or write out of step, or nothing.
std::string_view stride_objection(const CompressedView& view) {
  if (view.mode != "ATTRIBUTES") return view.stride == 2 || view.stride == 4 ? "" : "a stride of 2 or 4";
  if (view.filter == "OCTAHEDRAL") return view.stride == 4 || view.stride == 8 ? "" : "a stride of 4 or 8";
  if (view.filter == "QUATERNION") return view.stride == 8 ? "" : "a stride of 8";
  return view.stride % 4 == 0 ? "" : "a stride that is a multiple of 4";
}

bool run_decoder(const CompressedView& view, std::span<const std::byte> packed, std::vector<std::byte>& out) {
  const auto* data = reinterpret_cast<const unsigned char*>(packed.data());
  if (view.mode == "TRIANGLES") {
    return meshopt_decodeIndexBuffer(out.data(), view.count, view.stride, data, packed.size()) == 0;
  }
  if (view.mode == "INDICES") {
    return meshopt_decodeIndexSequence(out.data(), view.count, view.stride, data, packed.size()) == 0;
  }
  return meshopt_decodeVertexBuffer(out.data(), view.count, view.stride, data, packed.size()) == 0;
}

void apply_filter(const CompressedView& view, std::vector<std::byte>& out) {
  if (view.filter == "OCTAHEDRAL") meshopt_decodeFilterOct(out.data(), view.count, view.stride);
  if (view.filter == "QUATERNION") meshopt_decodeFilterQuat(out.data(), view.count, view.stride);
  if (view.filter == "EXPONENTIAL") meshopt_decodeFilterExp(out.data(), view.count, view.stride);
}

}  // namespace

Result<std::vector<std::byte>> decode_compressed_view(const CompressedView& view,
                                                      std::span<const std::byte> packed,
                                                      const std::string& file, std::string_view place) {
  if (const auto objection = stride_objection(view); !objection.empty()) {
    return import_error(file, place, objection, fmt::format("{}", view.stride));
  }
  if (view.mode == "TRIANGLES" && view.count % 3 != 0) {
    return import_error(file, place, "a count that is a multiple of 3", fmt::format("{}", view.count));
  }
  const std::size_t size = view.count * view.stride;
  if (size > (packed.size() + 64) * kMaxExpansion) {
    return import_error(file, place, fmt::format("what {} packed bytes can hold", packed.size()),
                        fmt::format("a claim of {} bytes", size));
  }
  try {
    std::vector<std::byte> out(size);
    if (!run_decoder(view, packed, out)) {
      return import_error(file, place, "data that the meshopt decoder accepts", "other bytes");
    }
    apply_filter(view, out);
    return out;
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::out_of_memory, fmt::format("{}: {}: no memory for {} bytes", file, place, size));
  }
}

}  // namespace relume
