// SPDX-License-Identifier: MIT
#include "precompute/process_memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <fstream>
#include <string>
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace relume {

std::uint64_t resident_bytes() {
  std::ifstream pages("/proc/self/statm");
  std::uint64_t all = 0, resident = 0;
  return pages >> all >> resident ? resident * std::uint64_t(sysconf(_SC_PAGESIZE)) : 0;
}

std::uint64_t peak_address_bytes() {
  std::ifstream status("/proc/self/status");
  std::string word;
  std::uint64_t kibibytes = 0;
  while (status >> word) {
    if (word == "VmPeak:" && status >> kibibytes) return kibibytes * 1024;
  }
  return peak_resident_bytes();
}

std::uint64_t reserved_bytes() {
  std::ifstream pages("/proc/self/statm");
  std::uint64_t all = 0, resident = 0;
  return pages >> all >> resident ? (all - resident) * std::uint64_t(sysconf(_SC_PAGESIZE)) : 0;
}

std::uint64_t peak_resident_bytes() {
  rusage usage{};
  return getrusage(RUSAGE_SELF, &usage) == 0 ? std::uint64_t(usage.ru_maxrss) * 1024 : 0;
}

void return_free_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

}  // namespace relume
