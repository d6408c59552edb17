#pragma once

#include <algorithm>
#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/support/progress.h"
#include "core/support/types.h"

namespace spectral {

/// Number of threads of new teams; by default one per core.
int threadCount();

/// Sets threadCount().
/// @param count  >= 1; 0 for one thread per core.
void setThreadCount(int count);

/// The threads used by parallelFor when called from the thread that created the team, during the
/// team's lifetime: one run of a filter.
///
/// Between calls threads spin before they sleep, because an evaluation makes thousands of calls of
/// a few hundred microseconds each. A team created within another one has no threads of its own.
/// The threads of the last team sleep until the next team of the same size takes them over.
class ThreadTeam {
  public:
    /// @param threads  number of threads, including the calling one; there may be fewer.
    explicit ThreadTeam(int threads = threadCount());
    /// A team the caller can interrupt at any time: parallelFor and stopPoint then throw Cancelled.
    /// @param progress  kept by reference.
    explicit ThreadTeam(const Progress& progress) : ThreadTeam(threadCount(), progress) {}
    ThreadTeam(int threads, const Progress& progress) : ThreadTeam(threads) { listenTo(progress); }
    ~ThreadTeam();
    ThreadTeam(const ThreadTeam&) = delete;
    ThreadTeam& operator=(const ThreadTeam&) = delete;

    /// A non-owning reference to a function of the task's index.
    struct TaskFunction {
        void (*call)(const void* function, Index task);
        const void* function;
    };
    /// See parallelFor.
    static void run(Index count, TaskFunction work);

    /// Number of threads of the calling thread's team, including itself; 1 without a team.
    static int size();

    /// Index of the calling thread in its team; 0 for the one that created it, or without one.
    static int threadIndex();

    /// Checks for an interruption, in long loops without parallelFor.
    /// @throws Cancelled  when the calling thread's team is interrupted.
    static void stopPoint();

  private:
    void listenTo(const Progress& progress);
    class Implementation;
    static thread_local Implementation* current_;     // team of the calling thread
    static std::atomic<Implementation*> idle_;        // last team with threads, or null
    std::unique_ptr<Implementation> implementation_;  // null within another team
};

/// Calls work(task) for 0 <= task < count, in any order, on the threads of the calling thread's
/// team. Without a team, or within another parallelFor, uses only the calling thread.
///
/// Results must not depend on the number of threads: each task writes to its own memory, and sums
/// over tasks are formed afterwards, in order.
/// @throws one of the tasks' exceptions, after all running tasks have ended; Cancelled.
template <class Work>
void parallelFor(Index count, const Work& work) {
    ThreadTeam::run(count, {[](const void* function, Index task) {
                                (*static_cast<const Work*>(function))(task);
                            },
                            &work});
}

/// Rows per task: enough to be worth the overhead, few enough for the cache.
inline constexpr Index kRowsPerTask = 2048;

/// Calls work(begin, end) for blocks of kRowsPerTask rows out of `count`.
template <class Work>
void parallelRows(Index count, const Work& work) {
    parallelFor((count + kRowsPerTask - 1) / kRowsPerTask, [&](Index block) {
        const Index begin = block * kRowsPerTask;
        work(begin, std::min(count, begin + kRowsPerTask));
    });
}

/// Calls work(i) for 0 <= i < count in ascending order, on the calling thread, with stop points.
template <class Work>
void forEachInOrder(Index count, const Work& work) {
    constexpr Index kStepsPerStopPoint = Index{1} << 16;
    for (Index begin = 0; begin < count; begin += kStepsPerStopPoint) {
        ThreadTeam::stopPoint();
        for (Index i = begin; i < std::min(count, begin + kStepsPerStopPoint); ++i) work(i);
    }
}

/// The sum of work(begin, end) over the blocks of parallelRows, in order.
/// @param zero  initial value.
template <class Value, class Work>
Value parallelSum(Index count, Value zero, const Work& work) {
    std::vector<Value> parts(static_cast<std::size_t>((count + kRowsPerTask - 1) / kRowsPerTask),
                             zero);
    parallelRows(count, [&](Index begin, Index end) {
        parts[static_cast<std::size_t>(begin / kRowsPerTask)] = work(begin, end);
    });
    for (const Value& part : parts) zero += part;
    return zero;
}

/// The largest value of work(begin, end) over the blocks of parallelRows, at least 0.
template <class Work>
double parallelMax(Index count, const Work& work) {
    std::vector<double> largest(static_cast<std::size_t>(count / kRowsPerTask) + 1, 0.0);
    parallelRows(count, [&](Index begin, Index end) {
        largest[static_cast<std::size_t>(begin / kRowsPerTask)] = work(begin, end);
    });
    return std::max(0.0, *std::max_element(largest.begin(), largest.end()));
}

/// Throws if all tasks must stop; long tasks should call it often.
using StopPoint = std::function<void()>;

/// parallelFor for long tasks: reports progress, and stops all tasks when the caller cancels or a
/// task throws.
///
/// Tasks start in ascending order. Only the calling thread reports, at its own stop points.
/// @param work   work(task, thread, stopPoint), 0 <= thread < ThreadTeam::size(): selects memory
///               that is reused by later tasks; results must not depend on it.
/// @param stage  name of the stage to report.
/// @throws the first exception of a task; Cancelled.
void runTasks(Index count, const std::function<void(Index, int, const StopPoint&)>& work,
              const Progress& progress, const std::string& stage);

}  // namespace spectral
