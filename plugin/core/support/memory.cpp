#include "core/support/memory.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <sstream>

#include "core/support/errors.h"
#include "core/support/system_memory.h"

namespace spectral {

namespace {

std::atomic<double> memoryLimit{0.0};
std::atomic<MemoryMeasure> measureOfTests{nullptr};

}  // namespace

void setMemoryLimit(double bytes) { memoryLimit = bytes; }

void setMemoryMeasure(MemoryMeasure measure) { measureOfTests = measure; }

double availableMemory() {
    if (const MemoryMeasure measure = measureOfTests) return measure();
    const double available = availableSystemMemory(), resident = residentMemory();
    if (memoryLimit <= 0.0 || std::isinf(resident)) return available;
    return std::min(available, std::max(0.0, memoryLimit - resident));
}

void requireMemory(double bytes, Index rows) {
    const double available = availableMemory();
    if (bytes <= available) return;
    std::ostringstream text;
    text << "a surface of " << rows << " vertices needs about " << Bytes{bytes}
         << " more memory, of which " << Bytes{available} << " are free";
    throw Error(ErrorCode::OutOfMemory, text.str(),
                static_cast<Index>(0.9 * available / bytes * static_cast<double>(rows)));
}

}  // namespace spectral
