#include "meshlab/host_workarounds/preset_box.h"

#include <QAbstractButton>
#include <QAbstractItemView>
#include <QBoxLayout>
#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QLineEdit>
#include <QSignalBlocker>
#include <QTimer>

#include "meshlab/host_workarounds/filter_dialog.h"
#include "meshlab/host_workarounds/rows.h"

namespace {

const char* const kLabel = "Start from";

/// The first field of a row: that of a length is the one in length units.
QWidget* fieldOf(const DialogRow& row) {
    for (int i = 0; row.fields != nullptr && i < row.fields->count(); ++i)
        if (QWidget* widget = row.fields->itemAt(i)->widget();
            qobject_cast<QDoubleSpinBox*>(widget) || qobject_cast<QLineEdit*>(widget))
            return widget;
    return row.field;
}

/// Sets a field as a user would: MeshLab listens to different signals of each kind, and copies
/// those fields into a call that have been changed.
void fill(QWidget* field, const QVariant& value) {
    if (auto* flag = qobject_cast<QCheckBox*>(field)) {
        flag->setChecked(value.toBool());
    } else if (auto* length = qobject_cast<QDoubleSpinBox*>(field)) {
        length->setValue(value.toDouble());
    } else if (auto* choice = qobject_cast<QComboBox*>(field)) {
        if (choice->currentIndex() == value.toInt()) return;
        choice->setCurrentIndex(value.toInt());
        emit choice->activated(value.toInt());
    } else if (auto* text = qobject_cast<QLineEdit*>(field)) {
        if (text->text() == value.toString()) return;
        text->setText(value.toString());
        emit text->editingFinished();
    }
}

void prepareBox(QWidget* dialog, const QStringList& labels,
                const std::vector<FieldValues>& presets) {
    auto* frame = dialog->findChild<QWidget*>("parameterFrame");
    auto* reset = dialog->findChild<QAbstractButton*>("defaultPushButton");
    auto* column = frame != nullptr && frame->parentWidget() != nullptr
                       ? qobject_cast<QBoxLayout*>(frame->parentWidget()->layout())
                       : nullptr;
    if (column == nullptr || reset == nullptr) return;
    // Now: labels change with the values.
    std::vector<QWidget*> fields;
    for (const QString& label : labels)
        fields.push_back(label.isEmpty() ? nullptr : fieldOf(rowOf(dialog, label)));
    auto* row = new QWidget(frame->parentWidget());
    auto* box = new QComboBox(row);
    for (const FieldValues& preset : presets) box->addItem(preset.name);
    box->setAccessibleName(kLabel);
    box->setToolTip("Fills the fields below with the options for a purpose; change them as needed");
    // Its list shows all of the text.
    box->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    box->setMinimumContentsLength(1);
    box->view()->setMinimumWidth(box->view()->sizeHintForColumn(0));
    auto* inside = new QHBoxLayout(row);
    inside->addWidget(new QLabel(kLabel, row));
    inside->addWidget(box, 1);
    column->insertWidget(0, row);
    if (auto* area = dialog->findChild<QWidget*>("scrollArea")) QWidget::setTabOrder(area, box);
    dialog->resize(dialog->width(), dialog->height() + row->sizeHint().height());
    QObject::connect(reset, &QAbstractButton::clicked, box, [box] { box->setCurrentIndex(0); });
    QObject::connect(box, QOverload<int>::of(&QComboBox::activated), frame, [=](int i) {
        const QVariantList& values = presets[static_cast<std::size_t>(i)].values;
        {
            const QSignalBlocker silence(frame);  // one preview, not one for each field
            for (int k = 0; k < values.size(); ++k)
                fill(fields[static_cast<std::size_t>(k)], values[k]);
        }
        QTimer::singleShot(0, frame,
                           [frame] { QMetaObject::invokeMethod(frame, "parameterChanged"); });
    });
}

}  // namespace

void addPresetBox(const QStringList& labels, const std::vector<FieldValues>& presets) {
    whenDialogOpens([=](QWidget* dialog) { prepareBox(dialog, labels, presets); });
}
