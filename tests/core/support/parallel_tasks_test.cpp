// Tasks on several threads, also where the system has few of them or none.

#include "core/support/parallel_tasks.h"

#include <gtest/gtest.h>

#include <numeric>
#include <string>
#include <vector>

#include "support/thread_shortage.h"

using namespace spectral;

namespace {

/// Sum of the squares of 0 to count - 1, in parallel.
Index sumOfSquares(Index count, const Progress& progress = {}) {
    std::vector<Index> squares(static_cast<std::size_t>(count));
    runInParallel(
        count,
        [&](Index task, int worker, const StopPoint& stopPoint) {
            EXPECT_LT(worker, workerCount());
            stopPoint();
            squares[static_cast<std::size_t>(task)] = task * task;
        },
        progress, "squaring");
    return std::accumulate(squares.begin(), squares.end(), Index{0});
}

constexpr Index kTasks = 100, kSum = 328350;

TEST(ParallelTasks, EveryTaskIsDoneOnce) { EXPECT_EQ(sumOfSquares(kTasks), kSum); }

TEST(ParallelTasks, NoTaskIsNothingToDo) { EXPECT_EQ(sumOfSquares(0), 0); }

TEST(ParallelTasks, TheThreadsThereAreDoAllTasks) {
    const spectral::testing::ThreadShortage oneThread(1);
    EXPECT_EQ(sumOfSquares(kTasks), kSum);
}

TEST(ParallelTasks, WithoutThreadsTheCallerDoesAllTasksAndReports) {
    const spectral::testing::ThreadShortage noThreads(0);
    Index reports = 0;
    const Progress counting([&](double, const std::string& stage) {
        EXPECT_EQ(stage, "squaring");
        return ++reports > 0;
    });
    EXPECT_EQ(sumOfSquares(kTasks, counting), kSum);
    EXPECT_GE(reports, kTasks);
}

TEST(ParallelTasks, WithoutThreadsTheCallerCanStop) {
    const spectral::testing::ThreadShortage noThreads(0);
    int reports = 0;
    const Progress stopping([&](double, const std::string&) { return ++reports < 10; });
    EXPECT_THROW(sumOfSquares(kTasks, stopping), Cancelled);
}

}  // namespace
