#pragma once

#include <QString>
#include <QStringList>
#include <functional>

/// Gives the sliders of the dialog that is about to open a scale in octaves, with 1 in the middle:
/// MeshLab's are linear, from 0 to 4 in hundredths. The field beside a slider still holds the gain;
/// the left end is 0. Does nothing without windows.
///
/// @param labels  of the sliders.
/// @param size    label of the field for the length that they depend on.
/// @param text    label of slider i at such a length.
void useOctaves(const QStringList& labels, const QString& size,
                std::function<QString(int i, double length)> text);
