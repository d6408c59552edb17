// Long tasks on several threads, including systems that provide few or none.

#include <gtest/gtest.h>

#include <numeric>
#include <string>
#include <thread>
#include <vector>

#include "core/support/errors.h"
#include "core/support/threads.h"
#include "support/thread_shortage.h"

using namespace spectral;

namespace {

/// Sum of the squares of 0 to count - 1, in parallel.
Index sumOfSquares(Index count, const Progress& progress = {}) {
    std::vector<Index> squares(static_cast<std::size_t>(count));
    const int threads = ThreadTeam::size();
    runTasks(
        count,
        [&](Index task, int thread, const StopPoint& stopPoint) {
            EXPECT_LT(thread, threads);
            stopPoint();
            squares[static_cast<std::size_t>(task)] = task * task;
        },
        progress, "squaring");
    return std::accumulate(squares.begin(), squares.end(), Index{0});
}

constexpr Index kTasks = 100, kSum = 328350;

TEST(RunTasks, RunsEveryTaskOnce) {
    EXPECT_EQ(sumOfSquares(kTasks), kSum);
    const ThreadTeam team;
    EXPECT_EQ(sumOfSquares(kTasks), kSum);
    EXPECT_EQ(sumOfSquares(0), 0);
}

TEST(RunTasks, RunsAllTasksOnFewerThreads) {
    if (!spectral::testing::ThreadShortage::kIsPossible) GTEST_SKIP() << "only with glibc";
    for (const int threads : {0, 1}) {
        const spectral::testing::ThreadShortage shortage(threads);
        const ThreadTeam team(4);
        EXPECT_EQ(sumOfSquares(kTasks), kSum);
    }
}

TEST(RunTasks, ReportsOnlyOnTheCallingThread) {
    const ThreadTeam team(3);
    const std::thread::id caller = std::this_thread::get_id();
    const Progress progress([&](double fraction, const std::string& stage) {
        EXPECT_EQ(std::this_thread::get_id(), caller);
        EXPECT_EQ(stage, "squaring");
        EXPECT_LE(fraction, 1.0);
        return true;
    });
    EXPECT_EQ(sumOfSquares(kTasks, progress), kSum);
}

TEST(RunTasks, StopsAllTasksWhenTheCallerCancels) {
    const ThreadTeam team(2);
    const Progress stopping([](double, const std::string&) { return false; });
    // Endless tasks: without a stop, the test would hang.
    const auto work = [](Index, int, const StopPoint& stopPoint) {
        while (true) stopPoint();
    };
    EXPECT_THROW(runTasks(8, work, stopping, "working"), Cancelled);
}

TEST(RunTasks, StopsAllTasksAndRethrowsTheFirstFailure) {
    const ThreadTeam team(3);
    const auto work = [](Index task, int, const StopPoint& stopPoint) {
        if (task == 0) throw SolverFailure("broke down");
        while (true) stopPoint();
    };
    for (int i = 0; i < 50; ++i) EXPECT_THROW(runTasks(3, work, {}, "working"), SolverFailure);
}

}  // namespace
