#pragma once

#if defined(__SSE2__) || defined(_M_X64)
#define SPECTRAL_SUBNORMALS_ARE_SLOW
#include <xmmintrin.h>
#endif

namespace spectral {

namespace {  // compiled for several instruction sets

/// As long as there is one, this thread takes subnormal numbers, those below 2.2e-308, for 0.
///
/// Entries of L decay exponentially away from the diagonal, the faster the larger the shift is: in
/// large fronts many are subnormal, and x86 processors take a hundred cycles for each product of
/// one. Others take no longer than for any number; there this does nothing.
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
