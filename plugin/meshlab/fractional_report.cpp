#include "fractional_report.h"

#include <common/plugins/interfaces/filter_plugin.h>

#include <cmath>
#include <iomanip>
#include <sstream>

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
        report["updated_bases"] = result.updatedBases;
    }
    if (result.residuals.size() > 0) {
        report["residuals"] = vectorVariant(result.residuals);
        report["inertia_count"] = result.inertiaCount;
    }
    return report;
}

std::string reportText(const spectral::FilterResult& result) {
    std::ostringstream text;
    text << std::setprecision(4);
    text << "Spectral Filter: " << result.steps << (result.steps == 1 ? " step" : " steps")
         << ", feature size " << result.featureSize << " (cutoff frequency "
         << result.cutoffFrequency << " rad per unit)\n"
         << "  displacement: largest " << result.maxDisplacement << ", root mean square "
         << result.rmsDisplacement << "\n"
         << "  area: " << result.areaBefore << " -> " << result.areaAfter << "\n"
         << "  volume: " << result.volumeBefore << " -> " << result.volumeAfter
         << " (of closed surfaces)\n"
         << "  surface: " << result.components
         << (result.components == 1 ? " component" : " components");
    if (result.unreferencedVertices > 0)
        text << ", " << result.unreferencedVertices << " unreferenced vertices left alone";
    if (result.fixedVertices > 0)
        text << ", " << result.fixedVertices << " vertices fixed on its boundary";
    if (result.stepError > 0.0)
        text << "\n  automatic steps: estimated error of any vertex " << result.stepError;
    text << "\n  work: " << result.factorizations << " factorizations, " << result.solves
         << " solves";
    if (result.eigenvalues.size() > 0)
        text << ", " << result.eigenvalues.size() << " harmonics up to frequency "
             << std::sqrt(result.eigenvalues[result.eigenvalues.size() - 1]) << ", computed "
             << result.computedBases << " times, updated " << result.updatedBases << " times";
    else
        text << ", estimated relative error " << result.errorEstimate;
    for (const std::string& warning : result.warnings) text << "\n  WARNING: " << warning;
    return text.str();
}
