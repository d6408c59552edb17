#pragma once

#include <functional>
#include <string>

#include "core/support/progress.h"
#include "core/support/types.h"

namespace spectral {

/// Number of workers that runInParallel shares its tasks among: threadCount().
int workerCount();

/// Leaves a task, by an exception, when the others are to stop; to be called often.
using StopPoint = std::function<void()>;

/// Does tasks 0 to count - 1 on all cores, begun in this order.
///
/// What a task computes must not depend on the worker that does it: the result is then the same on
/// any machine. Only the calling thread reports progress, and it does nothing else: whatever the
/// others do, the caller can stop them at once. Where the system has fewer threads to give, those
/// do all the tasks, and where it has none the calling thread does.
///
/// @param work   work(task, worker, stopPoint), 0 <= worker < workerCount(): for storage that a
///               worker uses again from task to task.
/// @param stage  what progress says is being done.
/// @throws whatever a task throws first, after all others have stopped; Cancelled.
void runInParallel(Index count, const std::function<void(Index, int, const StopPoint&)>& work,
                   const Progress& progress, const std::string& stage);

}  // namespace spectral
