#include "meshlab/host_workarounds/signals.h"

namespace {

// Written before any filter runs.
int (*lockInterpreter)() = nullptr;
int (*checkSignals)() = nullptr;
void (*releaseInterpreter)(int) = nullptr;

}  // namespace

void meshlab_spectral_check_signals(int (*lock)(), int (*check)(), void (*release)(int)) {
    lockInterpreter = lock;
    checkSignals = check;
    releaseInterpreter = release;
}

bool isInterruptedBySignal() {
    if (checkSignals == nullptr) return false;
    const int state = lockInterpreter();
    const bool isInterrupted = checkSignals() != 0;
    releaseInterpreter(state);
    return isInterrupted;
}
