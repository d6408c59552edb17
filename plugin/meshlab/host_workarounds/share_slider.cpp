#include "meshlab/host_workarounds/share_slider.h"

#include <QGridLayout>
#include <QHBoxLayout>
#include <QLineEdit>
#include <QSignalBlocker>
#include <QSlider>
#include <cmath>

#include "meshlab/host_workarounds/filter_dialog.h"
#include "meshlab/host_workarounds/rows.h"

namespace {

constexpr int kWhole = 100;
constexpr int kWidth = 90;  // pixels

int percentOf(const QString& text) {
    return static_cast<int>(std::lround(kWhole * text.toDouble()));
}

void prepareShare(const QWidget* dialog, const QString& label) {
    auto* field = qobject_cast<QLineEdit*>(fieldBeside(dialog, label));
    if (field == nullptr) return;
    auto* slider = new QSlider(Qt::Horizontal, field);
    slider->setRange(1, kWhole);
    slider->setPageStep(kWhole / 10);
    slider->setAccessibleName(label);
    slider->setToolTip("1 to 100 %");
    slider->setValue(percentOf(field->text()));
    // Within the field, which keeps its place in MeshLab's grid.
    auto* inside = new QHBoxLayout(field);
    inside->setContentsMargins(0, 0, 0, 0);
    inside->addStretch(1);
    inside->addWidget(slider);
    slider->setFixedWidth(kWidth);
    field->setTextMargins(0, 0, kWidth, 0);
    QObject::connect(slider, &QSlider::valueChanged, field, [field](int percent) {
        if (percentOf(field->text()) == percent) return;
        field->setText(QString::number(static_cast<double>(percent) / kWhole));
        emit field->editingFinished();
    });
    // Not the signal's text: a preview runs within this signal, and the slider moves on meanwhile.
    QObject::connect(field, &QLineEdit::textChanged, slider, [slider, field] {
        const QSignalBlocker silence(slider);
        slider->setValue(percentOf(field->text()));
    });
}

}  // namespace

void addShareSlider(const QString& label) {
    whenDialogOpens([=](const QWidget* dialog) { prepareShare(dialog, label); });
}
