#pragma once

namespace spectral {

/// Memory available to this process, bytes; infinite if the system does not report it.
double availableSystemMemory();

/// Resident memory of this process, bytes; infinite if the system does not report it.
double residentMemory();

}  // namespace spectral
