#include "running.h"

#include <nanobind/stl/string.h>

#include <atomic>
#include <chrono>
#include <thread>

using namespace nanobind::literals;

namespace spectral::python {

namespace {

std::atomic<bool> isEnding{false};
std::atomic<int> runs{0};
std::thread::id endingThread;  // that of the interpreter's end, which still may run filters

/// Whether the interpreter ends, in another thread.
bool mustStop() { return isEnding && std::this_thread::get_id() != endingThread; }

/// Python ends a thread that asks an ending interpreter for the GIL, by an exception that C++
/// turns into the end of the process. So such a thread waits for that; it has the GIL until here.
[[noreturn]] void stay() {
    PyEval_SaveThread();
    --runs;
    for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

void endRuns() {
    endingThread = std::this_thread::get_id();
    isEnding = true;
    const nb::gil_scoped_release released;
    while (runs > 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

}  // namespace

Progress progressOf(nb::handle callback) {
    // A handle: the core copies the function without the GIL. Only the thread that called reports
    // (steady_progress.h).
    return Progress([callback](double fraction, const std::string& stage) {
        if (mustStop()) return false;
        const nb::gil_scoped_acquire gil;
        if (PyErr_CheckSignals() != 0) throw nb::python_error();
        return callback.is_none() || !callback(stage, fraction).is(nb::handle(Py_False));
    });
}

Running::Running() {
    ++runs;
    if (mustStop()) stay();
    state_ = PyEval_SaveThread();
}

Running::~Running() {
    PyEval_RestoreThread(state_);
    if (mustStop()) stay();
    --runs;
}

void endRunsAtExit() {
    nb::module_::import_("atexit").attr("register")(nb::cpp_function(endRuns));
    // A forked process has none of the threads that run, and would wait for them.
    const nb::module_ os = nb::module_::import_("os");
    if (nb::hasattr(os, "register_at_fork"))
        os.attr("register_at_fork")("after_in_child"_a = nb::cpp_function([] { runs = 0; }));
}

}  // namespace spectral::python
