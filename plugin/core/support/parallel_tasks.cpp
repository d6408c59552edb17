#include "core/support/parallel_tasks.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>
#include <vector>

#include "core/support/errors.h"
#include "core/support/thread_team.h"

namespace spectral {

namespace {

/// From one report of progress to the next, at most.
constexpr std::chrono::milliseconds kReportInterval{100};

/// Up to `most` threads, each doing work(its number): as many as the system has.
std::vector<std::thread> startThreads(int most, const std::function<void(int)>& work) {
    std::vector<std::thread> threads;
    threads.reserve(static_cast<std::size_t>(most));
    try {
        for (int worker = 0; worker < most; ++worker) threads.emplace_back(work, worker);
    } catch (const std::system_error&) {  // a limit on threads
    } catch (const std::bad_alloc&) {
    }
    return threads;
}

/// All tasks on the calling thread, which reports at their stop points.
void runHere(Index count, const std::function<void(Index, int, const StopPoint&)>& work,
             const Progress& progress, const std::string& stage) {
    for (Index task = 0; task < count; ++task) {
        const StopPoint reportHere = [&] {
            progress.report(static_cast<double>(task) / static_cast<double>(count), stage);
        };
        reportHere();
        work(task, 0, reportHere);
    }
}

}  // namespace

int workerCount() { return threadCount(); }

void runInParallel(Index count, const std::function<void(Index, int, const StopPoint&)>& work,
                   const Progress& progress, const std::string& stage) {
    std::atomic<Index> next{0};
    std::atomic<bool> stop{false};
    std::exception_ptr failure;
    Index finished = 0;
    std::mutex mutex;  // guards failure and finished
    std::condition_variable changed;
    const StopPoint stopPoint = [&stop] {
        if (stop) throw Cancelled();
    };
    const auto doTasks = [&](int worker) {
        try {
            for (Index task; !stop && (task = next++) < count;) {
                work(task, worker, stopPoint);
                const std::lock_guard<std::mutex> lock(mutex);
                ++finished;
                changed.notify_one();
            }
        } catch (...) {
            const std::lock_guard<std::mutex> lock(mutex);
            if (!stop) failure = std::current_exception();
            stop = true;
            changed.notify_one();
        }
    };
    std::vector<std::thread> threads =
        startThreads(static_cast<int>(std::min<Index>(workerCount(), count)), doTasks);
    if (threads.empty()) return runHere(count, work, progress, stage);
    try {
        std::unique_lock<std::mutex> lock(mutex);
        while (finished < count && !stop) {
            const double done = static_cast<double>(finished) / static_cast<double>(count);
            lock.unlock();
            progress.report(done, stage);
            lock.lock();
            if (finished < count && !stop) changed.wait_for(lock, kReportInterval);
        }
    } catch (...) {
        const std::lock_guard<std::mutex> lock(mutex);
        failure = std::current_exception();
        stop = true;
    }
    for (std::thread& thread : threads) thread.join();
    if (failure) std::rethrow_exception(failure);
}

}  // namespace spectral
