// For systems without fork(): a crash ends the program, and nothing takes too long.
#include <cstdlib>
#include <new>

#include "fuzz/worker.h"

namespace spectral::fuzz {

void* sharedMemory(std::size_t size) {
    void* memory = std::calloc(size, 1);
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
}

void runInChildren(std::uint64_t begin, std::uint64_t end, double,
                   const std::function<bool(std::uint64_t)>& work,
                   const std::function<void(std::uint64_t, const std::string&)>&) {
    for (std::uint64_t i = begin; i < end && work(i); ++i) {
    }
}

}  // namespace spectral::fuzz
