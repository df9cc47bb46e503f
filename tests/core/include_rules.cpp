// SPDX-License-Identifier: MIT
#include "core/include_rules.h"

#include <algorithm>
#include <fstream>
#include <regex>
#include <string_view>

namespace relume::test {
namespace {

namespace fs = std::filesystem;

/// Sources below `folder` may not include what matches `forbidden` (from its beginning, letter case aside).
struct IncludeRule {
  std::string folder;
  std::regex forbidden;
};

std::regex pattern(const char* text) {
  return std::regex(text, std::regex::ECMAScript | std::regex::icase);
}

const char* const kTinyGltf = "tiny_?gltf";
const char* const kJson = "(nlohmann|json\\.hpp)";

std::vector<IncludeRule> include_rules() {
  return {
      {"src/core/", pattern("(scene|precompute|compute|tool|viewer)/")},
      {"src/core/", pattern("(vulkan|vk_|embree)")},
      {"src/core/", pattern(kTinyGltf)},
      {"src/core/", pattern(kJson)},
      {"src/scene/", pattern("(precompute|compute|tool|viewer)/")},
      {"src/scene/", pattern("(vulkan|vk_|embree)")},
      {"precompute/", pattern("(compute|tool|viewer)/")},
      {"precompute/", pattern("(vulkan|vk_)")},
      {"precompute/", pattern(kTinyGltf)},
      {"compute/", pattern("(precompute|scene|tool|viewer)/")},
      {"compute/", pattern("embree")},
      {"compute/", pattern(kTinyGltf)},
      {"compute/", pattern(kJson)},
      {"kernels/", pattern("(core|scene|precompute|compute|tool|viewer)/")},
      {"src/", pattern("embree")},
      {"src/", pattern(".*\\.\\./")},
      {"precompute/", pattern(".*\\.\\./")},
      {"compute/", pattern(".*\\.\\./")},
  };
}

bool below(const std::string& path, std::string_view folder) {
  return path.compare(0, folder.size(), folder) == 0;
}

bool is_source(const fs::path& file) {
  const std::string extension = file.extension().string();
  for (const char* known : {".h", ".hpp", ".cpp", ".c", ".comp", ".glsl", ".rgen"}) {
    if (extension == known) return true;
  }
  return false;
}

bool is_embree_door(const std::string& path) {
  const std::string name = fs::path(path).filename().string();
  return path == "precompute/ray_caster.cpp" || (below(path, "precompute/") && below(name, "embree_"));
}

/// Folders that hold libraries a host links; only programs and compute/standalone own a device.
bool is_guest(const std::string& path) {
  const bool library = below(path, "src/core/") || below(path, "src/scene/") || below(path, "precompute/") ||
                       below(path, "compute/");
  return library && !below(path, "compute/standalone/");
}

std::string without_comment(const std::string& line) {
  return line.substr(0, line.find("//"));
}

class File {
 public:
  File(std::string path, std::vector<std::string>& crossings)
      : path_(std::move(path)), crossings_(crossings) {}

  void check_line(const std::string& line, int number) {
    static const std::regex include_line("^\\s*#\\s*include\\s*[<\"]([^>\"]+)[>\"].*");
    static const std::regex host_call(
        "(^|[^A-Za-z0-9_])(vkCreateInstance|vkCreateDevice|vkQueueSubmit2?(KHR)?|vkQueueWaitIdle|"
        "vkDeviceWaitIdle|vkWaitForFences|"
        "vkWaitSemaphores(KHR)?)\\b.*");
    std::smatch match;
    if (std::regex_match(line, match, include_line)) check_include(match[1].str(), number);
    const std::string code = without_comment(line);
    if (is_guest(path_) && std::regex_search(code, match, host_call)) {
      report(number, match[2].str() + " belongs to the host");
    }
  }

 private:
  void check_include(const std::string& included, int number) {
    for (const IncludeRule& rule : include_rules()) {
      if (below(path_, rule.folder) && starts_with(included, rule.forbidden)) {
        report(number, "includes " + included);
        return;
      }
    }
    if (below(path_, "precompute/") && !is_embree_door(path_) && starts_with(included, pattern("embree"))) {
      report(number, "includes " + included + "; only precompute/ray_caster.cpp does");
    }
  }

  static bool starts_with(const std::string& text, const std::regex& start) {
    return std::regex_search(text, start, std::regex_constants::match_continuous);
  }

  void report(int number, const std::string& what) {
    crossings_.push_back(path_ + ":" + std::to_string(number) + ": " + what);
  }

  std::string path_;
  std::vector<std::string>& crossings_;
};

}  // namespace

std::vector<std::string> find_crossings(const fs::path& root) {
  std::vector<std::string> crossings;
  for (const char* folder : {"kernels", "src", "precompute", "compute"}) {
    if (!fs::is_directory(root / folder)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      if (!entry.is_regular_file() || !is_source(entry.path())) continue;
      File file(fs::relative(entry.path(), root).generic_string(), crossings);
      std::ifstream stream(entry.path());
      int number = 0;
      for (std::string line; std::getline(stream, line);) file.check_line(line, ++number);
    }
  }
  std::sort(crossings.begin(), crossings.end());
  return crossings;
}

}  // namespace relume::test
