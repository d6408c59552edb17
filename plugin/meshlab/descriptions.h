#pragma once

#include <QtGlobal>

/// What the dialogs say about the filters and their parameters, for Python, which finds the
/// function by name in the plugin's library: pymeshlab passes neither help nor labels on.
///
/// @return  a JSON array in UTF-8, valid until the end of the process; of every filter `name`,
///          `python_name`, `menus`, `help` (HTML) and `parameters`; of every parameter `name`,
///          `label`, `type` (of the class, "RichInt"), `help` (HTML), `is_advanced` and `choices`.
extern "C" Q_DECL_EXPORT const char* meshlab_spectral_filters();
