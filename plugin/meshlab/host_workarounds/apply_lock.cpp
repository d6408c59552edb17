#include "meshlab/host_workarounds/apply_lock.h"

#include <QApplication>

#include "meshlab/host_workarounds/filter_dialog.h"

ApplyLock::ApplyLock() {
    const QWidget* dialog = openFilterDialog();
    if (dialog == nullptr) return;
    auto* button = dialog->findChild<QAbstractButton*>("applyPushButton");
    if (button == nullptr || !button->isEnabled()) return;  // the lock of a run around this one
    button_ = button;
    const bool hasKeys = button->hasFocus();
    button->setEnabled(false);
    if (hasKeys) focusAfter_ = QApplication::focusWidget();
    button->installEventFilter(this);
}

ApplyLock::~ApplyLock() {
    if (button_.isNull()) return;
    button_->setEnabled(true);
    // The keys come back to the button, unless they were directed elsewhere meanwhile.
    if (!focusAfter_.isNull() && focusAfter_ == QApplication::focusWidget()) button_->setFocus();
    // Posted: the press of this click reaches the button only when MeshLab is done with the run.
    if (release_ != nullptr) QCoreApplication::postEvent(button_, release_.release());
}

bool ApplyLock::eventFilter(QObject*, QEvent* event) {
    const QEvent::Type type = event->type();
    if (type == QEvent::MouseButtonPress || type == QEvent::MouseButtonDblClick) isPressed_ = true;
    if (type == QEvent::MouseButtonRelease && !isPressed_)
        release_ = std::make_unique<QMouseEvent>(*static_cast<QMouseEvent*>(event));
    return false;
}
