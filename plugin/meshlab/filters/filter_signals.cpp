#include <common/mlexception.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <map>
#include <sstream>
#include <string>
#include <utility>

#include "core/filter/signal_filter.h"
#include "core/mesh/measures.h"
#include "core/support/steady_progress.h"
#include "meshlab/error_messages.h"
#include "meshlab/filters/common_parameters.h"
#include "meshlab/filters/surface_report.h"
#include "meshlab/filters/transfer_parameters.h"
#include "meshlab/mesh_conversion.h"
#include "meshlab/mesh_filter.h"

// The two filters of signals on a fixed shape: vertex quality and vertex colours.

namespace {

const char* const kQualityName = "Spectral Filter: Vertex Quality";
const char* const kColorName = "Spectral Filter: Vertex Color";

constexpr double kWhite = 255.0;

const char* const kQualityHelp =
    "Filters the <b>vertex quality</b>, i.e. any number per vertex, by the size of its details on "
    "the surface, as <i>Spectral Filter (Fractional)</i> filters shapes. The shape does not "
    "change; a quality of NaN means no data.";

const char* const kColorHelp =
    "Filters the <b>vertex colours</b> by the size of their details on the surface, as <i>Spectral "
    "Filter (Fractional)</i> filters shapes: removes noise from scanned colours, or sharpens a "
    "painting. The shape does not change.";

RichParameterList signalsParameters(const MeshModel& mesh) {
    RichParameterList list;
    addTransferParameters(mesh, list);
    list.addParam(selectedParameter(mesh));
    list.addParam(laplacianParameter());
    list.addParam(
        boundaryParameter("<b>free</b>: values there are filtered like the rest. <b>fixed</b>: "
                          "they are kept exactly, and the values in between are filtered."));
    return list;
}

spectral::SignalFilterOptions signalOptions(const RichParameterList& parameters,
                                            const MeshModel& mesh, const MeshMatrices& input) {
    spectral::SignalFilterOptions options;
    const ChosenTransfer transfer = chosenTransfer(parameters, input);
    options.transferFunction = transfer.options;
    options.featureSize = transfer.featureSize;
    options.laplacian = laplacianKind(parameters);
    options.boundary = boundaryCondition(parameters);
    options.part.selected = chosenVertices(parameters, mesh, input);
    return options;
}

std::vector<std::string> warningsOf(const std::vector<bool>& selected,
                                    const spectral::FilteredSignal& result) {
    std::vector<std::string> warnings = surfaceWarnings(result);
    if (const std::string note = selectionText(selected); !note.empty()) warnings.push_back(note);
    if (result.isConstant)
        warnings.emplace_back(
            "nothing to filter: the values are constant on every connected component. Apply a "
            "filter that computes qualities or colours first");
    else if (isAllFixed(result, result.Y.rows() - result.verticesWithoutData))
        warnings.push_back(allFixedWarning("change"));
    if (!result.accuracyReached)
        warnings.push_back(accuracyWarning(result.accuracy, result.errorEstimate));
    append(residualWarnings(result.residuals), warnings);
    return warnings;
}

/// The report of both filters.
/// @param signal  "quality changed", for example.
FilterOutcome outcomeOf(const char* name, const char* signal, const RichParameterList& parameters,
                        const spectral::SignalFilterOptions& options, const MeshMatrices& input,
                        const spectral::FilteredSignal& result) {
    const double size = options.featureSize;
    std::ostringstream text;
    text << std::setprecision(4) << name << ": " << nameOf(options.transferFunction.type)
         << " at feature size " << size << " ("
         << 100.0 * size / spectral::boundingBoxDiagonal(input.V) << " % of the diagonal); "
         << signal << " by " << result.rmsChange << " (root mean square), at most by "
         << result.maxChange << "; estimated relative error " << std::setprecision(2)
         << result.errorEstimate << "\n  " << surfaceText(result);
    if (result.verticesWithoutData > 0)
        text << ", " << result.verticesWithoutData << " vertices without a value (NaN) unchanged";
    text << "\n  work: " << result.factorizations << " factorizations, " << result.solves
         << " solves";
    std::map<std::string, QVariant> report{{"feature_size", size},
                                           {"cutoff_frequency", result.cutoffFrequency},
                                           {"rms_change", result.rmsChange},
                                           {"max_change", result.maxChange},
                                           {"error_estimate", result.errorEstimate},
                                           {"accuracy_reached", result.accuracyReached},
                                           {"vertices_without_data", result.verticesWithoutData},
                                           {"factorizations", result.factorizations},
                                           {"solves", result.solves}};
    addSurfaceCounts(result, report);
    std::vector<std::string> warnings = warningsOf(options.part.selected, result);
    append(percentageWarnings(input), warnings);
    append(unusedTransferParameters(parameters), warnings);
    return {std::move(report), text.str(), std::move(warnings)};
}

/// "minimum to maximum" of the values that are not NaN.
std::string rangeOf(const Eigen::VectorXd& values) {
    std::ostringstream text;
    text << std::setprecision(4) << values.minCoeff<Eigen::PropagateNumbers>() << " to "
         << values.maxCoeff<Eigen::PropagateNumbers>();
    return text.str();
}

FilterOutcome applyToQuality(const RichParameterList& parameters, MeshModel& mesh,
                             const spectral::Progress& progress) {
    if (!mesh.hasPerVertexQuality())
        throw MLException(
            "the mesh has no vertex quality to filter: apply a filter that computes one first, "
            "e.g. 'Per Vertex Quality Function'");
    const MeshMatrices input = toMatrices(mesh.cm);
    const Eigen::VectorXd Q = vertexQuality(mesh.cm, input);
    const spectral::SignalFilterOptions options = signalOptions(parameters, mesh, input);
    const spectral::FilteredSignal result = spectral::withSteadyProgress(
        progress, spectral::filterSignal, input.V, input.F, Q, options);
    if (!(result.Y.cwiseAbs().maxCoeff<Eigen::PropagateNumbers>() <=
          std::numeric_limits<Scalarm>::max()))
        throw MLException(
            "the filtered quality exceeds the largest number: choose smaller gains, or apply 'Per "
            "Vertex Quality Function', q / 1000, first");

    reportWriting(input, mesh.cm, progress);
    setQuality(input.vertexIndex, result.Y.col(0), mesh);
    FilterOutcome outcome =
        outcomeOf(kQualityName, "quality changed", parameters, options, input, result);
    outcome.text += "\n  quality: " + rangeOf(Q) + " -> " + rangeOf(result.Y);
    return outcome;
}

FilterOutcome applyToColor(const RichParameterList& parameters, MeshModel& mesh,
                           const spectral::Progress& progress) {
    if (!mesh.hasPerVertexColor())
        throw MLException(
            "the mesh has no vertex colours to filter: apply a filter that sets them first, e.g. "
            "'Per Vertex Color Function' or 'Transfer Color: Texture to Vertex'");
    const MeshMatrices input = toMatrices(mesh.cm);
    Eigen::MatrixXd Q(input.V.rows(), 3);
    for (Eigen::Index i = 0; i < Q.rows(); ++i)
        for (int c = 0; c < 3; ++c) Q(i, c) = mesh.cm.vert[input.vertexIndex[i]].cC()[c];
    const spectral::SignalFilterOptions options = signalOptions(parameters, mesh, input);
    const spectral::FilteredSignal result = spectral::withSteadyProgress(
        progress, spectral::filterSignal, input.V, input.F, Q, options);

    reportWriting(input, mesh.cm, progress);
    mesh.updateDataMask(MeshModel::MM_VERTCOLOR);
    const Eigen::ArrayXXd levels = result.Y.array().round();
    for (Eigen::Index i = 0; i < Q.rows(); ++i)
        for (int c = 0; c < 3; ++c)
            mesh.cm.vert[input.vertexIndex[i]].C()[c] =
                static_cast<unsigned char>(std::clamp(levels(i, c), 0.0, kWhite));
    const auto clamped = static_cast<int>((levels < 0.0 || levels > kWhite).count());
    FilterOutcome outcome =
        outcomeOf(kColorName, "colours changed (in levels of 0 to 255, before rounding)",
                  parameters, options, input, result);
    outcome.report["clamped_values"] = clamped;
    outcome.text +=
        "\n  clamped: " + std::to_string(clamped) + " of " + std::to_string(Q.size()) + " values";
    return outcome;
}

}  // namespace

MeshFilter qualityMeshFilter() {
    return {kQualityName,
            "apply_scalar_spectral_filter_per_vertex",
            kQualityHelp,
            FilterPlugin::FilterClass(FilterPlugin::Smoothing | FilterPlugin::Quality),
            MeshModel::MM_VERTQUALITY,
            signalsParameters,
            applyToQuality};
}

MeshFilter colorMeshFilter() {
    return {kColorName,
            "apply_color_spectral_filter_per_vertex",
            kColorHelp,
            FilterPlugin::FilterClass(FilterPlugin::Smoothing | FilterPlugin::VertexColoring),
            MeshModel::MM_VERTCOLOR,
            signalsParameters,
            applyToColor};
}
