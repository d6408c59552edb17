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

/// Number of threads of new teams: as set, else one for each core.
int threadCount();

/// Sets threadCount().
/// @param count  >= 1; 0 for one thread for each core.
void setThreadCount(int count);

/// The threads that parallelFor uses when called from the thread that made the team, during the
/// team's lifetime: one run of a filter.
///
/// Between calls they spin before they sleep, because an evaluation makes thousands of calls of
/// some hundred microseconds each. A team made within another one has no threads of its own. The
/// last team's threads sleep until the next one, if of as many, takes them over.
class ThreadTeam {
  public:
    /// @param threads  including the calling one; fewer if the system has no more.
    explicit ThreadTeam(int threads = threadCount());
    /// A team whose work ends when the caller interrupts it, whatever it is at: parallelFor and
    /// stopPoint throw Cancelled.
    /// @param progress  kept by reference.
    explicit ThreadTeam(const Progress& progress) : ThreadTeam() { listenTo(progress); }
    ~ThreadTeam();
    ThreadTeam(const ThreadTeam&) = delete;
    ThreadTeam& operator=(const ThreadTeam&) = delete;

    /// A non-owning reference to a function of the task's number.
    struct TaskFunction {
        void (*call)(const void* function, Index task);
        const void* function;
    };
    /// See parallelFor.
    static void run(Index count, TaskFunction work);

    static int size();  ///< Threads of the calling thread's team, itself included; 1 without one.

    /// Number of the calling thread within its team; 0 for the one that made it, or without a team.
    static int threadIndex();

    /// For long loops without parallelFor.
    /// @throws Cancelled  when the calling thread's team is interrupted.
    static void stopPoint();

  private:
    void listenTo(const Progress& progress);
    class Implementation;
    static thread_local Implementation* current_;     // of the calling thread
    static std::atomic<Implementation*> idle_;        // the last one that had threads, or null
    std::unique_ptr<Implementation> implementation_;  // null within another team
};

/// Calls work(task) for 0 <= task < count, in any order, on the threads of the calling thread's
/// team; on the calling thread alone without a team, or within another parallelFor.
///
/// Results must not depend on the number of threads: each task writes to its own memory, and sums
/// over tasks are taken afterwards, in order.
/// @throws one of the tasks' exceptions, after all running tasks have ended; Cancelled.
template <class Work>
void parallelFor(Index count, const Work& work) {
    ThreadTeam::run(count, {[](const void* function, Index task) {
                                (*static_cast<const Work*>(function))(task);
                            },
                            &work});
}

/// Rows of one task: enough to be worth its overhead, few enough for the cache.
inline constexpr Index kRowsOfTask = 2048;

/// Calls work(begin, end) for blocks of kRowsOfTask rows out of `count`.
template <class Work>
void parallelRows(Index count, const Work& work) {
    parallelFor((count + kRowsOfTask - 1) / kRowsOfTask, [&](Index block) {
        const Index begin = block * kRowsOfTask;
        work(begin, std::min(count, begin + kRowsOfTask));
    });
}

/// Calls work(i) for 0 <= i < count, ascending, on the calling thread, with stop points.
template <class Work>
void forEachInOrder(Index count, const Work& work) {
    constexpr Index kBetweenStopPoints = Index{1} << 16;
    for (Index begin = 0; begin < count; begin += kBetweenStopPoints) {
        ThreadTeam::stopPoint();
        for (Index i = begin; i < std::min(count, begin + kBetweenStopPoints); ++i) work(i);
    }
}

/// The sum of work(begin, end) over the blocks of parallelRows, in order.
/// @param zero  initial value.
template <class Value, class Work>
Value parallelSum(Index count, Value zero, const Work& work) {
    std::vector<Value> parts(static_cast<std::size_t>((count + kRowsOfTask - 1) / kRowsOfTask),
                             zero);
    parallelRows(count, [&](Index begin, Index end) {
        parts[static_cast<std::size_t>(begin / kRowsOfTask)] = work(begin, end);
    });
    for (const Value& part : parts) zero += part;
    return zero;
}

/// The largest value of work(begin, end) over the blocks of parallelRows, at least 0.
template <class Work>
double parallelMax(Index count, const Work& work) {
    std::vector<double> largest(static_cast<std::size_t>(count / kRowsOfTask) + 1, 0.0);
    parallelRows(count, [&](Index begin, Index end) {
        largest[static_cast<std::size_t>(begin / kRowsOfTask)] = work(begin, end);
    });
    return std::max(0.0, *std::max_element(largest.begin(), largest.end()));
}

/// Throws when all tasks are to stop; to be called often within a long task.
using StopPoint = std::function<void()>;

/// parallelFor for long tasks: reports progress, and stops all tasks when the caller cancels or a
/// task throws.
///
/// Tasks start in ascending order. Only the calling thread reports, at its own stop points.
/// @param work   work(task, thread, stopPoint), 0 <= thread < ThreadTeam::size(): the thread is
///               for memory that is reused from task to task; results must not depend on it.
/// @param stage  for the report.
/// @throws the first exception of a task; Cancelled.
void runTasks(Index count, const std::function<void(Index, int, const StopPoint&)>& work,
              const Progress& progress, const std::string& stage);

}  // namespace spectral
