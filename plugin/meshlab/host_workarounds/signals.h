#pragma once

#include <QtGlobal>

// A filter called from Python blocks the interpreter: Ctrl-C would be handled only after the run.

/// Sets the functions that run the interpreter's signal handlers, between parts of a computation
/// and in the thread that called the filter: PyGILState_Ensure, PyErr_CheckSignals (nonzero once a
/// handler has raised an exception) and PyGILState_Release. Null: handlers are not run.
extern "C" Q_DECL_EXPORT void meshlab_spectral_check_signals(int (*lock)(), int (*check)(),
                                                             void (*release)(int));

/// Whether a signal handler asks to stop the computation.
bool isInterruptedBySignal();
