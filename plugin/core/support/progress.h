#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "core/support/errors.h"

namespace spectral {

/// Reports the progress of a computation to the caller, and lets the caller cancel it.
///
/// A default-constructed object reports nothing and never cancels.
class Progress {
  public:
    /// Called with the fraction done, in [0, 1], and the current stage; returns false to cancel.
    using Callback = std::function<bool(double fraction, const std::string& stage)>;

    /// Returns true to cancel, even before the callback has returned: a window's callback may be
    /// busy with other input. Called from any thread.
    using Interruption = std::function<bool()>;

    Progress() = default;
    explicit Progress(Callback callback, Interruption interruption = {})
        : callback_(std::move(callback)), interruption_(std::move(interruption)) {}

    /// Whether there is a callback.
    bool hasCallback() const { return static_cast<bool>(callback_); }

    bool isInterrupted() const { return interruption_ && interruption_(); }

    /// Reports `fraction` in [0, 1] of this object's own range.
    /// @throws Cancelled  when the caller cancels.
    void report(double fraction, const std::string& stage) const {
        if (!callback_) return;
        const bool goOn = callback_(begin_ + (end_ - begin_) * fraction, prefix_ + stage);
        if (!goOn || isInterrupted()) throw Cancelled();
    }

    /// A progress that never goes back: what is done again, in another way, does not count.
    Progress forwards() const {
        if (!callback_) return *this;
        Progress steady(*this);
        steady.callback_ = [callback = callback_, furthest = std::make_shared<double>(0.0)](
                               double fraction, const std::string& stage) {
            *furthest = std::max(*furthest, fraction);
            return callback(*furthest, stage);
        };
        return steady;
    }

    /// A progress whose range [0, 1] maps to [begin, end] of this one; prepends `prefix` to stages.
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
