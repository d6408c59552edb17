#include "errors.h"

#include <nanobind/nanobind.h>

#include <exception>

#include "core/contract/error_names.h"

namespace spectral::python {

namespace {

namespace nb = nanobind;

void translate(const std::exception_ptr& thrown, void*) {
    try {
        std::rethrow_exception(thrown);
    } catch (const Error& error) {
        const nb::object type =
            nb::module_::import_("meshlab_spectral.errors").attr(classOf(error));
        const nb::object instance = type(error.what());
        instance.attr("code") = nameOf(error.code());
        instance.attr("limit") = error.limit();
        PyErr_SetObject(type.ptr(), instance.ptr());
    }
}

}  // namespace

void translateErrors() { nb::register_exception_translator(translate); }

}  // namespace spectral::python
