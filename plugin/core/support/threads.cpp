#include "core/support/threads.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <new>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#ifndef _WIN32
#include <pthread.h>
#endif

namespace spectral {

namespace {

std::atomic<int> chosenThreads{0};  // 0: one per core

/// Time an idle thread spins before it sleeps: longer than the gaps between the calls of an
/// evaluation, too short for a user to notice a busy core.
constexpr std::chrono::microseconds kSpinTime{200};

/// Whether the calling thread is running a task, and its index in its team.
thread_local bool isInTask = false;
thread_local int indexInTeam = 0;

}  // namespace

int threadCount() {
    const int chosen = chosenThreads;
    if (chosen > 0) return chosen;
    return static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

void setThreadCount(int count) { chosenThreads = std::max(0, count); }

/// Tasks are claimed from one atomic number, the ticket: the numbers of the call and of the
/// unclaimed tasks. A thread that wakes up late finds none left, and nobody waits for it.
class ThreadTeam::Implementation {
  public:
    explicit Implementation(int threads) : requested_(threads) {
        try {
            for (int i = 1; i < threads; ++i)
                threads_.emplace_back([this, i] {
                    indexInTeam = i;
                    serve();
                });
        } catch (const std::system_error&) {  // a limit on threads: make do with fewer
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

    void listenTo(const Progress* progress) { progress_ = progress; }

    void stopPoint() const {
        if (progress_ != nullptr && progress_->isInterrupted()) throw Cancelled();
    }

    int requested() const { return requested_; }
    int size() const { return static_cast<int>(threads_.size()) + 1; }

    void run(Index count, TaskFunction work) {
        stopPoint();
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
    /// Tasks per stop point: tasks may take less than a microsecond, as those of small fronts do.
    static constexpr Index kTasksPerStopPoint = 32;

    static constexpr std::uint64_t kCall = std::uint64_t{1} << 32;
    static Index unclaimed(std::uint64_t ticket) { return static_cast<Index>(ticket % kCall); }

    /// Runs tasks of the current call as long as there are any; returns whether there was one.
    bool doTasks() {
        bool any = false;
        std::uint64_t ticket = ticket_;
        while (unclaimed(ticket) > 0) {
            if (!ticket_.compare_exchange_weak(ticket, ticket - 1)) continue;
            // The call cannot end before this task does: its function and counters stay valid.
            any = true;
            isInTask = true;
            try {
                if (unclaimed(ticket) % kTasksPerStopPoint == 0 && indexInTeam == 0) stopPoint();
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

    /// The main loop of a thread of the team.
    void serve() {
        auto last = std::chrono::steady_clock::now();
        while (!stop_) {
            if (doTasks()) {
                last = std::chrono::steady_clock::now();
            } else if (std::chrono::steady_clock::now() - last < kSpinTime) {
                std::this_thread::yield();
            } else {
                std::unique_lock<std::mutex> lock(mutex_);
                ++sleeping_;
                wakeUp_.wait(lock, [this] { return stop_ || unclaimed(ticket_) > 0; });
                --sleeping_;
            }
        }
    }

    const Progress* progress_ = nullptr;  // checked only by the thread that created the team
    const int requested_;                 // number of threads; the system may have provided fewer
    std::vector<std::thread> threads_;
    TaskFunction work_{};
    Index count_ = 0;
    std::atomic<std::uint64_t> ticket_{0};
    std::atomic<Index> done_{0};
    std::atomic<int> sleeping_{0};
    std::atomic<bool> failed_{false}, stop_{false};
    std::mutex mutex_;  // guards failure_ and the decision to sleep
    std::condition_variable wakeUp_;
    std::exception_ptr failure_;
};

thread_local ThreadTeam::Implementation* ThreadTeam::current_ = nullptr;

// Not deleted at exit: a library that is being unloaded cannot wait for threads.
std::atomic<ThreadTeam::Implementation*> ThreadTeam::idle_{nullptr};

ThreadTeam::ThreadTeam(int threads) {
    if (current_ != nullptr || isInTask) return;
#ifndef _WIN32  // a forked process inherits the team, but not its threads
    [[maybe_unused]] static const int atFork =
        pthread_atfork(nullptr, nullptr, [] { idle_ = nullptr; });
#endif
    if (threads > 1) implementation_.reset(idle_.exchange(nullptr));
    if (!implementation_ || implementation_->requested() != threads)
        implementation_ = std::make_unique<Implementation>(threads);
    current_ = implementation_.get();
}

ThreadTeam::~ThreadTeam() {
    if (!implementation_) return;
    current_ = nullptr;
    implementation_->listenTo(nullptr);
    if (implementation_->size() > 1)
        implementation_.reset(idle_.exchange(implementation_.release()));
}

void ThreadTeam::listenTo(const Progress& progress) {
    if (implementation_) implementation_->listenTo(&progress);
}

void ThreadTeam::stopPoint() {
    if (current_ != nullptr && !isInTask) current_->stopPoint();
}

void ThreadTeam::run(Index count, TaskFunction work) {
    if (current_ != nullptr && count > 1 && !isInTask) {
        current_->run(count, work);
        return;
    }
    for (Index task = 0; task < count; ++task) work.call(work.function, task);
}

int ThreadTeam::size() { return current_ != nullptr ? current_->size() : 1; }

int ThreadTeam::threadIndex() { return indexInTeam; }

void runTasks(Index count, const std::function<void(Index, int, const StopPoint&)>& work,
              const Progress& progress, const std::string& stage) {
    std::atomic<Index> finished{0};
    std::atomic<bool> stop{false};
    std::exception_ptr failure;  // exception of the task that set `stop`
    const StopPoint stopPoint = [&] {
        if (stop) throw Cancelled();
        if (ThreadTeam::threadIndex() == 0)
            progress.report(static_cast<double>(finished) / static_cast<double>(count), stage);
    };
    parallelFor(count, [&](Index task) {
        try {
            stopPoint();
            work(task, ThreadTeam::threadIndex(), stopPoint);
            ++finished;
        } catch (...) {
            if (!stop.exchange(true)) failure = std::current_exception();
        }
    });
    if (failure) std::rethrow_exception(failure);
}

}  // namespace spectral
