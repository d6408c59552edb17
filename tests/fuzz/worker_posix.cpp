#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <new>
#include <system_error>

#include "fuzz/worker.h"

namespace spectral::fuzz {

namespace {

using Clock = std::chrono::steady_clock;

double now() { return std::chrono::duration<double>(Clock::now().time_since_epoch()).count(); }

struct Present {
    std::atomic<std::uint64_t> index;
    std::atomic<double> since;
};

}  // namespace

void* sharedMemory(std::size_t size) {
    void* memory = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw std::bad_alloc();
    return memory;
}

void runInChildren(std::uint64_t begin, std::uint64_t end, double limit,
                   const std::function<bool(std::uint64_t)>& work,
                   const std::function<void(std::uint64_t, const std::string&)>& onDeath) {
    auto* present = new (sharedMemory(sizeof(Present))) Present;
    while (begin < end) {
        present->index = begin;
        present->since = now();
        std::fflush(nullptr);
        const pid_t child = fork();
        if (child < 0) throw std::system_error(errno, std::generic_category(), "fork");
        if (child == 0) {
            bool goesOn = true;
            for (std::uint64_t i = begin; i < end && goesOn; ++i) {
                present->index = i;
                present->since = now();
                goesOn = work(i);
            }
            std::fflush(nullptr);
            _exit(0);
        }
        int status = 0;
        bool isTooLong = false;
        while (waitpid(child, &status, WNOHANG) == 0) {
            isTooLong = now() - present->since > limit;
            if (isTooLong) {
                kill(child, SIGKILL);
                waitpid(child, &status, 0);
                break;
            }
            usleep(5000);
        }
        if (!isTooLong && WIFEXITED(status) && WEXITSTATUS(status) == 0) return;
        onDeath(present->index, isTooLong ? "takes too long"
                                : WIFSIGNALED(status)
                                    ? "signal " + std::to_string(WTERMSIG(status))
                                    : "exit " + std::to_string(WEXITSTATUS(status)));
        begin = present->index + 1;
    }
}

}  // namespace spectral::fuzz
