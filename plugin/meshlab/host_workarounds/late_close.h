#pragma once

#include <QObject>
#include <QPointer>
#include <QWidget>

/// Postpones closing a project, or MeshLab, until the running filter has stopped.
///
/// MeshLab handles user input in the filter's callback. Closing the project there deletes it during
/// the run, and MeshLab 2025.07 crashes when the run ends, whatever the filter; closing MeshLab
/// leaves it computing without a window. Instead, the run is stopped, then the window is closed.
///
/// Does nothing without windows, as in pymeshlab, or on any thread other than that of the GUI.
class LateClose : public QObject {
  public:
    LateClose();
    ~LateClose() override;

    /// Whether the user has tried to close a window during the run.
    bool isRequested() const { return !window_.isNull(); }

    bool eventFilter(QObject* object, QEvent* event) override;

  private:
    QPointer<QWidget> window_;  // to be closed after the run
};
