#pragma once

#include <common/plugins/interfaces/filter_plugin.h>

#include <QVariant>
#include <map>
#include <string>
#include <vector>

#include "core/support/progress.h"

/// What a filter tells after its work.
struct FilterOutcome {
    /// What pymeshlab returns. Only int, bool, double and Eigen::VectorXd: other types (strings,
    /// unsigned) do not reach Python.
    std::map<std::string, QVariant> report;
    std::string text;                     ///< The same as lines for MeshLab's log.
    std::vector<std::string> warnings{};  ///< What fell short without being an error; sentences.
};

/// One filter of the plugin, as the plugin's class needs it.
struct MeshFilter {
    QString name;        ///< In MeshLab's menus and in filter scripts: unique, never changed.
    QString pythonName;  ///< Of the method in pymeshlab: unique, never changed.
    QString help;        ///< The HTML that the dialog shows.
    FilterPlugin::FilterClass category = FilterPlugin::Other;
    int changes = MeshModel::MM_NONE;  ///< Mask of what the filter writes.

    /// The dialog's parameters with their defaults.
    RichParameterList (*parameters)(const MeshModel& mesh) = nullptr;

    /// Computes, then writes into the mesh: it may throw only while the mesh is as it was.
    /// @throws spectral::Error  saying what is wrong and what to do.
    FilterOutcome (*apply)(const RichParameterList& parameters, MeshModel& mesh,
                           const spectral::Progress& progress) = nullptr;
};

// One function for each filter, in a file of its own.
MeshFilter fractionalMeshFilter();        ///< filter_fractional.cpp
MeshFilter artefactsMeshFilter();         ///< filter_artefacts.cpp
MeshFilter harmonicsMeshFilter();         ///< filter_harmonics.cpp
MeshFilter geometrySpectrumMeshFilter();  ///< filter_geometry_spectrum.cpp
