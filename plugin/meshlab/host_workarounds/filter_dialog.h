#pragma once

#include <QWidget>

/// The filter dialog open in MeshLab; null if there is none, as in pymeshlab and for filter
/// scripts, and on any thread other than that of the GUI.
QWidget* openFilterDialog();
