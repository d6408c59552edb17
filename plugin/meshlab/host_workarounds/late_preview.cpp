#include "meshlab/host_workarounds/late_preview.h"

#include <QMetaObject>

#include "meshlab/host_workarounds/filter_dialog.h"

LatePreview::LatePreview() : dialog_(openFilterDialog()) {
    if (dialog_.isNull()) return;
    auto* box = dialog_->findChild<QAbstractButton*>("previewCheckBox");
    if (box != nullptr && box->isVisible() && box->isChecked()) box_ = box;
}

LatePreview::~LatePreview() {
    if (dialog_.isNull() || box_.isNull() || box_->isChecked()) return;
    // Queued: MeshLab has not yet recorded the result as the previewed mesh.
    QMetaObject::invokeMethod(dialog_, "on_previewCheckBox_stateChanged", Qt::QueuedConnection,
                              Q_ARG(int, Qt::Unchecked));
}
