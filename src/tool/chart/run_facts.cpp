// SPDX-License-Identifier: MIT
#include "tool/chart/run_facts.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/utsname.h>

#include <array>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <thread>

#include "relume_commit.h"

namespace relume {
namespace {

std::string processor_name() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

std::string system_name() {
  utsname name{};
  return uname(&name) == 0 ? fmt::format("{} {}, {}", name.sysname, name.release, name.machine) : "unknown";
}

}  // namespace

std::string load_text() {
  std::array<double, 3> loads{};
  if (getloadavg(loads.data(), int(loads.size())) != int(loads.size())) return "unknown";
  return fmt::format("{:.1f}, {:.1f}, {:.1f}", loads[0], loads[1], loads[2]);
}

Facts facts_of_this_run() {
  return {{"program", std::string("relume ") + RELUME_VERSION},
          {"commit", kCommit},
          {"compiler", __VERSION__},
          {"processor", fmt::format("{}, {} cores", processor_name(), std::thread::hardware_concurrency())},
          {"system", system_name()},
          {"date", fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(std::time(nullptr)))}};
}

}  // namespace relume
