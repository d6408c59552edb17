#include "meshlab/host_workarounds/filter_dialog.h"

#include <QApplication>
#include <QThread>
#include <QTimer>
#include <utility>

bool hasWindows() {
    const auto* program = qobject_cast<QApplication*>(QCoreApplication::instance());
    return program != nullptr && program->thread() == QThread::currentThread();
}

QWidget* openFilterDialog() {
    if (!hasWindows()) return nullptr;
    // MeshLab hides closed dialogs instead of deleting them.
    for (QWidget* widget : QApplication::allWidgets())
        if (widget->inherits(kFilterDialog) && widget->isVisible()) return widget;
    return nullptr;
}

void whenDialogOpens(std::function<void(QWidget* dialog)> prepare) {
    if (!hasWindows()) return;
    QTimer::singleShot(0, qApp, [prepare = std::move(prepare)] {
        if (QWidget* dialog = openFilterDialog()) prepare(dialog);
    });
}
