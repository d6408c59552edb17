#pragma once

/// Has the dialog that is about to open end its preview when it is closed; does nothing without
/// windows.
///
/// MeshLab 2025.07 leaves the mesh of a preview in place, of any filter, when its dialog is closed
/// without Apply: the mesh is changed, and neither the history nor a saved script knows. Preview is
/// therefore switched off before the dialog closes, which restores the mesh as it was, or as Apply
/// has left it.
void endPreviewOnClose();
