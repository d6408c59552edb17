#pragma once

#include <QWidget>
#include <functional>

/// MeshLab's class of the dialogs of filters.
inline constexpr const char* kFilterDialog = "FilterDockDialog";

/// Whether the program has windows, and this is their thread; false in pymeshlab.
bool hasWindows();

/// The filter dialog open in MeshLab; null if there is none, as for filter scripts, and without
/// windows.
QWidget* openFilterDialog();

/// Calls `prepare` with the dialog that is about to open, once it has; never without windows.
void whenDialogOpens(std::function<void(QWidget* dialog)> prepare);
