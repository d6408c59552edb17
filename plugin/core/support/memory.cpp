#include "core/support/memory.h"

#include <algorithm>
#include <atomic>
#include <fstream>
#include <limits>
#include <string>

namespace spectral {

namespace {

constexpr double kUnknown = std::numeric_limits<double>::infinity();

std::atomic<double> memoryLimit{0.0};

/// The number after a word in a file of words and numbers; infinity if there is none.
double numberAfter(const char* file, const std::string& word) {
    std::ifstream in(file);
    for (std::string read; in >> read;)
        if (double number = 0.0; read == word && in >> number) return number;
    return kUnknown;
}

/// The only number of a file; infinity if it has none.
double numberIn(const char* file) {
    double number = 0.0;
    return std::ifstream(file) >> number ? number : kUnknown;
}

}  // namespace

void setMemoryLimit(double bytes) { memoryLimit = bytes; }

double availableMemory() {
    double available = 1024.0 * numberAfter("/proc/meminfo", "MemAvailable:");
    const double group = numberIn("/sys/fs/cgroup/memory.max");
    if (group < kUnknown)
        available = std::min(available, group - numberIn("/sys/fs/cgroup/memory.current"));
    if (memoryLimit > 0.0)
        available =
            std::min(available, memoryLimit - 1024.0 * numberAfter("/proc/self/status", "VmRSS:"));
    return std::max(0.0, available);
}

}  // namespace spectral
