// SPDX-License-Identifier: MIT
#include "tool/watch_command.h"

#include <fmt/format.h>

#include "scene/scene_files.h"
#include "scene/surface_color.h"
#include "tool/interrupt.h"
#include "tool/stopwatch.h"
#include "tool/watched_files.h"

namespace relume {
namespace {

/// The scene, what it refers to, and CSVs.
std::vector<std::filesystem::path> files_of(const PrecomputeArguments& arguments) {
  std::vector<std::filesystem::path> files = scene_files(arguments.scene);
  if (arguments.sensors) files.push_back(*arguments.sensors);
  std::error_code ignored;
  if (std::filesystem::is_regular_file(arguments.probes, ignored)) files.emplace_back(arguments.probes);
  return files;
}

/// "; moved or changed: ..." in comparison with the nodes of the precompute before.
std::string geometry_change(const std::vector<NodeRecord>& before, const std::vector<NodeRecord>& now) {
  if (before.empty()) return "";
  const std::string changed = changed_nodes(before, now);
  return changed.empty() ? "; geometry as before" : changed;
}

void say_precomputed(const PrecomputeArguments& arguments, const PrecomputedFile& file, double seconds,
                     const std::vector<std::string>& saved, const std::string& change, Console& console) {
  const std::string after = saved.empty() ? "" : fmt::format(" after {} was saved", fmt::join(saved, ", "));
  console.say(fmt::format("{}: {:.1f} MB in {:.1f} s, {:.2f} million rays traced{}{}",
                          arguments.output.string(), 1e-6 * double(file.bytes), seconds,
                          1e-6 * double(file.report.traced_rays), after, change));
  console.event({{"file", arguments.output},
                 {"saved", json_array(saved)},
                 {"changed", change.empty() ? JsonValue() : JsonValue(change.substr(2))},
                 {"bytes", file.bytes},
                 {"rays", file.report.rays + file.report.occlusion_rays},
                 {"traced_rays", file.report.traced_rays},
                 {"seconds", seconds}});
}

}  // namespace

Result<int> run(const WatchArguments& arguments, Console& console) {
  const PrecomputeArguments& precompute = arguments.precompute;
  if (const auto ready = check_output(precompute.output); !ready) return tl::unexpected(ready.error());
  if (!std::filesystem::exists(precompute.scene)) {
    return fail(ErrorCode::bad_input,
                fmt::format("{}: expected a scene to watch, found no file.", precompute.scene.string()));
  }
  WatchedFiles files([&] { return files_of(precompute); });
  std::vector<NodeRecord> nodes;
  PrecomputeArguments next = precompute;
  next.options.keep_rows = true;
  while (files.wait([] { return !interrupted(); })) {
    allow_cut();
    Stopwatch watch;
    const auto go_on = [&] { return !files.changed_lately(); };
    auto file = precompute_to_file(next, console, go_on);
    if (!file && next.update && file.error().code != ErrorCode::cancelled) {
      next.update.reset();  // a scene may have nothing in common with the one before
      file = precompute_to_file(next, console, go_on);
    }
    // What is half saved is no error yet.
    if (!file && (file.error().code == ErrorCode::cancelled || files.changed())) continue;
    if (!file) {
      console.complain(file.error());
      continue;
    }
    say_precomputed(precompute, *file, watch.lap(), files.saved(), geometry_change(nodes, file->model.nodes),
                    console);
    nodes = std::move(file->model.nodes);
    next.update = next.output;
  }
  return 0;
}

}  // namespace relume
