#pragma once

namespace spectral::testing {

/// Peak resident memory of this process in MB, 0 where the system does not report it. (ru_maxrss
/// would start from the peak of the parent process.)
double peakMegabytes();

}  // namespace spectral::testing
