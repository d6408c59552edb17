#include "meshlab/host_workarounds/apply_lock.h"

#include <QApplication>

#include "meshlab/host_workarounds/filter_dialog.h"

ApplyLock::ApplyLock() {
    const QWidget* dialog = openFilterDialog();
    if (dialog == nullptr) return;
    auto* button = dialog->findChild<QAbstractButton*>("applyPushButton");
    if (button == nullptr || !button->isEnabled()) return;  // locked by an outer run
    button_ = button;
    const bool hadFocus = button->hasFocus();
    button->setEnabled(false);
    if (hadFocus) focusAfter_ = QApplication::focusWidget();
    button->installEventFilter(this);
}

ApplyLock::~ApplyLock() {
    if (button_.isNull()) return;
    button_->setEnabled(true);
    // The focus returns to the button unless the user has moved it in the meantime.
    if (!focusAfter_.isNull() && focusAfter_ == QApplication::focusWidget()) button_->setFocus();
    // Posted: the button receives the press of this click only after the run.
    if (release_ != nullptr) QCoreApplication::postEvent(button_, release_.release());
}

bool ApplyLock::eventFilter(QObject*, QEvent* event) {
    const QEvent::Type type = event->type();
    if (type == QEvent::MouseButtonPress || type == QEvent::MouseButtonDblClick) isPressed_ = true;
    if (type == QEvent::MouseButtonRelease && !isPressed_)
        release_ = std::make_unique<QMouseEvent>(*static_cast<QMouseEvent*>(event));
    return false;
}
