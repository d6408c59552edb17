#pragma once

/// Has the dialog that is about to open fit on its screen; does nothing without windows.
///
/// MeshLab 2025.07 gives a filter's dialog the height of all its parameters: with large fonts, or
/// on small screens, Apply and Close are then out of reach. The parameters are in a scroll area.
void fitDialogOnScreen();
