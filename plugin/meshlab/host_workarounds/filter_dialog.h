#pragma once

#include <QWidget>

/// The dialog of a filter that is open in MeshLab's window.
///
/// Null where there is none: in pymeshlab, for a filter script, on another thread than the
/// window's.
QWidget* openFilterDialog();
