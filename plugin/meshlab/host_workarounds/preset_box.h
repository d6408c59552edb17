#pragma once

#include <QStringList>
#include <QVariant>
#include <vector>

/// A value for each of several fields of a dialog: a flag, the number of a choice, a number, text.
struct FieldValues {
    QString name;  ///< As the box lists it.
    QVariantList values;
};

/// Puts a box above the parameters of the dialog that is about to open, whose choice fills the
/// fields: then a preview starts once, and a history has the values. Does nothing without windows.
///
/// @param labels   of the fields; an empty one: that value is not set.
/// @param presets  first the defaults, to which MeshLab's button *Default* switches back.
void addPresetBox(const QStringList& labels, const std::vector<FieldValues>& presets);
