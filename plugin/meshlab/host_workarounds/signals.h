#pragma once

#include <QtGlobal>

// A filter that Python has called keeps the interpreter waiting: its handler of Ctrl-C would run
// only once the filter is done.

/// Sets how to run the interpreter's handlers of signals, between two parts of a computation and in
/// the thread that has called the filter: PyGILState_Ensure, PyErr_CheckSignals, which is not 0
/// once a handler has raised an exception, and PyGILState_Release. Null: not at all.
extern "C" Q_DECL_EXPORT void meshlab_spectral_check_signals(int (*lock)(), int (*check)(),
                                                             void (*release)(int));

/// Whether a signal's handler asks for the end of the computation.
bool isInterruptedBySignal();
