#include "running.h"

#include <nanobind/stl/string.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace spectral::python {

namespace {

std::atomic<bool> isEnding{false};
std::atomic<int> runs{0};

void endRuns() {
    isEnding = true;
    const nb::gil_scoped_release released;
    while (runs > 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

}  // namespace

Progress progressOf(nb::handle callback) {
    // A handle: the core copies the function without the GIL. Only the thread that called reports
    // (steady_progress.h).
    return Progress([callback](double fraction, const std::string& stage) {
        if (isEnding) return false;
        const nb::gil_scoped_acquire gil;
        if (PyErr_CheckSignals() != 0) throw nb::python_error();
        return callback.is_none() || !callback(stage, fraction).is(nb::handle(Py_False));
    });
}

Running::Running() { ++runs; }
Running::~Running() { --runs; }

void endRunsAtExit() { nb::module_::import_("atexit").attr("register")(nb::cpp_function(endRuns)); }

}  // namespace spectral::python
