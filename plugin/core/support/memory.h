#pragma once

#include <cmath>

#include "core/support/types.h"

namespace spectral {

/// Memory that this process may still take, bytes; infinite where that is not known.
using MemoryMeasure = double (*)();

/// Sets the host's measure; without one nothing is refused for want of memory.
void setMemoryMeasure(MemoryMeasure measure);

/// What the host measures, bytes.
double availableMemory();

/// Refuses work that there is no memory for, before it is taken.
/// @param bytes  that it needs.
/// @param rows   vertices that it needs them for.
/// @throws Error  of code OutOfMemory, with the number of vertices that there is memory for.
void requireMemory(double bytes, Index rows);

/// "1.5 GiB"; for texts of errors.
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
