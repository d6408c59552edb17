#include "meshlab/host_workarounds/rows.h"

#include <QGridLayout>
#include <QLabel>

namespace {

/// What MeshLab appends to the labels of lengths.
const char* const kOfLengths = " (abs and %)";

}  // namespace

DialogRow rowOf(const QWidget* dialog, const QString& label) {
    for (const QGridLayout* grid : dialog->findChildren<QGridLayout*>())
        for (int row = 0; row < grid->rowCount(); ++row) {
            const QLayoutItem* first = grid->itemAtPosition(row, 0);
            const QLayoutItem* second = grid->itemAtPosition(row, 1);
            if (first == nullptr || second == nullptr) continue;
            auto* text = qobject_cast<QLabel*>(const_cast<QLayoutItem*>(first)->widget());
            if (text == nullptr || (text->text() != label && text->text() != label + kOfLengths))
                continue;
            auto* item = const_cast<QLayoutItem*>(second);
            return {text, item->widget(), item->layout()};
        }
    return {};
}

QWidget* fieldBeside(const QWidget* dialog, const QString& label) {
    return rowOf(dialog, label).field;
}
