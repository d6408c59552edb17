// Work in the background while the caller keeps reporting, including systems without threads.

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

/// Work that runs until it is cancelled, and records that.
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

TEST(SteadyProgress, KeepsReportingWhileTheWorkIsSilent) {
    // The work waits, without reporting, for reports to the caller: without them, it would hang.
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

TEST(SteadyProgress, ReportsOnlyOnTheCallingThread) {
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
    runInBackground(progress.part(0.0, 1.0, "step 1: "), [&](const Progress& steady) {
        EXPECT_NE(std::this_thread::get_id(), caller);
        for (const char* stage : {"factorizing", "filtering"}) {
            steady.report(0.5, stage);
            std::unique_lock<std::mutex> lock(mutex);
            passedOn.wait(lock, [&] { return last == std::string("step 1: ") + stage; });
        }
    });
}

TEST(SteadyProgress, CancelsTheWorkAtItsNextReport) {
    const Progress stopping([](double, const std::string&) { return false; });
    std::atomic<bool> left{false};
    EXPECT_THROW(runInBackground(stopping, endlessWork(left)), Cancelled);
    EXPECT_TRUE(left);
}

TEST(SteadyProgress, InterruptsTheWorkBeforeTheCallbackReturns) {
    std::atomic<bool> left{false};
    // The callback returns only after the work has ended: without an interruption, it would hang.
    const Progress busy(
        [&](double, const std::string&) {
            while (!left) std::this_thread::yield();
            return true;
        },
        [] { return true; });
    EXPECT_THROW(runInBackground(busy, endlessWork(left)), Cancelled);
}

TEST(SteadyProgress, CancelsTheThreadsOfSilentWork) {
    const Progress progress([](double, const std::string&) { return false; });
    EXPECT_THROW(withSteadyProgress(progress,
                                    [&](const Progress& steady) {
                                        const ThreadTeam team(steady);
                                        while (true) parallelFor(2, [](Index) {});
                                        return 0;
                                    }),
                 Cancelled);
}

TEST(SteadyProgress, RethrowsAFailureOfTheWork) {
    const Progress progress([](double, const std::string&) { return true; });
    const auto fail = [](const Progress&) -> int { throw SolverFailure("broke down"); };
    EXPECT_THROW(withSteadyProgress(progress, fail), SolverFailure);
}

TEST(SteadyProgress, RunsTheWorkOnTheCallingThreadWithoutOthers) {
    if (!spectral::testing::ThreadShortage::kIsPossible) GTEST_SKIP() << "only with glibc";
    const spectral::testing::ThreadShortage noThreads(0);
    std::vector<std::string> stages;
    const Progress noting([&](double, const std::string& stage) {
        stages.push_back(stage);
        return true;
    });
    runInBackground(noting, [](const Progress& progress) { progress.report(0.5, "here"); });
    EXPECT_EQ(stages, std::vector<std::string>{"here"});
}

TEST(SteadyProgress, RunsTheWorkOnTheCallingThreadWithoutACallback) {
    std::thread::id worker;
    runInBackground({}, [&](const Progress&) { worker = std::this_thread::get_id(); });
    EXPECT_EQ(worker, std::this_thread::get_id());
}

}  // namespace
