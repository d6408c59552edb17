#pragma once

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
/// On other processors, where they are as fast as any number, this does nothing.
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

}  // namespace

}  // namespace spectral
