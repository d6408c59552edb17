#pragma once

/// Most resident memory that this process shall have, bytes; 0, the default: as much as there is.
void setMemoryLimit(double bytes);

/// Memory that this process may still take, bytes: what the system has free, what its control group
/// leaves, what the limit leaves. Infinite where the system does not tell (Linux, Windows
/// and macOS do).
double freeMemory();
