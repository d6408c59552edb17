#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "core/support/types.h"

namespace spectral {

/// Number of threads that the program computes with: what was set, else one for each core.
int threadCount();

/// Sets threadCount() for all that begins from now on.
/// @param count  >= 1; 0 for one thread for each core.
void setThreadCount(int count);

/// Threads for the calls of parallelFor that the thread which has made the team does, as long as
/// the team lives: for one run of a filter.
///
/// They wait between the calls, at first awake, because an evaluation makes thousands of them, of
/// some hundred microseconds each. A team within a team, or made by one of its threads, has no
/// threads of its own.
class ThreadTeam {
  public:
    /// @param threads  with the calling one; as many as the system gives.
    explicit ThreadTeam(int threads = threadCount());
    ~ThreadTeam();
    ThreadTeam(const ThreadTeam&) = delete;
    ThreadTeam& operator=(const ThreadTeam&) = delete;

    /// A function of a task's number, without a copy of it.
    struct TaskFunction {
        void (*call)(const void* function, Index task);
        const void* function;
    };
    /// What parallelFor does.
    static void run(Index count, TaskFunction work);

  private:
    class Implementation;
    static thread_local Implementation* current_;     // of the calling thread
    std::unique_ptr<Implementation> implementation_;  // null within another team
};

/// work(task) for all tasks from 0 to count - 1, on the threads of the calling thread's team, in no
/// order; on the calling thread alone where there is no team, or within another parallelFor.
///
/// Results must not depend on which thread does what, nor on how many there are: tasks write to
/// places of their own, and sums over tasks are made afterwards, in their order.
/// @throws one of the exceptions of tasks, after all tasks that were begun have ended.
template <class Work>
void parallelFor(Index count, const Work& work) {
    ThreadTeam::run(count, {[](const void* function, Index task) {
                                (*static_cast<const Work*>(function))(task);
                            },
                            &work});
}

/// Rows at a time: enough to be worth a task, few enough for the cache.
inline constexpr Index kRowsOfTask = 2048;

/// work(begin, end) for all rows from 0 to count - 1, in blocks of kRowsOfTask.
template <class Work>
void parallelRows(Index count, const Work& work) {
    parallelFor((count + kRowsOfTask - 1) / kRowsOfTask, [&](Index block) {
        const Index begin = block * kRowsOfTask;
        work(begin, std::min(count, begin + kRowsOfTask));
    });
}

/// The sum of work(begin, end) over the same blocks, in their order.
/// @param zero  what the sum begins with, of the type that `work` returns.
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

}  // namespace spectral
