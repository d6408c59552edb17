#include "late_preview.h"

#include <QApplication>
#include <QMetaObject>
#include <QThread>

namespace {

// MeshLab's own names.
constexpr char kDialog[] = "FilterDockDialog";
constexpr char kBox[] = "previewCheckBox";
constexpr char kBoxChanged[] = "on_previewCheckBox_stateChanged";

/// The filter's dialog that is open; null without one, or on a thread that must not ask.
QWidget* openDialog() {
    const auto* program = qobject_cast<QApplication*>(QCoreApplication::instance());
    if (program == nullptr || program->thread() != QThread::currentThread()) return nullptr;
    for (QWidget* widget : QApplication::allWidgets())
        if (widget->inherits(kDialog) && widget->isVisible()) return widget;
    return nullptr;
}

}  // namespace

LatePreview::LatePreview() : dialog_(openDialog()) {
    if (dialog_.isNull()) return;
    auto* box = dialog_->findChild<QAbstractButton*>(kBox);
    if (box != nullptr && box->isVisible() && box->isChecked()) box_ = box;
}

LatePreview::~LatePreview() {
    if (dialog_.isNull() || box_.isNull() || box_->isChecked()) return;
    // Queued: MeshLab has yet to note what the run has left as the mesh with this preview.
    QMetaObject::invokeMethod(dialog_, kBoxChanged, Qt::QueuedConnection,
                              Q_ARG(int, Qt::Unchecked));
}
