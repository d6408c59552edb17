#include <emscripten/heap.h>
#include <malloc.h>

#include "core/support/system_memory.h"

namespace spectral {

// A module may grow to its maximum, unless the browser refuses; what it has freed stays its own.
double availableSystemMemory() {
    const double left = static_cast<double>(emscripten_get_heap_max()) - residentMemory();
    return left + static_cast<double>(static_cast<unsigned>(mallinfo().fordblks));
}

double residentMemory() { return static_cast<double>(emscripten_get_heap_size()); }

}  // namespace spectral
