#include "core/support/steady_progress.h"

#include <atomic>
#include <chrono>
#include <future>
#include <mutex>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

namespace spectral {

namespace {

/// MeshLab repaints its window at most every 100 ms, and drops earlier reports.
constexpr std::chrono::milliseconds kReportInterval{50};

}  // namespace

void runInBackground(const Progress& progress, const std::function<void(const Progress&)>& work) {
    if (!progress.hasCallback()) return work(progress);
    std::mutex mutex;  // guards latestFraction and latestStage
    double latestFraction = 0.0;
    std::string latestStage = "preparing";
    std::atomic<bool> stop{false};
    const Progress recorder(
        [&](double fraction, const std::string& stage) {
            const std::lock_guard<std::mutex> lock(mutex);
            latestFraction = fraction;
            latestStage = stage;
            return !stop;
        },
        [&] { return stop || progress.isInterrupted(); });

    // Not std::async: libc++'s hangs if it cannot start a thread.
    std::packaged_task<void()> task([&] { work(recorder); });
    std::future<void> done = task.get_future();
    std::thread worker;
    try {
        worker = std::thread(std::move(task));
    } catch (const std::system_error&) {  // the system has no more threads
        return work(progress);
    }
    try {
        do {
            std::unique_lock<std::mutex> lock(mutex);
            const double fraction = latestFraction;
            const std::string stage = latestStage;
            lock.unlock();
            progress.report(fraction, stage);
        } while (done.wait_for(kReportInterval) != std::future_status::ready);
    } catch (...) {
        stop = true;
        worker.join();
        throw;
    }
    worker.join();
    done.get();
}

}  // namespace spectral
