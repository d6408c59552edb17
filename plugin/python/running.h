#pragma once

#include <nanobind/nanobind.h>

#include "core/support/progress.h"

namespace spectral::python {

namespace nb = nanobind;

/// Reports to callback(stage, fraction), which cancels by returning False; None: to nobody. What it
/// raises is passed on. Ctrl-C cancels in any case, and so does the end of the interpreter.
///
/// @param callback  referred to; it must outlive the result.
Progress progressOf(nb::handle callback);

/// A run without the GIL. The interpreter does not end while there is one; once it
/// ends, runs of other threads do not return to it.
class Running {
  public:
    Running();
    ~Running();
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;

  private:
    PyThreadState* state_;
};

/// Cancels all runs of other threads when the interpreter ends, which would end the process within
/// them, and waits until they have stopped.
void endRunsAtExit();

}  // namespace spectral::python
