#pragma once

#include <QAbstractButton>
#include <QPointer>
#include <QWidget>

/// Takes a preview back that was switched off while the filter ran: an object for one run.
///
/// In the filter's callback MeshLab handles its widgets. Who unticks Preview there sees the mesh as
/// it was, but MeshLab 2025.07 then leaves it with the result of the run that ends later, whatever
/// the filter. Its dialog is therefore told once more, after the run, that Preview is off. After an
/// Apply that changes nothing: the dialog has by then noted the result as the mesh without preview.
///
/// Does nothing where no dialog is open: in pymeshlab, for a filter script.
class LatePreview {
  public:
    LatePreview();
    ~LatePreview();
    LatePreview(const LatePreview&) = delete;
    LatePreview& operator=(const LatePreview&) = delete;

  private:
    QPointer<QWidget> dialog_;
    QPointer<QAbstractButton> box_;  // null unless it was ticked when the run began
};
