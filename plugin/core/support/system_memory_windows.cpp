#include <windows.h>
// Needs windows.h first.
#include <psapi.h>

#include <algorithm>
#include <limits>

#include "core/support/system_memory.h"

namespace spectral {

namespace {

constexpr double kUnknown = std::numeric_limits<double>::infinity();

}  // namespace

double availableSystemMemory() {
    MEMORYSTATUSEX status{};
    status.dwLength = sizeof status;
    if (!GlobalMemoryStatusEx(&status)) return kUnknown;
    // The second is what is left of the commit limit, which includes the page file.
    return static_cast<double>(std::min(status.ullAvailPhys, status.ullAvailPageFile));
}

double residentMemory() {
    PROCESS_MEMORY_COUNTERS counters{};
    if (!K32GetProcessMemoryInfo(GetCurrentProcess(), &counters, sizeof counters)) return kUnknown;
    return static_cast<double>(counters.WorkingSetSize);
}

}  // namespace spectral
