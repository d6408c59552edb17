#include "fuzz/choices.h"

#include <cmath>

namespace spectral::fuzz {

std::uint32_t Choices::bits(int bytes) {
    std::uint32_t value = 0;
    for (int i = 0; i < bytes && next_ != end_; ++i)
        value |= static_cast<std::uint32_t>(*next_++) << (8 * i);
    return value;
}

int Choices::below(int count) { return static_cast<int>(bits(2) % static_cast<unsigned>(count)); }

int Choices::between(int least, int most) { return least + below(most - least + 1); }

double Choices::uniform(double from, double to) {
    return from + (to - from) * bits(4) / 4294967296.0;
}

double Choices::logUniform(double from, double to) {
    return std::exp(uniform(std::log(from), std::log(to)));
}

std::vector<std::uint8_t> bytesOf(std::uint64_t seed) {
    constexpr std::size_t kBytes = 8 * kSeedDistance;
    std::vector<std::uint8_t> bytes;
    // splitmix64
    for (std::uint64_t state = seed * 0x9e3779b97f4a7c15ULL; bytes.size() < kBytes;) {
        std::uint64_t z = state += 0x9e3779b97f4a7c15ULL;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
        z ^= z >> 31;
        for (int i = 0; i < 8; ++i) bytes.push_back(static_cast<std::uint8_t>(z >> (8 * i)));
    }
    return bytes;
}

}  // namespace spectral::fuzz
