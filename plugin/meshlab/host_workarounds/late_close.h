#pragma once

#include <QObject>
#include <QPointer>
#include <QWidget>

/// Puts the closing of a project, or of MeshLab, off until the filter has stopped: an object for
/// one run.
///
/// In the filter's callback MeshLab handles its windows. Who closes the project there deletes it
/// under the filter, and MeshLab 2025.07 crashes when the run ends, whatever the filter; and a
/// MeshLab that is closed computes on, unseen, to the end of the run. Here the window is closed
/// once the run is over, which is to stop for it.
///
/// Does nothing in a program without windows, and on another thread than theirs: in pymeshlab.
class LateClose : public QObject {
  public:
    LateClose();
    ~LateClose() override;

    /// Whether a window was to be closed since the run began.
    bool isAsked() const { return !window_.isNull(); }

    bool eventFilter(QObject* object, QEvent* event) override;

  private:
    QPointer<QWidget> window_;  // that was to be closed
};
