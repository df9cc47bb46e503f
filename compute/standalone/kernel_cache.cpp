// SPDX-License-Identifier: MIT
#include "compute/standalone/kernel_cache.h"

#include <unistd.h>

#include <fstream>
#include <sstream>
#include <system_error>
#include <vector>

namespace relume {
namespace {

constexpr const char* kStorage = "storage";
constexpr const char* kTexels = "texels";

std::vector<std::string> lines_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

bool is_of(const std::string& line, const std::string& key) {
  return line.size() > key.size() && line[key.size()] == '\t' && line.starts_with(key);
}

std::optional<RowKernelChoice> parsed(const std::string& text) {
  std::istringstream words(text);
  std::string kernel_name, fetch_name;
  words >> kernel_name >> fetch_name;
  const auto kernel = row_kernel_from_name(kernel_name);
  if (!kernel || (fetch_name != kStorage && fetch_name != kTexels)) return std::nullopt;
  return RowKernelChoice{*kernel, fetch_name == kTexels ? MatrixFetch::texels : MatrixFetch::storage};
}

}  // namespace

std::optional<RowKernelChoice> read_kernel_cache(const std::filesystem::path& file, const std::string& key) {
  for (const std::string& line : lines_of(file)) {
    if (is_of(line, key)) return parsed(line.substr(key.size() + 1));
  }
  return std::nullopt;
}

bool write_kernel_cache(const std::filesystem::path& file, const std::string& key,
                        const RowKernelChoice& choice) {
  std::error_code failed;
  std::filesystem::create_directories(file.parent_path(), failed);
  std::filesystem::path part = file;
  part += std::to_string(getpid());
  {
    std::ofstream out(part);
    for (const std::string& line : lines_of(file)) {
      if (!is_of(line, key)) out << line << '\n';
    }
    out << key << '\t' << row_kernel_name(choice.kernel) << '\t'
        << (choice.fetch == MatrixFetch::texels ? kTexels : kStorage) << '\n';
    if (!out.flush()) return false;
  }
  std::filesystem::rename(part, file, failed);
  return !failed;
}

}  // namespace relume
