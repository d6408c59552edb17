#pragma once

#include <QLayout>
#include <QString>
#include <QWidget>

// The rows of parameters in a dialog of MeshLab.

/// The row of a parameter: its label, and what stands beside it; null where there is no such thing.
struct DialogRow {
    QWidget* label = nullptr;
    QWidget* field = nullptr;   ///< A single field.
    QLayout* fields = nullptr;  ///< Several of them.
};

DialogRow rowOf(const QWidget* dialog, const QString& label);

/// The single field beside a label; null if there is none.
QWidget* fieldBeside(const QWidget* dialog, const QString& label);
