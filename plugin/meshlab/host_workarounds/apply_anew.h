#pragma once

#include <QString>

// MeshLab 2025.07 takes over the mesh of a preview on Apply, without calling the filter, as long as
// no parameter has changed since. A filter whose preview is a draft, or which adds a layer on Apply
// alone, would not get to do so. So at the moment Apply is released, before MeshLab reads the
// parameters, a box is switched, and switched back at once; the filter is called with the switch.

/// Prepares the dialog that is about to open; does nothing without windows.
///
/// @param accurate  label of the box to tick for Apply; empty: there is none.
/// @param keep      label of the box that asks for a layer; it is read by isLayerWanted.
void applyAnew(const QString& accurate, const QString& keep);

/// Whether Apply has been released, and its click is still being handled.
bool isApplying();

/// Whether the box that asks for a layer was ticked when Apply was released.
bool isLayerWanted();
