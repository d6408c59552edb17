#pragma once

/// Memory that the system has free for this process, bytes; infinite where it does not tell.
double availableSystemMemory();

/// Resident memory of this process, bytes; infinite where the system does not tell.
double residentMemory();
