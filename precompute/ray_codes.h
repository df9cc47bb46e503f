// SPDX-License-Identifier: MIT
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace relume {

/// What a ray met, as one number: a cell of the sky, the back or the bare front of a triangle (one without
/// elements), or an element.
struct RayCodes {
  static constexpr std::uint32_t kUnknown = 0;  ///< not traced
  static constexpr std::uint32_t kNoRay =
      1;  ///< a wall stands between the middle of the receiver and the origin
  static constexpr std::uint32_t kFirstCell = 2;
  static constexpr std::uint32_t kSkyResolution = 8;  ///< core/sky.h

  std::uint32_t triangles = 0, elements = 0;

  std::uint32_t back(std::uint32_t triangle) const { return kFirst + triangle; }
  std::uint32_t bare(std::uint32_t triangle) const { return kFirst + triangles + triangle; }
  std::uint32_t element(std::uint32_t element) const { return first_element() + element; }
  std::uint32_t first_element() const { return kFirst + 2 * triangles; }
  static bool is_sky(std::uint32_t code) { return code >= kFirstCell && code < kFirst; }
  bool is_back(std::uint32_t code) const { return code >= kFirst && code < kFirst + triangles; }
  bool is_bare(std::uint32_t code) const { return code >= kFirst + triangles && code < first_element(); }
  bool is_element(std::uint32_t code) const { return code >= first_element(); }

  std::uint64_t count() const { return kFirst + 2 * std::uint64_t{triangles} + elements; }
  /// Bytes that a code is stored in: 1 to 4.
  std::uint32_t width() const { return (std::uint32_t(std::bit_width(count())) + 7) / 8; }

 private:
  static constexpr std::uint32_t kFirst = kFirstCell + 6 * kSkyResolution * kSkyResolution;
};

/// Bytes that may be read beyond the last code.
inline constexpr std::size_t kCodePadding = 3;

inline std::uint32_t load_code(const std::byte* codes, std::uint32_t width, std::size_t index) {
  std::uint32_t word = 0;
  std::memcpy(&word, codes + width * index, sizeof word);
  return word & (0xffffffffu >> (32 - 8 * width));
}

/// Reads nothing beyond the code.
inline std::uint32_t load_exactly(const std::byte* codes, std::uint32_t width, std::size_t index) {
  const std::byte* const at = codes + width * index;
  std::uint32_t code = std::to_integer<std::uint32_t>(at[0]);
  if (width > 1) code |= std::to_integer<std::uint32_t>(at[1]) << 8;
  if (width > 2) code |= std::to_integer<std::uint32_t>(at[2]) << 16;
  if (width > 3) code |= std::to_integer<std::uint32_t>(at[3]) << 24;
  return code;
}

inline void store_code(std::byte* codes, std::uint32_t width, std::size_t index, std::uint32_t code) {
  // Byte by byte: a word that overlaps the one written before would have to wait for it.
  std::byte* const at = codes + width * index;
  at[0] = std::byte(code);
  if (width > 1) at[1] = std::byte(code >> 8);
  if (width > 2) at[2] = std::byte(code >> 16);
  if (width > 3) at[3] = std::byte(code >> 24);
}

}  // namespace relume
