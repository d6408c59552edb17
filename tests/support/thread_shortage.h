#pragma once

#include <cstdlib>

namespace spectral::testing {

/// As long as it lives, the system refuses every thread after the first `left` of them.
class ThreadShortage {
  public:
    /// Whether a program can stand in front of the system's threads here; elsewhere this does
    /// nothing.
#ifdef __GLIBC__
    static constexpr bool kIsPossible = true;
#else
    static constexpr bool kIsPossible = false;
#endif

    explicit ThreadShortage(int left);
    ~ThreadShortage();
    ThreadShortage(const ThreadShortage&) = delete;
    ThreadShortage& operator=(const ThreadShortage&) = delete;
};

}  // namespace spectral::testing
