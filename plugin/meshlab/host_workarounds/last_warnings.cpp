#include "meshlab/host_workarounds/last_warnings.h"

namespace {

// One for each thread: between a run and the question for its warnings others may run filters, too.
thread_local std::string lastWarnings;

}  // namespace

void keepLastWarnings(const std::vector<std::string>& warnings) {
    lastWarnings.clear();
    for (const std::string& warning : warnings) lastWarnings += warning + '\n';
}

const char* meshlab_spectral_warnings() { return lastWarnings.c_str(); }
