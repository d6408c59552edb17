#include "meshlab/host_workarounds/closed_preview.h"

#include <QAbstractButton>
#include <QEvent>

#include "meshlab/host_workarounds/filter_dialog.h"

namespace {

/// Lives as long as the button of the preview that it switches off.
class EndOfPreview : public QObject {
  public:
    explicit EndOfPreview(QAbstractButton* box) : QObject(box), box_(box) {}

    bool eventFilter(QObject*, QEvent* event) override {
        if (event->type() == QEvent::Close && box_->isVisible()) box_->setChecked(false);
        return false;
    }

  private:
    QAbstractButton* const box_;
};

void prepareClose(QWidget* dialog) {
    auto* box = dialog->findChild<QAbstractButton*>("previewCheckBox");
    if (box == nullptr) return;
    box->setToolTip("Closing the dialog without Apply leaves the mesh as it was.");
    dialog->installEventFilter(new EndOfPreview(box));
}

}  // namespace

void endPreviewOnClose() { whenDialogOpens(prepareClose); }
