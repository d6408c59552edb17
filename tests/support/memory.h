#pragma once

namespace spectral::testing {

/// The most memory that this program has had, resident, in MB; ru_maxrss would begin with that of
/// the one that started it. 0 where the system does not tell.
double peakMegabytes();

}  // namespace spectral::testing
