#pragma once

#include <common/ml_document/mesh_document.h>
#include <common/parameters/rich_parameter_list.h>

#include <QStringList>

#include "core/contract/filter.h"

// Filters as MeshLab's dialogs show them, and what was chosen in one.

/// Plain text with *words* that stand out, |parameters| and [links](https://...) as HTML.
QString asHtml(const std::string& text);

/// The text above the parameters, HTML.
QString helpOf(const spectral::Filter& filter);

/// The parameters, with defaults for a mesh.
/// @param lengths        of the mesh.
/// @param movesVertices  whether the filter does: then the mesh can be kept as it was, in a layer,
///                       and show how far its vertices have moved.
RichParameterList parametersOf(const spectral::Filter& filter, const MeshModel& mesh,
                               const spectral::MeshLengths& lengths, bool movesVertices);

/// Whether the mesh shall be kept as it was.
bool isOriginalKept(const RichParameterList& parameters);

/// Whether the vertices shall be coloured by how far they move.
bool isColoredByDisplacement(const RichParameterList& parameters);

/// Corrects what MeshLab writes into its history after a call for which the box was switched off
/// (apply_anew.h): that the mesh was kept as it was.
void recordOriginalKept(MeshDocument& document);

/// Adapts the dialog that is about to open to what MeshLab's widgets do not offer.
///
/// @param mesh  lengths of the mesh that the dialog opens for.
void adaptDialog(const spectral::Filter& filter, const spectral::MeshLengths& mesh);

/// The values chosen in a dialog or script.
spectral::Values valuesOf(const spectral::Filter& filter, const RichParameterList& parameters);

/// Whether two choices of values differ in sliders alone.
bool differInSliders(const spectral::Filter& filter, const spectral::Values& one,
                     const spectral::Values& other);

/// Labels of the fields for numbers, without those that are sliders or percentages.
struct NumberLabels {
    QStringList all, integers;
};
NumberLabels numberLabels(const spectral::Filter& filter);
