#pragma once

#include <QObject>
#include <QPointer>
#include <QWidget>

/// Postpones closing a project, or MeshLab, until the running filter has stopped.
///
/// MeshLab handles user input in the filter's callback. Closing the project there deletes it during
/// the run, and MeshLab 2025.07 crashes at the end of the run of any filter; closing MeshLab leaves
/// it computing without a window. Instead, the run is stopped (see isAsked), and then the window is
/// closed.
///
/// Does nothing without windows or on any thread but theirs, as in pymeshlab.
class LateClose : public QObject {
  public:
    LateClose();
    ~LateClose() override;

    /// Whether the user has tried to close a window during the run.
    bool isAsked() const { return !window_.isNull(); }

    bool eventFilter(QObject* object, QEvent* event) override;

  private:
    QPointer<QWidget> window_;  // to be closed after the run
};
