#include "core/support/thread_team.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <thread>
#include <vector>

namespace spectral {
namespace {

/// How often each task was done, of calls with these numbers of tasks.
void expectEveryTaskOnce(const std::vector<Index>& counts) {
    for (const Index count : counts) {
        std::vector<std::atomic<int>> done(static_cast<std::size_t>(count));
        parallelFor(count, [&](Index task) { ++done[static_cast<std::size_t>(task)]; });
        for (const std::atomic<int>& times : done) ASSERT_EQ(times, 1);
    }
}

TEST(ThreadTeam, DoesEveryTaskOnce) {
    for (const int threads : {1, 2, 3, 8}) {
        const ThreadTeam team(threads);
        expectEveryTaskOnce({0, 1, 2, 5, 1000});
        expectEveryTaskOnce(std::vector<Index>(3000, 3));
    }
    expectEveryTaskOnce({0, 1, 7});
}

TEST(ThreadTeam, GoesOnAfterAPause) {
    const ThreadTeam team(3);
    for (int i = 0; i < 20; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        expectEveryTaskOnce({50});
    }
}

TEST(ThreadTeam, HandsOverAnExceptionAndStaysOfUse) {
    const ThreadTeam team(2);
    for (int i = 0; i < 100; ++i) {
        EXPECT_THROW(parallelFor(10,
                                 [](Index task) {
                                     if (task == 4) throw std::runtime_error("of a task");
                                 }),
                     std::runtime_error);
        expectEveryTaskOnce({10});
    }
}

TEST(ThreadTeam, DoesNestedCallsOnTheThreadOfTheTask) {
    const ThreadTeam team(2);
    std::atomic<int> sum{0};
    parallelFor(8, [&](Index) {
        const ThreadTeam inner(4);
        const std::thread::id thread = std::this_thread::get_id();
        parallelFor(5, [&](Index) { sum += thread == std::this_thread::get_id() ? 1 : 1000; });
    });
    EXPECT_EQ(sum, 40);
}

TEST(ThreadTeam, SumsAlikeForEveryNumberOfThreads) {
    const auto sum = [](int threads) {
        const ThreadTeam team(threads);
        return parallelSum(100000, 0.0, [](Index begin, Index end) {
            double part = 0.0;
            for (Index i = begin; i < end; ++i) part += std::sin(static_cast<double>(i));
            return part;
        });
    };
    EXPECT_EQ(sum(1), sum(2));
    EXPECT_EQ(sum(1), sum(5));
}

TEST(ThreadCount, IsWhatWasSetOrThatOfTheCores) {
    setThreadCount(5);
    EXPECT_EQ(threadCount(), 5);
    setThreadCount(0);
    EXPECT_GE(threadCount(), 1);
}

}  // namespace
}  // namespace spectral
