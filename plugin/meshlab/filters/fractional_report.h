#pragma once

#include <QVariant>
#include <map>
#include <string>
#include <vector>

#include "core/filter/fractional_filter.h"

/// The dictionary that pymeshlab returns.
std::map<std::string, QVariant> reportDictionary(const spectral::FilterResult& result);

/// The report as lines for MeshLab's log, most important facts first.
/// @param diagonal  bounding box diagonal of the input.
/// @param subject   starts the text; empty: the filter's type and feature size.
std::string fractionalReportText(const spectral::FilterOptions& options,
                                 const spectral::FilterResult& result, double diagonal,
                                 const std::string& subject = {});

/// What the user should act on: sentences, each with a remedy; empty if there is nothing.
/// @param diagonal  bounding box diagonal of the input.
std::vector<std::string> fractionalWarnings(const spectral::FilterOptions& options,
                                            const spectral::FilterResult& result, double diagonal);
