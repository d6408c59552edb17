#pragma once

#include <QString>

/// Puts a slider of 1 to 100 % beside the number field with this label of the dialog that is about
/// to open; does nothing without windows.
///
/// MeshLab's own parameters with a slider are clamped to its range without a word, also in scripts.
void addShareSlider(const QString& label);
