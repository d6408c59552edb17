#pragma once

#include <nanobind/nanobind.h>

#include "core/contract/filter.h"

namespace spectral::python {

namespace nb = nanobind;

/// A length as users write it: value, unit ("", "%", "e"), and whether it is automatic.
/// @throws InvalidOption  when it is none.
nb::tuple parsedLength(const std::string& text);

/// Options as a filter takes them: choices by their names, lengths as from parsedLength.
/// @throws InvalidOption  for the first that is invalid.
nb::dict checkedOptions(const std::string& filter, const nb::dict& given);

/// All lengths of a filter in the units of a mesh; None: the filter measures it, or none is set.
/// @throws InvalidOption  for one out of all proportion to the mesh.
nb::dict sizesOf(const std::string& filter, const nb::dict& given, double diagonal, double meanEdge,
                 double surfaceDiagonal);

/// Values of parameters from a dict of bool, int, float and str.
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
