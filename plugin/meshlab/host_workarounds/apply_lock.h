#pragma once

#include <QAbstractButton>
#include <QMouseEvent>
#include <QObject>
#include <QPointer>
#include <QWidget>
#include <memory>

/// Keeps Apply in the filter's dialog from being pressed while the filter runs: an object for one
/// run.
///
/// In the filter's callback MeshLab handles its widgets. Who presses Apply there a second time has
/// the filter begin anew on the same mesh, within its first run. The mesh would be filtered once,
/// but MeshLab 2025.07 would note two runs, and do both when the filter script is applied.
///
/// A click on Apply that has itself begun the run is not lost: who types a value and clicks Apply
/// leaves the field with it, which starts a preview before the button gets to know of the click. It
/// is then done after the preview.
///
/// Does nothing where no dialog is open: in pymeshlab, for a filter script.
class ApplyLock : public QObject {
  public:
    ApplyLock();
    ~ApplyLock() override;

    bool eventFilter(QObject* object, QEvent* event) override;

  private:
    QPointer<QAbstractButton> button_;  // null unless this object has locked it
    QPointer<QWidget> focusAfter_;      // where the keys went; null unless they were the button's
    bool isPressed_ = false;            // during the run
    std::unique_ptr<QMouseEvent> release_;  // of a click that began before the run
};
