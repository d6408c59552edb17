#pragma once

namespace spectral {

/// Most resident memory that this process shall have, bytes; 0, the default: as much as there is.
void setMemoryLimit(double bytes);

/// Memory that this process may still take, bytes: what the system has free, what its control group
/// leaves, what the limit leaves. Infinite where the system does not tell (Linux does).
double availableMemory();

/// "1.5 GiB"; for texts of errors.
struct Bytes {
    double count;
};
template <class Stream>
Stream& operator<<(Stream& stream, const Bytes& bytes) {
    const double gibi = bytes.count / (1 << 30);
    if (gibi >= 1.0)
        stream << 0.1 * static_cast<long>(10.0 * gibi) << " GiB";
    else
        stream << static_cast<long>(1024.0 * gibi) << " MiB";
    return stream;
}

}  // namespace spectral
