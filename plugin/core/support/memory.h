#pragma once

#include <cmath>

#include "core/support/types.h"

namespace spectral {

/// Limits the resident memory of this process, bytes; 0 (the default): no limit.
void setMemoryLimit(double bytes);

/// Memory that this process may still allocate, bytes: the minimum of what the system, its control
/// group and the limit leave. Infinite if unknown: on other systems than Linux, Windows and macOS.
double availableMemory();

/// Returns memory in bytes, as availableMemory.
using MemoryMeasure = double (*)();

/// Replaces availableMemory, for tests; null restores it.
void setMemoryMeasure(MemoryMeasure measure);

/// Rejects work that does not fit in memory before it starts.
/// @param bytes  memory required.
/// @param rows   number of vertices it is required for.
/// @throws Error  with code OutOfMemory and the number of vertices that would fit as its limit().
void requireMemory(double bytes, Index rows);

/// Formats a number of bytes as in "1.5 GiB", for error messages.
struct Bytes {
    double count;
};
template <class Stream>
Stream& operator<<(Stream& stream, const Bytes& bytes) {
    const double gibi = bytes.count / (1 << 30);
    if (gibi >= 1.0)
        stream << 0.1 * std::floor(10.0 * gibi) << " GiB";
    else
        stream << std::floor(1024.0 * gibi) << " MiB";
    return stream;
}

}  // namespace spectral
