#pragma once

#include <QAbstractButton>
#include <QPointer>
#include <QWidget>

/// Reverts a preview that was switched off while the filter was running.
///
/// MeshLab handles user input in the filter's callback. Switching Preview off there restores the
/// mesh, but the run of any filter then ends with its result on the mesh, in MeshLab 2025.07.
/// Therefore the dialog is told again, after the run, that Preview is off. After Apply this changes
/// nothing: by then the dialog has recorded the result as the mesh without preview.
///
/// Does nothing without an open dialog, as in pymeshlab and for filter scripts.
class LatePreview {
  public:
    LatePreview();
    ~LatePreview();
    LatePreview(const LatePreview&) = delete;
    LatePreview& operator=(const LatePreview&) = delete;

  private:
    QPointer<QWidget> dialog_;
    QPointer<QAbstractButton> box_;  // null unless checked at the start of the run
};
