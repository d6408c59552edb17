#include "support/memory.h"

#include <fstream>
#include <string>

namespace spectral::testing {

double peakMegabytes() {
    std::ifstream status("/proc/self/status");
    std::string word;
    double kilobytes = 0.0;
    while (status >> word)
        if (word == "VmHWM:") status >> kilobytes;
    return kilobytes / 1024.0;
}

}  // namespace spectral::testing
