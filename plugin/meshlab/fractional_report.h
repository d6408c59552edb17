#pragma once

#include <QVariant>
#include <map>
#include <string>

#include "core/filter/fractional_filter.h"

/// The report as the dictionary that pymeshlab returns.
std::map<std::string, QVariant> reportDictionary(const spectral::FilterResult& result);

/// The same as lines for MeshLab's log; the first says what most users want to know.
/// @param diagonal  of the input's bounding box.
std::string reportText(const spectral::FilterOptions& options, const spectral::FilterResult& result,
                       double diagonal);
