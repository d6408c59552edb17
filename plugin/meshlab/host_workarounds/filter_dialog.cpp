#include "meshlab/host_workarounds/filter_dialog.h"

#include <QApplication>
#include <QThread>

QWidget* openFilterDialog() {
    const auto* program = qobject_cast<QApplication*>(QCoreApplication::instance());
    if (program == nullptr || program->thread() != QThread::currentThread()) return nullptr;
    // MeshLab hides closed dialogs instead of deleting them.
    for (QWidget* widget : QApplication::allWidgets())
        if (widget->inherits(kFilterDialog) && widget->isVisible()) return widget;
    return nullptr;
}
