#include "support/thread_shortage.h"

#ifdef __GLIBC__
#include <dlfcn.h>
#include <pthread.h>
#endif

#include <atomic>
#include <cerrno>
#include <limits>

namespace {

constexpr int kNoLimit = std::numeric_limits<int>::max();
std::atomic<int> threadsLeft{kNoLimit};

}  // namespace

#ifdef __GLIBC__
// Replaces the C library's in the whole program, including the C++ library's threads.
extern "C" __attribute__((visibility("default"))) int pthread_create(
    pthread_t* thread, const pthread_attr_t* attributes, void* (*start)(void*),
    void* argument) noexcept {
    static const auto create =
        reinterpret_cast<decltype(&pthread_create)>(dlsym(RTLD_NEXT, "pthread_create"));
    if (threadsLeft != kNoLimit && threadsLeft-- <= 0) return EAGAIN;
    return create(thread, attributes, start, argument);
}
#endif

namespace spectral::testing {

ThreadShortage::ThreadShortage(int left) { threadsLeft = left; }
ThreadShortage::~ThreadShortage() { threadsLeft = kNoLimit; }

}  // namespace spectral::testing
