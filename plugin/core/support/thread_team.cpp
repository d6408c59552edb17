#include "core/support/thread_team.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>
#include <utility>

namespace spectral {

namespace {

std::atomic<int> chosenThreads{0};  // 0: one for each core

/// Time that a thread stays awake for the next call: longer than the gaps between those of an
/// evaluation, shorter than what a user would notice of a core that is busy for nothing.
constexpr std::chrono::microseconds kAwake{200};

/// Whether the calling thread is within a task.
thread_local bool isInTask = false;

}  // namespace

int threadCount() {
    const int chosen = chosenThreads;
    if (chosen > 0) return chosen;
    return static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

void setThreadCount(int count) { chosenThreads = std::max(0, count); }

/// Tasks are claimed from one number, the ticket: that of the call, and of the tasks that nobody
/// has claimed. A thread that wakes up late finds none left, and nobody waits for it.
class ThreadTeam::Implementation {
  public:
    explicit Implementation(int threads) {
        try {
            for (int i = 1; i < threads; ++i) threads_.emplace_back([this] { serve(); });
        } catch (const std::system_error&) {  // a limit on threads: those that there are
        } catch (const std::bad_alloc&) {
        }
    }

    ~Implementation() {
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            stop_ = true;
        }
        wakeUp_.notify_all();
        for (std::thread& thread : threads_) thread.join();
    }

    void run(Index count, TaskFunction work) {
        work_ = work;
        count_ = count;
        done_ = 0;
        failed_ = false;
        ticket_ = (ticket_ / kCall + 1) * kCall + static_cast<std::uint64_t>(count);
        if (sleeping_ > 0) {
            const std::lock_guard<std::mutex> lock(mutex_);
            wakeUp_.notify_all();
        }
        doTasks();
        while (done_ < count) std::this_thread::yield();
        if (failed_) std::rethrow_exception(std::exchange(failure_, nullptr));
    }

  private:
    static constexpr std::uint64_t kCall = std::uint64_t{1} << 32;
    static Index unclaimed(std::uint64_t ticket) { return static_cast<Index>(ticket % kCall); }

    /// Does tasks of the present call as long as there are some; returns whether there was one.
    bool doTasks() {
        bool any = false;
        std::uint64_t ticket = ticket_;
        while (unclaimed(ticket) > 0) {
            if (!ticket_.compare_exchange_weak(ticket, ticket - 1)) continue;
            // The call cannot end before this task: what belongs to it stays as it is.
            any = true;
            isInTask = true;
            try {
                if (!failed_) work_.call(work_.function, count_ - unclaimed(ticket));
            } catch (...) {
                const std::lock_guard<std::mutex> lock(mutex_);
                if (!failed_) failure_ = std::current_exception();
                failed_ = true;
            }
            isInTask = false;
            ++done_;
            ticket = ticket_;
        }
        return any;
    }

    /// What a thread of the team does.
    void serve() {
        auto last = std::chrono::steady_clock::now();
        while (!stop_) {
            if (doTasks()) {
                last = std::chrono::steady_clock::now();
            } else if (std::chrono::steady_clock::now() - last < kAwake) {
                std::this_thread::yield();
            } else {
                std::unique_lock<std::mutex> lock(mutex_);
                ++sleeping_;
                wakeUp_.wait(lock, [this] { return stop_ || unclaimed(ticket_) > 0; });
                --sleeping_;
            }
        }
    }

    std::vector<std::thread> threads_;
    TaskFunction work_{};
    Index count_ = 0;
    std::atomic<std::uint64_t> ticket_{0};
    std::atomic<Index> done_{0};
    std::atomic<int> sleeping_{0};
    std::atomic<bool> failed_{false}, stop_{false};
    std::mutex mutex_;  // guards failure_, and the way to sleep
    std::condition_variable wakeUp_;
    std::exception_ptr failure_;
};

thread_local ThreadTeam::Implementation* ThreadTeam::current_ = nullptr;

ThreadTeam::ThreadTeam(int threads) {
    if (current_ != nullptr || isInTask) return;
    implementation_ = std::make_unique<Implementation>(threads);
    current_ = implementation_.get();
}

ThreadTeam::~ThreadTeam() {
    if (implementation_) current_ = nullptr;
}

void ThreadTeam::run(Index count, TaskFunction work) {
    if (current_ != nullptr && count > 1 && !isInTask) {
        current_->run(count, work);
        return;
    }
    for (Index task = 0; task < count; ++task) work.call(work.function, task);
}

}  // namespace spectral
