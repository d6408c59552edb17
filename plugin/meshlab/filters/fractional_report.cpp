#include "meshlab/filters/fractional_report.h"

#include <common/plugins/interfaces/filter_plugin.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <utility>

#include "core/filter/automatic_steps.h"
#include "core/support/types.h"
#include "meshlab/error_messages.h"
#include "meshlab/filters/common_parameters.h"
#include "meshlab/filters/surface_report.h"
#include "meshlab/filters/transfer_parameters.h"

std::map<std::string, QVariant> reportDictionary(const spectral::FilterResult& result) {
    std::map<std::string, QVariant> report{
        {"steps", result.steps},
        {"passes", result.passes},
        {"cutoff_frequency", result.cutoffFrequency},
        {"feature_size", result.featureSize},
        {"area_before", result.areaBefore},
        {"area_after", result.areaAfter},
        {"factorizations", result.factorizations},
        {"solves", result.solves},
        {"products", result.products},
        {"error_estimate", result.errorEstimate},
        {"accuracy_reached", result.accuracyReached},
        {"step_error", result.stepError},
        {"tolerance_reached", result.toleranceReached},
        {"singular_part", result.singularPart},
        {"shrunken_part", result.shrunkenPart},
        {"mean_edge", result.meanEdge},
        {"step_sizes",
         QVariant::fromValue(Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(
             result.stepSizes.data(), static_cast<Eigen::Index>(result.stepSizes.size()))))},
    };
    addMovement(result, report);
    if (result.eigenvalues.size() > 0) {
        report["eigenvalues"] = QVariant::fromValue(result.eigenvalues);
        report["cutoff_reached"] = result.cutoffReached;
        report["computed_bases"] = result.computedBases;
    }
    if (result.residuals.size() > 0) {
        report["residuals"] = QVariant::fromValue(result.residuals);
        report["inertia_count"] = result.inertiaCount;
    }
    return report;
}

namespace {

/// Fraction of a surface whose loss is noticeable, e.g. half the tail of an elephant.
constexpr double kNoticeable = 0.003;

/// A share in percent, to two or three digits.
std::string percentOf(double share) {
    std::ostringstream text;
    text << std::setprecision(share < 0.1 ? 2 : 3) << 100.0 * share << " %";
    return text.str();
}

/// "10", or "automatic, 2 in pass 2": one automatic step is not one of the paper's.
std::string stepsText(const spectral::FilterResult& result) {
    std::ostringstream text;
    if (result.passes > 0)
        text << "automatic, " << result.steps << " in pass " << result.passes;
    else
        text << result.steps;
    return text.str();
}

/// The most important facts in one line: filter and size, displacement, accuracy.
std::string headline(const spectral::FilterOptions& options, const spectral::FilterResult& result,
                     double diagonal, const std::string& subject) {
    const double percent = 100.0 / diagonal;
    std::ostringstream text;
    text << std::setprecision(4);
    if (!subject.empty())
        text << subject;
    else
        text << "Spectral Filter: " << nameOf(options.transferFunction.type) << " at feature size "
             << result.featureSize << " (" << percent * result.featureSize << " % of the diagonal)";
    text << "; the surface moves by " << result.rmsDisplacement
         << " (root mean square), at most by " << result.maxDisplacement << "; ";
    text << std::setprecision(2);
    if (options.steps > 0)
        text << result.steps << (result.steps == 1 ? " step" : " steps") << ", as requested";
    else if (result.toleranceReached)
        text << "accurate to " << result.stepError << " (" << percent * result.stepError << " %)";
    else
        text << "NOT accurate: estimated error " << result.stepError << " ("
             << percent * result.stepError << " %)";
    if (options.steps == 0 && result.singularPart > spectral::kNegligibleArea)
        text << "; less so on " << percentOf(result.singularPart) << " of the input";
    return text.str();
}

/// @param last  frequency of the highest harmonic.
std::string cutoffWarning(const spectral::FilterResult& result, double last) {
    std::ostringstream text;
    text << std::setprecision(4) << "the " << result.eigenvalues.size()
         << " harmonics end at features of " << 2.0 * spectral::kPi / last
         << ", above the feature size of " << result.featureSize
         << ": details between these sizes are treated like all finer ones. Choose a larger "
            "feature_size, a larger basis_size, or spectrum = full";
    return text.str();
}

/// Why the steps do not converge, and what to change.
std::string convergingFilter(const spectral::FilterOptions& options) {
    const spectral::TransferFunctionOptions& transfer = options.transferFunction;
    const bool stopsLargeDetails = transfer.type == spectral::FilterType::HighPass ||
                                   transfer.type == spectral::FilterType::BandPass;
    std::string text = "parts of it shrink away. Choose ";
    if (transfer.type == spectral::FilterType::Custom)
        text += "gains closer to 1";
    else if (std::max(transfer.passGain, transfer.stopGain) > 1.0)
        text = "parts of it grow too fast. Choose smaller gains";
    else if (stopsLargeDetails && transfer.stopGain < 0.1)
        text += "stop_gain = 1, which keeps the large details";
    else
        text += "a smaller feature_size";
    if (options.basisUpdate == spectral::BasisUpdate::Full) text += ", basis_update = conformal";
    return text + ", or a larger tolerance";
}

std::string toleranceWarning(const spectral::FilterOptions& options,
                             const spectral::FilterResult& result) {
    std::ostringstream text;
    text << std::setprecision(2) << "the tolerance of " << options.tolerance
         << " was not reached on " << percentOf(result.singularPart)
         << " of the surface, where the estimated error is at least " << result.stepError << ": "
         << convergingFilter(options);
    return text.str();
}

std::string volumeWarning(const spectral::FilterResult& result) {
    std::ostringstream text;
    text << "the volume of " << result.volumes.preserved << " of " << result.components
         << " components is preserved: " << result.volumes.open
         << " are open, or not consistently oriented";
    if (result.volumes.lost > 0)
        text << ", and " << result.volumes.lost << " have shrunk too far, or must not move";
    return text.str() + ". Close holes and orient the faces first, or turn preserve_volume off";
}

/// Only a warning, as scripts use one feature size for many meshes.
std::string edgeWarning(const spectral::FilterResult& result) {
    std::ostringstream text;
    text << std::setprecision(3) << "the mesh has no details of the feature size "
         << result.featureSize << ", which is below its mean edge length of " << result.meanEdge
         << ". Choose at least two edges, " << 2.0 * result.meanEdge
         << "; if the model has few triangles, apply 'Subdivision Surfaces: Midpoint' first";
    return text.str();
}

std::string shrinkingWarning(const spectral::FilterResult& result, double diagonal) {
    const double half = 0.5 * result.featureSize;
    std::ostringstream text;
    text << percentOf(result.shrunkenPart) << std::setprecision(2)
         << " of the surface shrinks to lines or points, as it is thin compared with the feature "
            "size. Try feature_size = "
         << half << " (" << 100.0 * half / diagonal
         << " % of the diagonal), or filter a selection without these parts";
    return text.str();
}

double lastFrequency(const spectral::FilterResult& result) {
    return std::sqrt(result.eigenvalues[result.eigenvalues.size() - 1]);
}

}  // namespace

