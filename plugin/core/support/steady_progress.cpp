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

/// MeshLab repaints its window every 100 ms at most, and drops reports that come earlier.
constexpr std::chrono::milliseconds kReportInterval{50};

}  // namespace

void runBeside(const Progress& progress, const std::function<void(const Progress&)>& work) {
    if (!progress.isHeard()) return work(progress);
    std::mutex mutex;  // guards the next two
    double latestFraction = 0.0;
    std::string latestStage = "preparing";
    std::atomic<bool> stop{false};
    const Progress note(
        [&](double fraction, const std::string& stage) {
            const std::lock_guard<std::mutex> lock(mutex);
            latestFraction = fraction;
            latestStage = stage;
            return !stop;
        },
        [&] { return stop || progress.isInterrupted(); });

    // Not std::async: libc++'s waits for ever for a thread that it could not get.
    std::packaged_task<void()> task([&] { work(note); });
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
