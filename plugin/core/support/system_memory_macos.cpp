#include <mach/mach.h>

#include <limits>

#include "core/support/system_memory.h"

namespace spectral {

namespace {

constexpr double kUnknown = std::numeric_limits<double>::infinity();

}  // namespace

double availableSystemMemory() {
    vm_statistics64_data_t statistics{};
    mach_msg_type_number_t count = HOST_VM_INFO64_COUNT;
    if (host_statistics64(mach_host_self(), HOST_VM_INFO64,
                          reinterpret_cast<host_info64_t>(&statistics), &count) != KERN_SUCCESS)
        return kUnknown;
    // Inactive pages are reclaimed when needed.
    const double pages = static_cast<double>(statistics.free_count) + statistics.inactive_count;
    return pages * static_cast<double>(vm_kernel_page_size);
}

double residentMemory() {
    mach_task_basic_info_data_t info{};
    mach_msg_type_number_t count = MACH_TASK_BASIC_INFO_COUNT;
    if (task_info(mach_task_self(), MACH_TASK_BASIC_INFO, reinterpret_cast<task_info_t>(&info),
                  &count) != KERN_SUCCESS)
        return kUnknown;
    return static_cast<double>(info.resident_size);
}

}  // namespace spectral
