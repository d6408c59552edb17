#include "core/support/threads.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>
#include <numeric>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#ifndef _WIN32
#include <sys/wait.h>
#include <unistd.h>
#endif

namespace spectral {
namespace {

/// Checks that calls with these numbers of tasks run each task once.
void expectEveryTaskOnce(const std::vector<Index>& counts) {
    for (const Index count : counts) {
        std::vector<std::atomic<int>> done(static_cast<std::size_t>(count));
        parallelFor(count, [&](Index task) { ++done[static_cast<std::size_t>(task)]; });
        for (const std::atomic<int>& times : done) ASSERT_EQ(times, 1);
    }
}

TEST(ThreadTeam, RunsEveryTaskOnce) {
    for (const int threads : {1, 2, 3, 8}) {
        const ThreadTeam team(threads);
        expectEveryTaskOnce({0, 1, 2, 5, 1000});
        expectEveryTaskOnce(std::vector<Index>(3000, 3));
    }
    expectEveryTaskOnce({0, 1, 7});
}

TEST(ThreadTeam, WakesUpAfterAPause) {
    const ThreadTeam team(3);
    for (int i = 0; i < 20; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        expectEveryTaskOnce({50});
    }
}

TEST(ThreadTeam, RethrowsAnExceptionAndRemainsUsable) {
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

TEST(ThreadTeam, RunsNestedCallsOnTheThreadOfTheTask) {
    const ThreadTeam team(2);
    std::atomic<int> sum{0};
    parallelFor(8, [&](Index) {
        const ThreadTeam inner(4);
        const std::thread::id thread = std::this_thread::get_id();
        parallelFor(5, [&](Index) { sum += thread == std::this_thread::get_id() ? 1 : 1000; });
    });
    EXPECT_EQ(sum, 40);
}

/// The threads of a new team of two: each runs one of two tasks that wait for each other.
std::set<std::thread::id> threadsOfTwo() {
    const ThreadTeam team(2);
    std::atomic<int> begun{0};
    std::array<std::thread::id, 2> threads;
    parallelFor(2, [&](Index task) {
        threads[static_cast<std::size_t>(task)] = std::this_thread::get_id();
        for (++begun; begun < 2;) std::this_thread::yield();
    });
    return {threads.begin(), threads.end()};
}

TEST(ThreadTeam, ReusesTheThreadsOfTheLastTeam) {
    const std::set<std::thread::id> threads = threadsOfTwo();
    {
        const ThreadTeam withoutThreads(1);
    }
    EXPECT_EQ(threadsOfTwo(), threads);
    {
        const ThreadTeam three(3);
    }
    EXPECT_EQ(threadsOfTwo().size(), 2U);
}

#ifndef _WIN32
TEST(ThreadTeam, HasItsOwnThreadsInAForkedProcess) {
    threadsOfTwo();
    const pid_t child = fork();
    if (child == 0) {
        alarm(20);  // ends it if it waits for threads it does not have
        _exit(threadsOfTwo().size() == 2 ? 0 : 1);
    }
    int status = -1;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
}
#endif

TEST(ThreadTeam, StopsWhenInterrupted) {
    std::atomic<bool> isInterrupted{false};
    const Progress progress([](double, const std::string&) { return true; },
                            [&] { return isInterrupted.load(); });
    {
        const ThreadTeam team(progress);
        parallelFor(100, [](Index) {});
        EXPECT_NO_THROW(ThreadTeam::stopPoint());
        std::atomic<int> done{0};
        EXPECT_THROW(parallelFor(1000000,
                                 [&](Index) {
                                     if (++done == 1000) isInterrupted = true;
                                 }),
                     Cancelled);
        EXPECT_LT(done, 1000000);
        EXPECT_THROW(ThreadTeam::stopPoint(), Cancelled);
    }
    const ThreadTeam next;  // reuses the same threads
    EXPECT_NO_THROW(parallelFor(100, [](Index) {}));
    EXPECT_NO_THROW(ThreadTeam::stopPoint());
}

TEST(ThreadTeam, ReturnsTheSameSumForAnyNumberOfThreads) {
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

TEST(ThreadCount, IsAsSetOrTheNumberOfCores) {
    setThreadCount(5);
    EXPECT_EQ(threadCount(), 5);
    setThreadCount(0);
    EXPECT_GE(threadCount(), 1);
}

}  // namespace
}  // namespace spectral
