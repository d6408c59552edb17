#pragma once

#include <QString>
#include <QStringList>

// MeshLab's dialogs read a text that is no number as 0, and 1,5 with a decimal comma as 0 or 15.

/// Lets the number fields of the dialog that is about to open take a comma for a point, and no
/// letters; does nothing without windows.
///
/// @param labels  of the fields without arrows; those with arrows are found without.
void checkNumberFields(const QStringList& labels);

/// The first field with one of these labels that holds no number, as `label: "text"`; empty if
/// there is none, or no dialog.
QString fieldWithoutNumber(const QStringList& labels, const QStringList& integers);
