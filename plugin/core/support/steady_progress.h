#pragma once

#include <functional>
#include <optional>
#include <type_traits>
#include <utility>

#include "core/support/progress.h"

namespace spectral {

/// Runs `work` on another thread, while the calling one reports progress twenty times a second.
///
/// For callers that need steady reports: factorizing a large mesh takes seconds and cannot report
/// from within, and a window repainted only in the callback, such as MeshLab's, would freeze.
///
/// The progress passed to `work` only records its reports. Once the caller cancels, it throws
/// Cancelled at the next report, or wherever the threads of `work` check (ThreadTeam). The callback
/// is called only on the calling thread. If no thread can be started, or there is no callback, the
/// calling thread does the work itself.
///
/// @throws whatever `work` throws; Cancelled.
void runInBackground(const Progress& progress, const std::function<void(const Progress&)>& work);

/// runInBackground for a function that returns a value: work(arguments..., progress).
template <class Work, class... Arguments>
auto withSteadyProgress(const Progress& progress, const Work& work, const Arguments&... arguments) {
    std::optional<std::invoke_result_t<const Work&, const Arguments&..., const Progress&>> result;
    runInBackground(progress,
                    [&](const Progress& steady) { result.emplace(work(arguments..., steady)); });
    return *std::move(result);
}

}  // namespace spectral
