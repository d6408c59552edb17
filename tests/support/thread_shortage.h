#pragma once

#include <cstdlib>

namespace spectral::testing {

/// During its lifetime, the system refuses every thread after the first `left` ones.
class ThreadShortage {
  public:
    /// Whether a program can replace the creation of threads on this system; otherwise this class
    /// does nothing.
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
