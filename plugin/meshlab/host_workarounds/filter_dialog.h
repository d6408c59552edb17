#pragma once

#include <QWidget>

/// MeshLab's class of the dialogs of filters.
inline constexpr const char* kFilterDialog = "FilterDockDialog";

/// The filter dialog open in MeshLab; null if there is none, as in pymeshlab and for filter
/// scripts, and on any thread other than that of the GUI.
QWidget* openFilterDialog();
