#include "meshlab/host_workarounds/late_close.h"

#include <QApplication>
#include <QKeyEvent>
#include <QMainWindow>
#include <QMdiSubWindow>
#include <QMetaObject>

LateClose::LateClose() {
    if (hasWindows()) qApp->installEventFilter(this);
}

LateClose::~LateClose() {
    // Queued: MeshLab has not finished the run yet.
    if (!window_.isNull()) QMetaObject::invokeMethod(window_, "close", Qt::QueuedConnection);
}

bool LateClose::eventFilter(QObject* object, QEvent* event) {
    if (event->type() == QEvent::KeyPress &&
        static_cast<QKeyEvent*>(event)->key() == Qt::Key_Escape)
        isEscaped_ = true;
    if (event->type() != QEvent::Close) return false;
    if (qobject_cast<QMdiSubWindow*>(object) == nullptr &&
        qobject_cast<QMainWindow*>(object) == nullptr && !object->inherits(kFilterDialog))
        return false;
    window_ = static_cast<QWidget*>(object);
    event->ignore();
    return true;
}
