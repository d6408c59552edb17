#include "core/support/memory.h"

#include <atomic>
#include <limits>

namespace spectral {

namespace {

std::atomic<MemoryMeasure> hostMeasure{nullptr};

}  // namespace

void setMemoryMeasure(MemoryMeasure measure) { hostMeasure = measure; }

double availableMemory() {
    const MemoryMeasure measure = hostMeasure;
    return measure != nullptr ? measure() : std::numeric_limits<double>::infinity();
}

}  // namespace spectral
