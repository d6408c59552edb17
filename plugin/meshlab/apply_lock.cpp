#include "apply_lock.h"

#include <QApplication>

#include "filter_dialog.h"

ApplyLock::ApplyLock() {
    const QWidget* dialog = openFilterDialog();
    if (dialog == nullptr) return;
    auto* button = dialog->findChild<QAbstractButton*>("applyPushButton");
    if (button == nullptr || !button->isEnabled()) return;  // the lock of a run around this one
    button_ = button;
    const bool hasKeys = button->hasFocus();
    button->setEnabled(false);
    if (hasKeys) focusAfter_ = QApplication::focusWidget();
}

ApplyLock::~ApplyLock() {
    if (button_.isNull()) return;
    button_->setEnabled(true);
    // The keys come back to the button, unless they were directed elsewhere meanwhile.
    if (!focusAfter_.isNull() && focusAfter_ == QApplication::focusWidget()) button_->setFocus();
}
