#pragma once

#include <nanobind/nanobind.h>

namespace spectral::python {

namespace nb = nanobind;

/// Adds what `formats` reads and patches files with: numbers in text, elements of XML.
void addTexts(nb::module_& module);

}  // namespace spectral::python
