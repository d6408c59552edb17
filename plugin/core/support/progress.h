#pragma once

#include <functional>
#include <string>
#include <utility>

#include "core/support/errors.h"

namespace spectral {

/// Tells the caller how far a computation is, and lets the caller stop it.
///
/// A default-constructed object reports to nobody and never stops.
class Progress {
  public:
    /// Called with the part done, in [0, 1], and the present stage; returns false to stop.
    using Callback = std::function<bool(double fraction, const std::string& stage)>;

    /// Returns true to stop even while the callback has not returned: a window's callback may be
    /// busy with other work of its user. Called from any thread.
    using Interruption = std::function<bool()>;

    Progress() = default;
    explicit Progress(Callback callback, Interruption interruption = {})
        : callback_(std::move(callback)), interruption_(std::move(interruption)) {}

    /// Whether anybody listens.
    bool isHeard() const { return static_cast<bool>(callback_); }

    bool isInterrupted() const { return interruption_ && interruption_(); }

    /// Reports `fraction` in [0, 1] of this object's own range.
    /// @throws Cancelled  when the caller wants to stop.
    void report(double fraction, const std::string& stage) const {
        if (!callback_) return;
        const bool goOn = callback_(begin_ + (end_ - begin_) * fraction, prefix_ + stage);
        if (!goOn || isInterrupted()) throw Cancelled();
    }

    /// A progress whose [0, 1] is [begin, end] of this one; its stages get `prefix`.
    Progress part(double begin, double end, const std::string& prefix = {}) const {
        Progress sub(*this);
        sub.begin_ = begin_ + (end_ - begin_) * begin;
        sub.end_ = begin_ + (end_ - begin_) * end;
        sub.prefix_ = prefix_ + prefix;
        return sub;
    }

  private:
    Callback callback_;
    Interruption interruption_;
    double begin_ = 0.0, end_ = 1.0;
    std::string prefix_;
};

}  // namespace spectral
