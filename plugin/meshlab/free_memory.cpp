#include "meshlab/free_memory.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "meshlab/system_memory.h"

namespace {

std::atomic<double> memoryLimit{0.0};

}  // namespace

void setMemoryLimit(double bytes) { memoryLimit = bytes; }

double freeMemory() {
    const double available = availableSystemMemory(), resident = residentMemory();
    if (memoryLimit <= 0.0 || std::isinf(resident)) return available;
    return std::min(available, std::max(0.0, memoryLimit - resident));
}
