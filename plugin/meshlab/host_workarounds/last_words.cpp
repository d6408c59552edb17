#include "meshlab/host_workarounds/last_words.h"

namespace {

// One for each thread: between a run and the question for its words others may run filters, too.
thread_local std::string lastWarnings, lastSummary;

}  // namespace

void keepLastWords(const std::string& summary, const std::vector<std::string>& warnings) {
    lastSummary = summary;
    lastWarnings.clear();
    for (const std::string& warning : warnings) lastWarnings += warning + '\n';
}

const char* meshlab_spectral_warnings() { return lastWarnings.c_str(); }

const char* meshlab_spectral_summary() { return lastSummary.c_str(); }
