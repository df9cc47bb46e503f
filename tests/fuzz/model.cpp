// SPDX-License-Identifier: MIT
//
// Files of which the sections are anything, under checksums that are right (wrong ones are refused at once,
// and tests say so): one line, or a model that can be solved and written again.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include "core/bracket.h"
#include "core/model_file.h"
#include "core/reference_solver.h"
#include "core/section_table.h"
#include "fuzz/input_file.h"

namespace {

using namespace relume;

struct Part {
  SectionRecord record;
  std::vector<std::byte> bytes;
};

std::vector<Part> parts_of(std::span<const std::byte> file) {
  std::vector<Part> parts;
  if (const auto sections = read_sections(file, "input")) {
    for (const Section& section : *sections)
      parts.push_back({section.record, {section.bytes.begin(), section.bytes.end()}});
  }
  return parts;
}

std::vector<std::byte> file_of(const std::vector<Part>& parts) {
  SectionWriter writer;
  for (const Part& part : parts)
    writer.add({part.record.id.data(), part.record.id.size()}, part.record.owner, part.bytes,
               part.record.flags);
  return std::move(writer).finish();
}

}  // namespace

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* bytes, std::size_t size, std::size_t max_size);

/// Changes what one section holds; now and then the order, number or owner of sections.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* bytes, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
  std::vector<Part> parts = parts_of(std::as_bytes(std::span(bytes, size)));
  if (parts.empty()) parts = parts_of(encode_model(Model{}));
  std::minstd_rand random(seed);
  const auto any = [&] { return random() % parts.size(); };
  const std::size_t at = any();
  switch (random() % 32) {
    case 0:
      parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(at));
      break;
    case 1:
      parts.push_back(parts[at]);
      break;
    case 2:
      std::swap(parts[at], parts[any()]);
      break;
    case 3:
      parts[at].record.owner = static_cast<std::uint32_t>(random() % 4) - 1;
      break;
    default: {
      std::vector<std::byte>& content = parts[at].bytes;
      const std::size_t used = content.size();
      content.resize(used + 64);
      content.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(content.data()), used, used + 64));
    }
  }
  const std::vector<std::byte> file = file_of(parts);
  if (file.size() > max_size) return size;
  std::memcpy(bytes, file.data(), file.size());
  return file.size();
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const auto model = decode_model(std::as_bytes(std::span(bytes, size)), "input");
  if (!model) {
    test::require_one_line(model.error(), "input");
    return 0;
  }
  const std::vector<std::byte> written = encode_model(*model);
  const auto again = decode_model(written, "written");
  test::require(again.has_value() && encode_model(*again) == written,
                "what was read can be written and read again");
  const ReferenceMatrices matrices = reference_matrices(*model);
  const auto solution = solve_reference(matrices.bounce, stored_lighting(*model), {3, 0.0});
  test::require(solution.has_value(), "what passes the checks can be solved");
  for (const Rgb& b : solution->radiosity)
    test::require(std::isfinite(b.x + b.y + b.z), "radiosity is finite");
  int products = 8;
  const auto bracket = bracket_solution(loose_matrices(*model), stored_lighting(*model), solution->radiosity,
                                        [&] { return products-- > 0; });
  if (!bracket) return 0;
  for (std::size_t i = 0; i < bracket->radiosity.low.size(); ++i) {
    const Rgb width = bracket->radiosity.high[i] - bracket->radiosity.low[i];
    test::require(width.x >= 0.0 && width.y >= 0.0 && width.z >= 0.0, "bounds are in order");
  }
  return 0;
}
