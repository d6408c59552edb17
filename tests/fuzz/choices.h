#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <vector>

namespace spectral::fuzz {

/// Decisions read from the bytes of a seed; zeros after their end.
class Choices {
  public:
    Choices(const std::uint8_t* data, std::size_t size) : next_(data), end_(data + size) {}

    std::uint32_t bits(int bytes);  ///< Little-endian, 1 to 4 bytes.

    int below(int count);              ///< In [0, count), count <= 65536.
    int between(int least, int most);  ///< In [least, most].
    bool oneIn(int n) { return below(n) == n - 1; }
    double uniform(double from, double to);
    double logUniform(double from, double to);  ///< 0 < from <= to.

    template <class T>
    T pick(std::initializer_list<T> values) {
        return values.begin()[below(static_cast<int>(values.size()))];
    }

  private:
    const std::uint8_t *next_, *end_;
};

/// Seeds closer to each other share bytes.
inline constexpr std::uint64_t kSeedDistance = 64;

/// The bytes of a seed, the same on every platform.
std::vector<std::uint8_t> bytesOf(std::uint64_t seed);

}  // namespace spectral::fuzz
