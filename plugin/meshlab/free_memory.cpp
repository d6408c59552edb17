#include "meshlab/free_memory.h"

#include <algorithm>
#include <atomic>
#include <fstream>
#include <limits>
#include <string>

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

double freeMemory() {
    double available = 1024.0 * numberAfter("/proc/meminfo", "MemAvailable:");
    const auto leaveAtMost = [&available](double limit, double used) {
        if (used < kUnknown) available = std::min(available, std::max(0.0, limit - used));
    };
    // What files take of a group's memory is given back when it is needed.
    const double inFiles = numberAfter("/sys/fs/cgroup/memory.stat", "inactive_file");
    leaveAtMost(numberIn("/sys/fs/cgroup/memory.max"),
                numberIn("/sys/fs/cgroup/memory.current") - (inFiles < kUnknown ? inFiles : 0.0));
    if (memoryLimit > 0.0)
        leaveAtMost(memoryLimit, 1024.0 * numberAfter("/proc/self/status", "VmRSS:"));
    return available;
}
