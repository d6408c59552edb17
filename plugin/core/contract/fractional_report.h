#pragma once

#include <string>
#include <vector>

#include "core/contract/report.h"
#include "core/filter/fractional_filter.h"

namespace spectral {

/// What filters of shapes report.
const Entries<FilterResult>& fractionalEntries();

/// The report as lines for a log.
/// @param diagonal  of the bounding box of the mesh, length units.
/// @param subject   what was done, in place of the filter type and the feature size.
/// @param deed      the first word; empty: by the type of filter.
std::string fractionalText(const FilterOptions& options, const FilterResult& result,
                           double diagonal, const std::string& subject = {},
                           const std::string& deed = {});

/// Shortcomings of a result, of the equalizer's, too, and what to choose instead.
Warnings fractionalWarnings(const FilterOptions& options, const FilterResult& result,
                            double diagonal);

}  // namespace spectral
