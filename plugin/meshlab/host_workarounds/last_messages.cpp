#include "meshlab/host_workarounds/last_messages.h"

#include <utility>

#include "core/contract/error_names.h"

namespace {

// One per thread: other threads may run filters before the messages are read.
thread_local std::string lastWarnings, lastSummary, lastError;

}  // namespace

void keepLastMessages(const std::string& summary, const spectral::Warnings& warnings) {
    lastSummary = summary;
    lastError.clear();
    lastWarnings.clear();
    for (const spectral::Warning& warning : warnings)
        lastWarnings += spectral::kindOf(warning.code).name + (' ' + warning.text) + '\n';
}

void keepLastError(const spectral::Error& error) {
    lastError = std::string(spectral::classOf(error)) + ' ' + spectral::nameOf(error.code()) + ' ' +
                std::to_string(error.limit());
}

const char* meshlab_spectral_warnings() { return lastWarnings.c_str(); }

const char* meshlab_spectral_summary() { return lastSummary.c_str(); }

const char* meshlab_spectral_error() {
    thread_local std::string read;
    read = std::exchange(lastError, {});
    return read.c_str();
}