std::vector<std::string> fractionalWarnings(const spectral::FilterOptions& options,
                                            const spectral::FilterResult& result, double diagonal) {
    std::vector<std::string> warnings = surfaceWarnings(result);
    if (const std::string note = selectionText(options.part.selected); !note.empty())
        warnings.push_back(note);
    const bool isAtRest = isAllFixed(result, result.V.rows());
    if (isAtRest)
        warnings.push_back(options.creaseAngle > 0.0
                               ? "nothing can move: every vertex lies on a crease or a fixed "
                                 "boundary. Choose a larger crease_angle"
                               : allFixedWarning("move"));
    if (options.transferFunction.type != spectral::FilterType::Custom &&
        result.featureSize < result.meanEdge && !isAtRest)
        warnings.push_back(edgeWarning(result));
    const spectral::TransferFunctionOptions& transfer = options.transferFunction;
    const bool keepsTheRest =
        transfer.type == spectral::FilterType::LowPass && transfer.passGain >= 1.0;
    if (keepsTheRest && result.shrunkenPart > kNoticeable && result.toleranceReached &&
        result.cutoffReached)
        warnings.push_back(shrinkingWarning(result, diagonal));
    if (options.preserveVolume && result.volumes.preserved < result.components)
        warnings.push_back(volumeWarning(result));
    if (!result.accuracyReached)
        warnings.push_back(accuracyWarning(result.accuracy, result.errorEstimate) +
                           ", or fewer steps; if triangles are needles, apply 'Remeshing: "
                           "Isotropic Explicit Remeshing' first");
    if (!result.toleranceReached) warnings.push_back(toleranceWarning(options, result));
    if (!result.cutoffReached) warnings.push_back(cutoffWarning(result, lastFrequency(result)));
    append(residualWarnings(result.residuals), warnings);
    return warnings;
}

std::string fractionalReportText(const spectral::FilterOptions& options,
                                 const spectral::FilterResult& result, double diagonal,
                                 const std::string& subject) {
    std::ostringstream text;
    text << std::setprecision(4);
    text << headline(options, result, diagonal, subject) << "\n  steps: " << stepsText(result)
         << ", cutoff frequency " << result.cutoffFrequency << " rad per unit\n"
         << "  area: " << result.areaBefore << " -> " << result.areaAfter << "\n"
         << "  " << volumeText(result.hasVolume, result.volumeBefore, result.volumeAfter) << "\n  "
         << surfaceText(result, "vertices fixed, on the boundary or a crease");
    if (options.preserveVolume)
        text << ", " << result.volumes.preserved << " with the volume preserved";
    text << "\n  work: " << result.factorizations << " factorizations, " << result.solves
         << " solves, " << result.products << " products";
    if (result.lacksMemory) text << ", as a factorization does not fit in memory";
    if (result.eigenvalues.size() > 0)
        text << ", " << result.eigenvalues.size() << " harmonics up to frequency "
             << lastFrequency(result) << ", bases computed: " << result.computedBases;
    else
        text << ", estimated relative error " << result.errorEstimate;
    return text.str();
}
