#pragma once

#include <common/plugins/interfaces/filter_plugin.h>

#include <QVariant>
#include <map>
#include <string>
#include <vector>

#include "core/support/progress.h"

/// What a filter reports.
struct FilterOutcome {
    /// Returned by pymeshlab. Only int, bool, double and Eigen::VectorXd reach Python; strings and
    /// unsigned integers do not.
    std::map<std::string, QVariant> report;
    std::string text;                     ///< The report as lines for MeshLab's log.
    std::vector<std::string> warnings{};  ///< Shortcomings that are not errors; also logged.
    std::string summary{};  ///< What was found and done, one line; empty if not needed.
};

/// MeshFilter::changes of filters that move vertices.
inline constexpr int kMovesVertices =
    MeshModel::MM_VERTCOORD | MeshModel::MM_VERTNORMAL | MeshModel::MM_FACENORMAL;

/// One filter of the plugin.
struct MeshFilter {
    QString name;        ///< In menus and filter scripts: unique, must never change.
    QString pythonName;  ///< Method name in pymeshlab: unique, must never change.
    QString help;        ///< HTML for the dialog.
    FilterPlugin::FilterClass category = FilterPlugin::Other;
    int changes = MeshModel::MM_NONE;  ///< Mask of what the filter writes.

    /// The parameters of the dialog, with defaults.
    RichParameterList (*parameters)(const MeshModel& mesh) = nullptr;

    /// Computes the result, then writes it to the mesh; throws only while the mesh is unchanged.
    /// @throws spectral::Error
    FilterOutcome (*apply)(const RichParameterList& parameters, MeshModel& mesh,
                           const spectral::Progress& progress) = nullptr;
};

// One function and one file per filter; the two signal filters share a file.
MeshFilter fractionalMeshFilter();        ///< filter_fractional.cpp
MeshFilter denoiseMeshFilter();           ///< filter_denoise.cpp
MeshFilter equalizerMeshFilter();         ///< filter_equalizer.cpp
MeshFilter qualityMeshFilter();           ///< filter_signals.cpp
MeshFilter colorMeshFilter();             ///< filter_signals.cpp
MeshFilter artefactsMeshFilter();         ///< filter_artefacts.cpp
MeshFilter harmonicsMeshFilter();         ///< filter_harmonics.cpp
MeshFilter geometrySpectrumMeshFilter();  ///< filter_geometry_spectrum.cpp

/// All filters; their positions are MeshLab's action ids. Defined in filter_spectral.cpp.
std::vector<MeshFilter> allMeshFilters();
