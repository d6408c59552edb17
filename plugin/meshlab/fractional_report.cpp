#include "fractional_report.h"

#include <common/plugins/interfaces/filter_plugin.h>

#include <cmath>
#include <iomanip>
#include <sstream>

#include "core/filter/automatic_steps.h"
#include "core/laplacian/frequency.h"

namespace {

QVariant vectorVariant(const Eigen::VectorXd& v) { return QVariant::fromValue(v); }

}  // namespace

std::map<std::string, QVariant> reportDictionary(const spectral::FilterResult& result) {
    std::map<std::string, QVariant> report{
        {"steps", result.steps},
        {"cutoff_frequency", result.cutoffFrequency},
        {"feature_size", result.featureSize},
        {"max_displacement", result.maxDisplacement},
        {"rms_displacement", result.rmsDisplacement},
        {"area_before", result.areaBefore},
        {"area_after", result.areaAfter},
        {"volume_before", result.volumeBefore},
        {"volume_after", result.volumeAfter},
        {"components", result.components},
        {"unreferenced_vertices", result.unreferencedVertices},
        {"fixed_vertices", result.fixedVertices},
        {"factorizations", result.factorizations},
        {"solves", result.solves},
        {"error_estimate", result.errorEstimate},
        {"accuracy_reached", result.accuracyReached},
        {"step_error", result.stepError},
        {"tolerance_reached", result.toleranceReached},
        {"singular_part", result.singularPart},
        {"step_sizes",
         vectorVariant(Eigen::Map<const Eigen::VectorXd>(
             result.stepSizes.data(), static_cast<Eigen::Index>(result.stepSizes.size())))},
    };
    if (result.eigenvalues.size() > 0) {
        report["eigenvalues"] = vectorVariant(result.eigenvalues);
        report["cutoff_reached"] = result.cutoffReached;
        report["computed_bases"] = result.computedBases;
    }
    if (result.residuals.size() > 0) {
        report["residuals"] = vectorVariant(result.residuals);
        report["inertia_count"] = result.inertiaCount;
    }
    return report;
}

namespace {

/// What a user wants to know, in one line: what was done to which size, how far the surface moved,
/// and how far the result can be trusted.
std::string headline(const spectral::FilterOptions& options, const spectral::FilterResult& result,
                     double diagonal) {
    static const char* const types[] = {"low-pass", "high-pass", "band-pass", "band-stop"};
    const double percent = 100.0 / diagonal;
    std::ostringstream text;
    text << std::setprecision(4)
         << "Spectral Filter: " << types[static_cast<int>(options.transferFunction.type)]
         << " at feature size " << result.featureSize << " (" << percent * result.featureSize
         << " % of the diagonal); the surface moved by " << result.rmsDisplacement
         << " in the root mean square, by " << result.maxDisplacement << " at most; ";
    text << std::setprecision(2);
    if (options.steps > 0)
        text << result.steps << (result.steps == 1 ? " step" : " steps") << ", as asked for";
    else if (result.toleranceReached)
        text << "accurate to " << result.stepError << " (" << percent * result.stepError << " %)";
    else
        text << "NOT accurate: estimated error " << result.stepError << " ("
             << percent * result.stepError << " %)";
    if (options.steps == 0 && result.singularPart > spectral::kNegligibleArea)
        text << "; " << 100.0 * result.singularPart << " % of the input shrinks away";
    return text.str();
}

}  // namespace

std::string reportText(const spectral::FilterOptions& options, const spectral::FilterResult& result,
                       double diagonal) {
    std::ostringstream text;
    text << std::setprecision(4);
    text << headline(options, result, diagonal) << "\n  steps: " << result.steps
         << ", cutoff frequency " << result.cutoffFrequency << " rad per unit\n"
         << "  area: " << result.areaBefore << " -> " << result.areaAfter << "\n"
         << "  volume: " << result.volumeBefore << " -> " << result.volumeAfter
         << " (of closed surfaces)\n"
         << "  surface: " << result.components
         << (result.components == 1 ? " component" : " components");
    if (result.unreferencedVertices > 0)
        text << ", " << result.unreferencedVertices << " unreferenced vertices left alone";
    if (result.fixedVertices > 0)
        text << ", " << result.fixedVertices << " vertices fixed on its boundary";
    text << "\n  work: " << result.factorizations << " factorizations, " << result.solves
         << " solves";
    if (result.eigenvalues.size() > 0)
        text << ", " << result.eigenvalues.size() << " harmonics up to frequency "
             << std::sqrt(result.eigenvalues[result.eigenvalues.size() - 1]) << ", computed "
             << result.computedBases << " times";
    else
        text << ", estimated relative error " << result.errorEstimate;
    for (const std::string& warning : result.warnings) text << "\n  WARNING: " << warning;
    return text.str();
}
