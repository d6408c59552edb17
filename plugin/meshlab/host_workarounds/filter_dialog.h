#pragma once

#include <QWidget>

/// The filter dialog that is open in MeshLab; null without one, as in pymeshlab and for filter
/// scripts, and on any thread but that of the GUI.
QWidget* openFilterDialog();
