#pragma once

#include <QAbstractButton>
#include <QMouseEvent>
#include <QObject>
#include <QPointer>
#include <QWidget>
#include <memory>

/// Disables Apply in the filter's dialog for the duration of a run.
///
/// MeshLab handles user input in the filter's callback. Pressing Apply there would start the filter
/// again within the first run: the mesh would be filtered once, but MeshLab 2025.07 would record
/// two runs and repeat both when the filter script is applied.
///
/// A click on Apply that itself started the run is not lost: clicking Apply after typing a value
/// takes the focus from the field, which starts a preview before the button receives the click. The
/// click is delivered after the preview.
///
/// Does nothing without an open dialog, i.e. in pymeshlab and for filter scripts.
class ApplyLock : public QObject {
  public:
    ApplyLock();
    ~ApplyLock() override;

    bool eventFilter(QObject* object, QEvent* event) override;

  private:
    QPointer<QAbstractButton> button_;      // null unless disabled by this object
    QPointer<QWidget> focusAfter_;          // next focus; null unless the button had it
    bool isPressed_ = false;                // whether a click began during the run
    std::unique_ptr<QMouseEvent> release_;  // ends a click that began before the run
};
