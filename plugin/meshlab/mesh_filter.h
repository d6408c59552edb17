#pragma once

#include <common/plugins/interfaces/filter_plugin.h>

#include <QVariant>
#include <map>
#include <string>
#include <vector>

#include "core/support/progress.h"

/// What a filter reports.
struct FilterOutcome {
    /// Returned by pymeshlab. Only int, bool, double and Eigen::VectorXd reach Python, not strings
    /// or unsigned integers.
    std::map<std::string, QVariant> report;
    std::string text;  ///< The same as lines for MeshLab's log.
    std::vector<std::string>
        warnings{};         ///< What fell short without being an error; in the log too.
    std::string summary{};  ///< What was found and done in one line, if that needs words.
};

/// MeshFilter::changes of what moves vertices.
inline constexpr int kMovesVertices =
    MeshModel::MM_VERTCOORD | MeshModel::MM_VERTNORMAL | MeshModel::MM_FACENORMAL;

/// One filter of the plugin.
struct MeshFilter {
    QString name;        ///< In menus and filter scripts: unique, must never change.
    QString pythonName;  ///< The method of pymeshlab: unique, must never change.
    QString help;        ///< HTML for the dialog.
    FilterPlugin::FilterClass category = FilterPlugin::Other;
    int changes = MeshModel::MM_NONE;  ///< Mask of what the filter writes.

    /// The parameters of the dialog, with defaults.
    RichParameterList (*parameters)(const MeshModel& mesh) = nullptr;

    /// Computes, then writes into the mesh; throws only while the mesh is unchanged.
    /// @throws spectral::Error
    FilterOutcome (*apply)(const RichParameterList& parameters, MeshModel& mesh,
                           const spectral::Progress& progress) = nullptr;
};

// One function for each filter, and one file but for the two of signals.
MeshFilter fractionalMeshFilter();        ///< filter_fractional.cpp
MeshFilter denoiseMeshFilter();           ///< filter_denoise.cpp
MeshFilter equalizerMeshFilter();         ///< filter_equalizer.cpp
MeshFilter qualityMeshFilter();           ///< filter_signals.cpp
MeshFilter colorMeshFilter();             ///< filter_signals.cpp
MeshFilter artefactsMeshFilter();         ///< filter_artefacts.cpp
MeshFilter harmonicsMeshFilter();         ///< filter_harmonics.cpp
MeshFilter geometrySpectrumMeshFilter();  ///< filter_geometry_spectrum.cpp

/// All of them; their positions are MeshLab's ids. In filter_spectral.cpp.
std::vector<MeshFilter> allMeshFilters();
