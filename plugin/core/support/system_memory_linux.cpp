#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

#include "core/support/system_memory.h"

namespace spectral {

namespace {

constexpr double kUnknown = std::numeric_limits<double>::infinity();

/// The number that follows a word in a file; infinity if there is none.
double numberAfter(const char* file, const std::string& word) {
    std::ifstream in(file);
    for (std::string read; in >> read;)
        if (double number = 0.0; read == word && in >> number) return number;
    return kUnknown;
}

/// The number that a file starts with; infinity if there is none.
double numberIn(const char* file) {
    double number = 0.0;
    return std::ifstream(file) >> number ? number : kUnknown;
}

/// Memory left by the limit of the control group, bytes.
double availableInGroup() {
    const double used = numberIn("/sys/fs/cgroup/memory.current");
    if (used == kUnknown) return kUnknown;
    // Memory used for the file cache is reclaimed when needed.
    const double inFiles = numberAfter("/sys/fs/cgroup/memory.stat", "inactive_file");
    const double inUse = used - (inFiles < kUnknown ? inFiles : 0.0);
    return std::max(0.0, numberIn("/sys/fs/cgroup/memory.max") - inUse);
}

}  // namespace

double availableSystemMemory() {
    return std::min(1024.0 * numberAfter("/proc/meminfo", "MemAvailable:"), availableInGroup());
}

double residentMemory() { return 1024.0 * numberAfter("/proc/self/status", "VmRSS:"); }

}  // namespace spectral
