#pragma once

#include <QAbstractButton>
#include <QPointer>
#include <QWidget>

/// Keeps Apply in the filter's dialog from being pressed while the filter runs: an object for one
/// run.
///
/// In the filter's callback MeshLab handles its widgets. Who presses Apply there a second time has
/// the filter begin anew on the same mesh, within its first run. The mesh would be filtered once,
/// but MeshLab 2025.07 would note two runs, and do both when the filter script is applied.
///
/// Does nothing where no dialog is open: in pymeshlab, for a filter script.
class ApplyLock {
  public:
    ApplyLock();
    ~ApplyLock();
    ApplyLock(const ApplyLock&) = delete;
    ApplyLock& operator=(const ApplyLock&) = delete;

  private:
    QPointer<QAbstractButton> button_;  // null unless this object has locked it
    QPointer<QWidget> focusAfter_;      // where the keys went; null unless they were the button's
};
