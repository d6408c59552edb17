#pragma once

#include <QtGlobal>

/// Describes the filters and their parameters as the dialogs do, for Python, which looks the
/// function up by name in the plugin's library: pymeshlab provides neither help texts nor labels.
///
/// @return  a JSON array in UTF-8, valid until the process ends. Every filter has `name`,
///          `python_name`, `menus`, `help` (HTML) and `parameters`; every parameter has `name`,
///          `label`, `type` (its class, e.g. "RichInt"), `help` (HTML), `is_advanced`, `choices`.
extern "C" Q_DECL_EXPORT const char* meshlab_spectral_filters();
