#pragma once

#include <functional>
#include <optional>
#include <type_traits>
#include <utility>

#include "core/support/progress.h"

namespace spectral {

/// Does `work` beside the calling thread, which reports twenty times a second how far it is.
///
/// For a caller that must hear something all the time, whatever the work is at: a factorization of
/// a large mesh takes seconds, and nothing can report from within it. A window that is painted anew
/// only in its callback, as MeshLab's, stands still as long.
///
/// `work` gets a progress that notes what it is told, and is left by Cancelled once the caller
/// wants to stop: at its next report, or wherever its threads ask (ThreadTeam). Only the calling
/// thread calls the caller back. Where no thread can be had, or nobody is to be told, it does the
/// work itself.
///
/// @throws whatever `work` throws; Cancelled.
void runBeside(const Progress& progress, const std::function<void(const Progress&)>& work);

/// runBeside for a function that gives a value: work(arguments..., progress).
template <class Work, class... Arguments>
auto withSteadyProgress(const Progress& progress, const Work& work, const Arguments&... arguments) {
    std::optional<std::invoke_result_t<const Work&, const Arguments&..., const Progress&>> result;
    runBeside(progress,
              [&](const Progress& steady) { result.emplace(work(arguments..., steady)); });
    return *std::move(result);
}

}  // namespace spectral
