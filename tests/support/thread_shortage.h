#pragma once

namespace spectral::testing {

/// As long as it lives, the system refuses every thread after the first `left` of them.
class ThreadShortage {
  public:
    explicit ThreadShortage(int left);
    ~ThreadShortage();
    ThreadShortage(const ThreadShortage&) = delete;
    ThreadShortage& operator=(const ThreadShortage&) = delete;
};

}  // namespace spectral::testing
