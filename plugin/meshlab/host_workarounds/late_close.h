#pragma once

#include <QObject>
#include <QPointer>
#include <QWidget>

#include "meshlab/host_workarounds/filter_dialog.h"

/// Postpones closing a project, or MeshLab, until the running filter has stopped.
///
/// MeshLab handles user input in the filter's callback. Closing the project there deletes it during
/// the run, and MeshLab 2025.07 crashes when the run ends, whatever the filter; closing MeshLab
/// leaves it computing without a window; closing the dialog hides it, and the mesh changes later.
/// Instead, the run is stopped, then the window is closed. Esc stops the run alone.
///
/// Does nothing without windows, as in pymeshlab, or on any thread other than that of the GUI.
class LateClose : public QObject {
  public:
    LateClose();
    ~LateClose() override;

    /// Whether the user has tried to close a window, or pressed Esc, during the run.
    bool isRequested() const { return isEscaped_ || !window_.isNull(); }

    /// Whether the mesh goes with the window: then nobody reads a message.
    bool isMeshLeaving() const { return !window_.isNull() && !window_->inherits(kFilterDialog); }

    bool eventFilter(QObject* object, QEvent* event) override;

  private:
    QPointer<QWidget> window_;  // to be closed after the run
    bool isEscaped_ = false;
};
