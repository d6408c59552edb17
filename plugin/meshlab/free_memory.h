#pragma once

/// Limits the resident memory of this process, bytes; 0 (the default): no limit.
void setMemoryLimit(double bytes);

/// Memory that this process may still allocate, bytes: the minimum of what the system, its control
/// group and the limit leave. Infinite if unknown: on other systems than Linux, Windows and macOS.
double freeMemory();
