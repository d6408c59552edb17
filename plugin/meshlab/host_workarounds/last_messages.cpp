#include "meshlab/host_workarounds/last_messages.h"

namespace {

// One per thread: other threads may run filters before the messages are read.
thread_local std::string lastWarnings, lastSummary;

}  // namespace

void keepLastMessages(const std::string& summary, const std::vector<std::string>& warnings) {
    lastSummary = summary;
    lastWarnings.clear();
    for (const std::string& warning : warnings) lastWarnings += warning + '\n';
}

const char* meshlab_spectral_warnings() { return lastWarnings.c_str(); }

const char* meshlab_spectral_summary() { return lastSummary.c_str(); }
