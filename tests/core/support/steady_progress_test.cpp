// Work beside a thread that goes on reporting, also where there is no thread for it.

#include "core/support/steady_progress.h"

#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "core/support/threads.h"
#include "support/thread_shortage.h"

using namespace spectral;

namespace {

/// Work that goes on until it is stopped, and notes that it has been left.
std::function<void(const Progress&)> endlessWork(std::atomic<bool>& left) {
    return [&left](const Progress& steady) {
        try {
            while (true) steady.report(0.5, "working");
        } catch (const Cancelled&) {
            left = true;
            throw;
        }
    };
}

TEST(SteadyProgress, ReportsGoOnWhileTheWorkIsSilent) {
    // The work waits, without a report, for what the caller hears meanwhile: without it, for ever.
    std::mutex mutex;
    std::condition_variable heard;
    int reports = 0;
    const Progress progress([&](double, const std::string&) {
        const std::lock_guard<std::mutex> lock(mutex);
        ++reports;
        heard.notify_one();
        return true;
    });
    const int result = withSteadyProgress(progress, [&](const Progress&) {
        std::unique_lock<std::mutex> lock(mutex);
        heard.wait(lock, [&] { return reports >= 5; });
        return 42;
    });
    EXPECT_EQ(result, 42);
}

TEST(SteadyProgress, OnlyTheCallerReportsWhatTheWorkHasTold) {
    std::mutex mutex;
    std::condition_variable passedOn;
    std::string last;
    const std::thread::id caller = std::this_thread::get_id();
    const Progress progress([&](double, const std::string& stage) {
        EXPECT_EQ(std::this_thread::get_id(), caller);
        const std::lock_guard<std::mutex> lock(mutex);
        last = stage;
        passedOn.notify_one();
        return true;
    });
    runBeside(progress.part(0.0, 1.0, "step 1: "), [&](const Progress& steady) {
        EXPECT_NE(std::this_thread::get_id(), caller);
        for (const char* stage : {"factorizing", "filtering"}) {
            steady.report(0.5, stage);
            std::unique_lock<std::mutex> lock(mutex);
            passedOn.wait(lock, [&] { return last == std::string("step 1: ") + stage; });
        }
    });
}

TEST(SteadyProgress, TheCallerStopsTheWorkAtItsNextReport) {
    const Progress stopping([](double, const std::string&) { return false; });
    std::atomic<bool> left{false};
    EXPECT_THROW(runBeside(stopping, endlessWork(left)), Cancelled);
    EXPECT_TRUE(left);
}

TEST(SteadyProgress, AnInterruptionStopsTheWorkWhileTheCallbackHasNotReturned) {
    std::atomic<bool> left{false};
    // The callback returns only when the work has been left: without an interruption, never.
    const Progress busy(
        [&](double, const std::string&) {
            while (!left) std::this_thread::yield();
            return true;
        },
        [] { return true; });
    EXPECT_THROW(runBeside(busy, endlessWork(left)), Cancelled);
}

TEST(SteadyProgress, TheCallerStopsTheThreadsOfWorkThatReportsNothing) {
    const Progress progress([](double, const std::string&) { return false; });
    EXPECT_THROW(withSteadyProgress(progress,
                                    [&](const Progress& steady) {
                                        const ThreadTeam team(steady);
                                        while (true) parallelFor(2, [](Index) {});
                                        return 0;
                                    }),
                 Cancelled);
}

TEST(SteadyProgress, AFailureOfTheWorkReachesTheCaller) {
    const Progress progress([](double, const std::string&) { return true; });
    const auto fail = [](const Progress&) -> int { throw SolverFailure("broke down"); };
    EXPECT_THROW(withSteadyProgress(progress, fail), SolverFailure);
}

TEST(SteadyProgress, WithoutThreadsTheCallerDoesTheWork) {
    if (!spectral::testing::ThreadShortage::kIsPossible) GTEST_SKIP() << "only with glibc";
    const spectral::testing::ThreadShortage noThreads(0);
    std::vector<std::string> stages;
    const Progress noting([&](double, const std::string& stage) {
        stages.push_back(stage);
        return true;
    });
    runBeside(noting, [](const Progress& progress) { progress.report(0.5, "here"); });
    EXPECT_EQ(stages, std::vector<std::string>{"here"});
}

TEST(SteadyProgress, WithNobodyToTellTheCallerDoesTheWork) {
    std::thread::id worker;
    runBeside({}, [&](const Progress&) { worker = std::this_thread::get_id(); });
    EXPECT_EQ(worker, std::this_thread::get_id());
}

}  // namespace
