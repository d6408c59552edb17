#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/contract/advice.h"
#include "core/contract/common_fields.h"
#include "core/contract/filters.h"
#include "core/contract/report.h"
#include "core/contract/surface_report.h"
#include "core/contract/transfer_fields.h"
#include "core/filter/signal_filter.h"
#include "core/support/errors.h"

// The two filters of signals on a fixed shape: vertex quality and vertex colours.

namespace spectral {

namespace {

const char* const kQualityName = "Spectral Filter: Vertex Quality";
const char* const kColorName = "Spectral Filter: Vertex Color";

constexpr double kWhite = 255.0;

struct SignalCall : TransferCall<SignalFilterOptions> {
    bool onlySelected = false;
};

Fields<SignalCall> signalFields() {
    using Call = SignalCall;
    Fields<Call> fields;
    addTransferFields(fields);
    fields.push_back(selectedField<Call>(&Call::onlySelected));
    fields.push_back(laplacianField<Call>(&Call::laplacian));
    fields.push_back(
        boundaryField<Call>(&Call::boundary,
                            "*free*: values there are filtered like the rest. *fixed*: they are "
                            "kept exactly, and the values in between are filtered."));
    return fields;
}

/// The result, and the size that was applied.
struct Filtered : FilteredSignal {
    double featureSize = 0.0;
};

Entries<Filtered> signalEntries() {
    using R = Filtered;
    return joined<R>(
        {{
             {"feature_size", "as applied, length", &R::featureSize},
             {"cutoff_frequency", "2 π / feature size, radians per length", &R::cutoffFrequency},
             {"rms_change",
              "root mean square of the changes over the surface, in the units of the values",
              &R::rmsChange},
             {"max_change", "largest change of a value, in its units (colours: levels of 0 to 255)",
              &R::maxChange},
             {"error_estimate",
              "estimated error of the evaluation, relative to the size of what is filtered",
              &R::errorEstimate},
             {"accuracy_reached", "whether the evaluation reached its accuracy",
              &R::accuracyReached},
             {"vertices_without_data", "number of vertices whose value is NaN, unchanged",
              &R::verticesWithoutData},
             {"factorizations", "number of sparse factorizations", &R::factorizations},
             {"solves", "number of solves with one right-hand side", &R::solves},
         },
         surfaceEntries<R>()});
}

/// @param vertices  number of vertices of the mesh.
Warnings warningsOf(Index vertices, const FilteredSignal& result, FilterType type) {
    Warnings warnings = surfaceWarnings(result);
    if (result.isConstant)
        warnings.push_back(
            {WarningCode::ConstantValues,
             "nothing to filter: the values are constant on every connected component{. Apply a "
             "filter that computes qualities or colours first|}"});
    else if (isAllFixed(result, vertices - result.verticesWithoutData))
        warnings.push_back(allFixedWarning("change"));
    if (!result.accuracyReached)
        warnings.push_back(accuracyWarning(result.accuracy, result.errorEstimate, type));
    append(residualWarnings(result.residuals), warnings);
    return warnings;
}

/// Filters the values of both filters.
/// @param signal  "quality changed", for example.
FilterOutput filterValues(const char* name, const char* signal, const FilterInput& input,
                          const MeshLengths& mesh, const Values& given, const Progress& progress) {
    static const Fields<SignalCall> fields = signalFields();
    if (input.values.size() == 0)
        throw InvalidMesh(ErrorCode::NoData, "there are no values to filter");
    SignalCall call = callOf(fields, given, mesh);
    resolveCustomGain(call.customGain, mesh, input.gain, call.transferFunction, call.featureSize);
    if (call.onlySelected) call.part.selected = input.selected;
    Filtered result{filterSignal(input.V, input.F, input.values, call, progress), call.featureSize};
    std::ostringstream text;
    text << std::setprecision(4) << name << ": " << nameOf(call.transferFunction.type)
         << " at feature size " << call.featureSize << " ("
         << 100.0 * call.featureSize / mesh.diagonal << " % of the diagonal); " << signal << " by "
         << result.rmsChange << " (root mean square), at most by " << result.maxChange
         << "; estimated relative error " << std::setprecision(2) << result.errorEstimate << "\n  "
         << surfaceText(result);
    if (result.verticesWithoutData > 0)
        text << ", " << result.verticesWithoutData << " vertices without a value (NaN) unchanged";
    text << "\n  work: " << result.factorizations << " factorizations, " << result.solves
         << " solves";
    FilterOutput output;
    output.report = reportOf(signalEntries(), result);
    output.text = text.str();
    output.values = std::move(result.Y);
    const auto warnings = [&] {
        Warnings all = warningsOf(input.V.rows(), result, call.transferFunction.type);
        append(percentageWarnings(mesh), all);
        append(unusedWarnings(fields, call), all);
        return all;
    };
    output.warnings = warnings();
    for (std::size_t c = 0; result.columns.size() > 1 && c < result.columns.size(); ++c) {
        static_cast<SignalChange&>(result) = result.columns[c];
        FilterOutput& column = output.columns.emplace_back();
        column.report = reportOf(signalEntries(), result);
        column.warnings = warnings();
    }
    return output;
}

/// "minimum to maximum" of the values that are not NaN.
std::string rangeOf(const Eigen::MatrixXd& values) {
    std::ostringstream text;
    text << std::setprecision(4) << values.minCoeff<Eigen::PropagateNumbers>() << " to "
         << values.maxCoeff<Eigen::PropagateNumbers>();
    return text.str();
}

FilterOutput runOnQuality(const FilterInput& input, const MeshLengths& mesh, const Values& given,
                          const Progress& progress) {
    FilterOutput output =
        filterValues(kQualityName, "quality changed", input, mesh, given, progress);
    output.text += "\n  quality: " + rangeOf(input.values) + " -> " + rangeOf(output.values);
    return output;
}

const ReportEntry kClamped{"clamped_values",
                           "number of red, green and blue levels that were clamped to 0 to 255"};

FilterOutput runOnColors(const FilterInput& input, const MeshLengths& mesh, const Values& given,
                         const Progress& progress) {
    FilterOutput output =
        filterValues(kColorName, "colours changed (in levels of 0 to 255, before rounding)", input,
                     mesh, given, progress);
    const Eigen::ArrayXXd levels = output.values.array().round();
    const auto clamped = static_cast<int>((levels < 0.0 || levels > kWhite).count());
    output.values = levels.max(0.0).min(kWhite);
    output.report[kClamped.name] = clamped;
    output.text += "\n  clamped: " + std::to_string(clamped) + " of " +
                   std::to_string(levels.size()) + " values";
    return output;
}

}  // namespace

Filter qualityContract() {
    return {kQualityName,
            "apply_scalar_spectral_filter_per_vertex",
            "Filters the *vertex quality*, i.e. any number per vertex, by the size of its details "
            "on the surface, as Spectral Filter (Fractional) filters shapes. The shape does not "
            "change; a quality of NaN means no data. Smoothing stated as a full width at half "
            "maximum (FWHM), as in brain imaging, is the low-pass at a feature size of 3.20 times "
            "that width.",
            "",
            parametersOf(signalFields()),
            describedBy(signalEntries()),
            runOnQuality};
}

Filter colorContract() {
    std::vector<ReportEntry> report = describedBy(signalEntries());
    report.push_back(kClamped);
    return {kColorName,
            "apply_color_spectral_filter_per_vertex",
            "Filters the *vertex colours* by the size of their details on the surface, as Spectral "
            "Filter (Fractional) filters shapes: removes noise from scanned colours, or sharpens a "
            "painting. The shape does not change.",
            "",
            parametersOf(signalFields()),
            std::move(report),
            runOnColors};
}

}  // namespace spectral
