#include "meshlab/host_workarounds/apply_anew.h"

#include <QAbstractButton>
#include <QApplication>
#include <QCheckBox>
#include <QPointer>
#include <QSignalBlocker>
#include <QTimer>

#include "meshlab/host_workarounds/filter_dialog.h"
#include "meshlab/host_workarounds/rows.h"

namespace {

bool applying = false, layerWanted = false;

/// Switches a box for the click that is about to be handled.
void switchFor(QCheckBox* box, bool value) {
    const bool before = box->isChecked();
    const auto set = [box = QPointer<QCheckBox>(box)](bool to) {
        if (box.isNull()) return;
        const QSignalBlocker silence(box);  // the dialog would start a preview
        box->setChecked(to);
    };
    set(value);
    QTimer::singleShot(0, box, [=] { set(before); });
}

void released(const QAbstractButton* preview, QCheckBox* accurate, QCheckBox* keep) {
    applying = true;
    layerWanted = keep != nullptr && keep->isChecked();
    QTimer::singleShot(0, qApp, [] { applying = layerWanted = false; });
    if (accurate != nullptr && !accurate->isChecked())
        switchFor(accurate, true);
    else if (layerWanted && preview->isVisible() && preview->isChecked())
        switchFor(keep, false);
}

void prepareApply(const QWidget* dialog, const QString& accurate, const QString& keep) {
    auto* apply = dialog->findChild<QAbstractButton*>("applyPushButton");
    auto* preview = dialog->findChild<QAbstractButton*>("previewCheckBox");
    if (apply == nullptr || preview == nullptr) return;
    auto* accurateBox = qobject_cast<QCheckBox*>(fieldBeside(dialog, accurate));
    auto* keepBox = qobject_cast<QCheckBox*>(fieldBeside(dialog, keep));
    QObject::connect(apply, &QAbstractButton::released, preview,
                     [=] { released(preview, accurateBox, keepBox); });
}

}  // namespace

void applyAnew(const QString& accurate, const QString& keep) {
    whenDialogOpens([=](const QWidget* dialog) { prepareApply(dialog, accurate, keep); });
}

bool isApplying() { return applying; }

bool isLayerWanted() { return layerWanted; }
