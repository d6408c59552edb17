#pragma once

#include <nanobind/nanobind.h>

#include "core/contract/filter.h"

namespace spectral::python {

namespace nb = nanobind;

/// Values of parameters from a dict of bool, int, float and str.
/// @throws InvalidOption  for a value of another type.
Values valuesOf(const nb::dict& given);

/// A list of (code, text).
nb::list listOf(const Warnings& warnings);

/// Numbers, flags and arrays by their names.
nb::dict dictOf(Values&& report);

/// Everything about all filters that hosts show: a list of dicts.
nb::list describedFilters();

/// All presets: a list of (name, python name of the filter, purpose, options).
nb::list describedPresets();

/// What each code of a warning means: a dict.
nb::dict describedWarnings();

}  // namespace spectral::python
