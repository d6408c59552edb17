#pragma once

#include <QAbstractButton>
#include <QPointer>
#include <QWidget>

/// Reverts a preview that was switched off while the filter was running.
///
/// MeshLab handles user input in the filter's callback. Switching Preview off there restores the
/// mesh, but in MeshLab 2025.07 the run of any filter still ends by writing its result. The dialog
/// is therefore told again, after the run, that Preview is off. After Apply this changes nothing:
/// by then the dialog has recorded the result as the mesh without preview.
///
/// Does nothing without an open dialog, i.e. in pymeshlab and for filter scripts.
class LatePreview {
  public:
    LatePreview();
    ~LatePreview();
    LatePreview(const LatePreview&) = delete;
    LatePreview& operator=(const LatePreview&) = delete;

    /// Whether Preview was on at the start of the run.
    bool isOn() const { return !box_.isNull(); }

  private:
    QPointer<QWidget> dialog_;
    QPointer<QAbstractButton> box_;  // null unless checked at the start of the run
};
