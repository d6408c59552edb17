#include "meshlab/host_workarounds/fit_screen.h"

#include <QScreen>
#include <QTimer>
#include <algorithm>

#include "meshlab/host_workarounds/filter_dialog.h"

namespace {

void fit(QWidget* dialog) {
    const QRect room = dialog->screen()->availableGeometry();
    const QSize frame = dialog->frameGeometry().size() - dialog->size();
    const QSize size = dialog->size().boundedTo(room.size() - frame);
    if (size != dialog->size()) dialog->resize(size);
    const QSize taken = dialog->frameGeometry().size();
    const int right = room.right() + 1 - taken.width(), bottom = room.bottom() + 1 - taken.height();
    const QPoint corner(std::clamp(dialog->x(), room.left(), std::max(room.left(), right)),
                        std::clamp(dialog->y(), room.top(), std::max(room.top(), bottom)));
    if (corner != dialog->pos()) dialog->move(corner);
}

}  // namespace

void fitDialogOnScreen() {
    whenDialogOpens([](QWidget* dialog) {
        fit(dialog);
        // Again when the scroll area has found its width.
        QTimer::singleShot(0, dialog, [dialog] { fit(dialog); });
    });
}
