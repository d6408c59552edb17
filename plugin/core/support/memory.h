#pragma once

#include <cmath>

namespace spectral {

/// Memory that this process may still take, bytes; infinite where that is not known.
using MemoryMeasure = double (*)();

/// Sets the host's measure; without one nothing is refused for want of memory.
void setMemoryMeasure(MemoryMeasure measure);

/// What the host measures, bytes.
double availableMemory();

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
