#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace spectral::fuzz {

/// Runs work(i) for begin <= i < end in a child process, and goes on in another one after a crash
/// or a call that takes too long.
///
/// @param limit   seconds for one call.
/// @param work    returns false to stop.
/// @param onDeath called in this process with i and what has happened.
void runInChildren(std::uint64_t begin, std::uint64_t end, double limit,
                   const std::function<bool(std::uint64_t)>& work,
                   const std::function<void(std::uint64_t, const std::string&)>& onDeath);

/// Memory that this process and its children share, zero at first; never freed.
void* sharedMemory(std::size_t size);

}  // namespace spectral::fuzz
