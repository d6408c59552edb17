#include "meshlab/host_workarounds/octave_sliders.h"

#include <QBoxLayout>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QLineEdit>
#include <QSignalBlocker>
#include <QSlider>
#include <algorithm>
#include <cmath>
#include <utility>

#include "meshlab/host_workarounds/filter_dialog.h"
#include "meshlab/host_workarounds/rows.h"

namespace {

constexpr int kPerOctave = 12, kEnd = 2 * kPerOctave;  // gains of a quarter to four
constexpr int kNothing = -kEnd - 1;                    // a gain of 0

QString gainAt(int position) {
    if (position <= kNothing) return "0";
    return QString::number(std::exp2(static_cast<double>(position) / kPerOctave), 'g', 4);
}

int positionOf(double gain) {
    if (!(gain > 0.0)) return kNothing;
    return std::clamp(static_cast<int>(std::lround(kPerOctave * std::log2(gain))), -kEnd, kEnd);
}

template <class Widget>
Widget* find(const QLayout* layout) {
    for (int i = 0; layout != nullptr && i < layout->count(); ++i)
        if (auto* widget = qobject_cast<Widget*>(layout->itemAt(i)->widget())) return widget;
    return nullptr;
}

/// Puts a slider in octaves in the place of MeshLab's.
void replace(QBoxLayout* layout, QSlider* linear, QLineEdit* field, const QString& label) {
    auto* slider = new QSlider(Qt::Horizontal, linear->parentWidget());
    slider->setRange(kNothing, kEnd);
    slider->setTickPosition(QSlider::TicksBelow);
    slider->setTickInterval(kPerOctave);
    slider->setPageStep(kPerOctave);
    slider->setSizePolicy(linear->sizePolicy());
    slider->setAccessibleName(label);
    slider->setToolTip("Middle: unchanged. Each tick doubles or halves; the left end removes.");
    slider->setValue(positionOf(field->text().toDouble()));
    layout->addWidget(slider);
    linear->hide();
    QObject::connect(slider, &QSlider::valueChanged, field, [field](int position) {
        if (positionOf(field->text().toDouble()) != position || position == kNothing)
            field->setText(gainAt(position));
    });
    // Not the signal's text: a preview runs within this signal, and the slider moves on meanwhile.
    QObject::connect(field, &QLineEdit::textChanged, slider, [slider, field] {
        const QSignalBlocker silence(slider);
        slider->setValue(positionOf(field->text().toDouble()));
    });
}

void prepareOctaves(const QWidget* dialog, const QStringList& labels, const QString& size,
                    const std::function<QString(int, double)>& text) {
    auto* length = find<QDoubleSpinBox>(rowOf(dialog, size).fields);
    for (int i = 0; i < labels.size(); ++i) {
        const DialogRow row = rowOf(dialog, labels[i]);
        auto* layout = qobject_cast<QBoxLayout*>(row.fields);
        auto* linear = find<QSlider>(layout);
        auto* field = find<QLineEdit>(layout);
        if (linear == nullptr || field == nullptr) continue;
        replace(layout, linear, field, labels[i]);
        auto* label = qobject_cast<QLabel*>(row.label);
        if (length == nullptr) continue;
        QObject::connect(length, QOverload<double>::of(&QDoubleSpinBox::valueChanged), label,
                         [=](double value) { label->setText(text(i, value)); });
    }
}

}  // namespace

void useOctaves(const QStringList& labels, const QString& size,
                std::function<QString(int i, double length)> text) {
    whenDialogOpens([=, text = std::move(text)](const QWidget* dialog) {
        prepareOctaves(dialog, labels, size, text);
    });
}
