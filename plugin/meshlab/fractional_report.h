#pragma once

#include <QVariant>
#include <map>
#include <string>

#include "core/fractional_filter.h"

/// The report as the dictionary that pymeshlab returns.
std::map<std::string, QVariant> reportDictionary(const spectral::FilterResult& result);

/// The same as lines for MeshLab's log.
std::string reportText(const spectral::FilterResult& result);
