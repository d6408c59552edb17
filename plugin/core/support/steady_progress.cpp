#include "core/support/steady_progress.h"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

namespace spectral {

namespace {

/// From one report to the next. MeshLab paints its window anew at most every 100 ms, and overlooks
/// a report that comes earlier: at this rate the next one is never far.
constexpr std::chrono::milliseconds kReportInterval{50};

/// What work on a thread of its own and the calling one tell each other.
class Exchange {
  public:
    explicit Exchange(const Progress& caller) : caller_(caller) {}

    /// For the work: notes how far it is.
    Progress progress() {
        const auto note = [this](double fraction, const std::string& stage) {
            const std::lock_guard<std::mutex> lock(mutex_);
            fraction_ = fraction;
            stage_ = stage;
            return !stop_;
        };
        return Progress(note, [this] { return caller_.isInterrupted(); });
    }

    /// For the work: it is done, by an exception or without.
    void end(std::exception_ptr failure) {
        const std::lock_guard<std::mutex> lock(mutex_);
        failure_ = std::move(failure);
        ended_ = true;
        changed_.notify_one();
    }

    /// For the caller: passes on what was noted, until the work is done.
    void reportUntilEnd() {
        std::unique_lock<std::mutex> lock(mutex_);
        while (!ended_) {
            const double fraction = fraction_;
            const std::string stage = stage_;
            lock.unlock();
            caller_.report(fraction, stage);
            lock.lock();
            changed_.wait_for(lock, kReportInterval, [this] { return ended_; });
        }
    }

    /// For the caller: the work is to end at its next report.
    void stop() {
        const std::lock_guard<std::mutex> lock(mutex_);
        stop_ = true;
    }

    /// For the caller, once the work is done.
    void rethrowFailure() const {
        if (failure_) std::rethrow_exception(failure_);
    }

  private:
    const Progress& caller_;
    std::mutex mutex_;  // guards the rest
    std::condition_variable changed_;
    double fraction_ = 0.0;
    std::string stage_ = "preparing";
    bool stop_ = false, ended_ = false;
    std::exception_ptr failure_;
};

}  // namespace

void runBeside(const Progress& progress, const std::function<void(const Progress&)>& work) {
    if (!progress.isHeard()) return work(progress);
    Exchange exchange(progress);
    std::thread thread;
    try {
        thread = std::thread([&] {
            try {
                work(exchange.progress());
                exchange.end(nullptr);
            } catch (...) {
                exchange.end(std::current_exception());
            }
        });
    } catch (const std::system_error&) {  // the system has no more threads
        return work(progress);
    }
    try {
        exchange.reportUntilEnd();
    } catch (...) {
        exchange.stop();
        thread.join();
        throw;
    }
    thread.join();
    exchange.rethrowFailure();
}

}  // namespace spectral
