#pragma once

#include <cmath>
#include <cstddef>

#if defined(__SSE2__) || defined(_M_X64)
#define SPECTRAL_SUBNORMALS_ARE_SLOW
#include <xmmintrin.h>
#endif

namespace spectral {

namespace {  // compiled for several instruction sets

/// While an instance exists, its thread treats subnormal numbers, those below 2.2e-308, as 0.
///
/// Entries of L decay exponentially away from the diagonal, faster for larger shifts: many are
/// subnormal in large fronts, and x86 processors take a hundred cycles for each product with one.
/// On other processors, where they are as fast as any number, this does nothing; WebAssembly has no
/// such mode, and dropTiny takes its place.
class SubnormalsAreZero {
  public:
    SubnormalsAreZero(const SubnormalsAreZero&) = delete;
    SubnormalsAreZero& operator=(const SubnormalsAreZero&) = delete;
#ifdef SPECTRAL_SUBNORMALS_ARE_SLOW
    SubnormalsAreZero() { _mm_setcsr(before_ | kFlushToZero | kDenormalsAreZero); }
    ~SubnormalsAreZero() { _mm_setcsr(before_); }

  private:
    static constexpr unsigned kFlushToZero = 1U << 15, kDenormalsAreZero = 1U << 6;
    const unsigned before_ = _mm_getcsr();
#else
    SubnormalsAreZero() {}
    ~SubnormalsAreZero() {}
#endif
};

/// Sets numbers to 0 whose products with each other are subnormal, where no mode does so.
inline void dropTiny([[maybe_unused]] double* numbers, [[maybe_unused]] std::ptrdiff_t count) {
#ifdef __wasm__
    constexpr double kTiny = 1e-150;  // the square is above the subnormals, 2.2e-308
    for (std::ptrdiff_t i = 0; i < count; ++i)
        if (std::abs(numbers[i]) < kTiny) numbers[i] = 0.0;
#endif
}

}  // namespace

}  // namespace spectral
