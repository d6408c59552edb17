#include "core/support/memory.h"

#include <atomic>
#include <limits>
#include <sstream>

#include "core/support/errors.h"

namespace spectral {

namespace {

std::atomic<MemoryMeasure> hostMeasure{nullptr};

}  // namespace

void setMemoryMeasure(MemoryMeasure measure) { hostMeasure = measure; }

double availableMemory() {
    const MemoryMeasure measure = hostMeasure;
    return measure != nullptr ? measure() : std::numeric_limits<double>::infinity();
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
