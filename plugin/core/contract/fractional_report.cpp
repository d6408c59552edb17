#include "core/contract/fractional_report.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "core/contract/advice.h"
#include "core/contract/number_text.h"
#include "core/contract/surface_report.h"
#include "core/contract/transfer_fields.h"
#include "core/filter/automatic_steps.h"
#include "core/support/types.h"

namespace spectral {

namespace {

bool hasBasis(const FilterResult& result) { return result.eigenvalues.size() > 0; }
bool hasResiduals(const FilterResult& result) { return result.residuals.size() > 0; }

}  // namespace

const Entries<FilterResult>& fractionalEntries() {
    using R = FilterResult;
    static const Entries<R> entries = joined<R>(
        {{
             {"steps", "number of steps; with automatic steps, of the last pass", &R::steps},
             {"passes",
              "passes of automatic steps: this number repeats the run exactly; 0: not automatic",
              &R::passes},
             {"cutoff_frequency", "2 π / feature size, radians per length", &R::cutoffFrequency},
             {"feature_size", "as applied, length", &R::featureSize},
             {"area_before", "of the surface, length²", &R::areaBefore},
             {"area_after", "of the filtered surface, length²", &R::areaAfter},
             {"rounded_creases",
              "largest displacement along sharp edges, which `crease_angle` 50 keeps, length; 0 "
              "where they hardly moved farther than the rest",
              [](const R& r) -> Value { return r.roundedCreases.largest; }},
             {"factorizations", "number of sparse factorizations", &R::factorizations},
             {"solves", "number of solves with one right-hand side", &R::solves},
             {"products",
              "number of products of the Laplacian with one coordinate, in place of solves",
              &R::products},
             {"error_estimate",
              "estimated error of the evaluation, relative to the size of what is filtered",
              &R::errorEstimate},
             {"accuracy_reached", "whether the evaluation reached its accuracy",
              &R::accuracyReached},
             {"step_error",
              "with automatic steps, estimated error over all but a thousandth of the input "
              "surface, without what collapses, length",
              &R::stepError},
             {"tolerance_reached",
              "with automatic steps, whether all but a thousandth of the input surface is within "
              "`tolerance`, what collapses included",
              &R::toleranceReached},
             {"singular_part", "share of the surface, 0 to 1, on which `tolerance` was not reached",
              &R::singularPart},
             {"thin_part_factor",
              "at the default size, by how much the thinnest part exceeds it, squared; above 2, "
              "thin parts are kept",
              &R::thinPartFactor},
             {"shrunken_part", "share of the surface, 0 to 1, that shrinks to lines or points",
              &R::shrunkenPart},
             {"mean_edge", "mean edge, length", &R::meanEdge},
             {"step_sizes", "fractional powers of the steps, in order; their sum is 1",
              [](const R& r) -> Value {
                  return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(
                      r.stepSizes.data(), static_cast<Index>(r.stepSizes.size())));
              }},
             {"eigenvalues", "of the last basis that was computed, ascending, 1 / length²",
              &R::eigenvalues, hasBasis},
             {"cutoff_reached", "whether the harmonics reach the cutoff frequency",
              &R::cutoffReached, hasBasis},
             {"computed_bases", "number of bases computed in all steps", &R::computedBases,
              hasBasis},
             {"residuals", "residuals of the harmonics, relative", &R::residuals, hasResiduals},
             {"inertia_count",
              "number of harmonics that the basis must hold, by Sylvester's law; 0 if unneeded",
              &R::inertiaCount, hasResiduals},
         },
         movementEntries<R>()});
    return entries;
}

namespace {

/// Fraction of a surface whose loss is noticeable, e.g. half the tail of an elephant.
constexpr double kNoticeable = 0.003;

/// "10", or "automatic, 2 in pass 2": one automatic step is not one of the paper's.
std::string stepsText(const FilterResult& result) {
    const std::string steps = std::to_string(result.steps);
    if (result.passes == 0) return steps;
    return "automatic, " + steps + " in pass " + std::to_string(result.passes);
}

/// Whether the surface is within the tolerance, but for parts that collapse.
bool isAccurateElsewhere(const FilterOptions& options, const FilterResult& result) {
    return result.toleranceReached || result.stepError <= options.tolerance;
}

/// What was done, for everybody.
std::string deedOf(const FilterOptions& options) {
    const TransferFunctionOptions& transfer = options.transferFunction;
    return transfer.type == FilterType::LowPass && transfer.passGain <= 1.0 ? "Smoothed" : "Moved";
}

/// The most important facts for those who know filters: filter and size, displacement, accuracy.
std::string headline(const FilterOptions& options, const FilterResult& result, double diagonal,
                     const std::string& subject) {
    const double percent = 100.0 / diagonal;
    std::ostringstream text;
    text << std::setprecision(4);
    if (!subject.empty())
        text << subject;
    else
        text << "Spectral Filter: " << nameOf(options.transferFunction.type) << " at feature size "
             << result.featureSize << " (" << percent * result.featureSize << " % of the diagonal)";
    text << "; root mean square " << result.rmsDisplacement << "; ";
    text << std::setprecision(2);
    if (options.steps > 0)
        text << result.steps << (result.steps == 1 ? " step" : " steps") << ", as requested";
    else if (isAccurateElsewhere(options, result))
        text << "accurate to " << result.stepError << " (" << percent * result.stepError << " %)";
    else
        text << "NOT accurate: estimated error " << result.stepError << " ("
             << percent * result.stepError << " %)";
    if (options.steps == 0 && result.singularPart > kNegligibleArea)
        text << "; less so on " << percentOf(result.singularPart) << " of the input";
    return text.str();
}

/// @param last  frequency of the highest harmonic.
Warning cutoffWarning(const FilterResult& result, double last) {
    return {WarningCode::FewHarmonics,
            "the " + std::to_string(result.eigenvalues.size()) + " harmonics end at features of " +
                numberText(2.0 * kPi / last, 4) + ", above the feature size of " +
                numberText(result.featureSize, 4) +
                ": details between these sizes are treated like all finer ones. Choose a larger "
                "|feature_size|, a larger |basis_size|, or |spectrum = full|"};
}

/// The settings with which parts of a surface neither collapse nor grow as fast.
std::string weakerFilter(const FilterOptions& options) {
    const TransferFunctionOptions& transfer = options.transferFunction;
    const bool stopsLargeDetails =
        transfer.type == FilterType::HighPass || transfer.type == FilterType::BandPass;
    std::string text =
        options.basisUpdate == BasisUpdate::Full ? "|basis_update = conformal|, " : "";
    if (transfer.type == FilterType::Custom)
        text += "gains closer to 1";
    else if (std::max(transfer.passGain, transfer.stopGain) > 1.0)
        text += "smaller gains";
    else if (stopsLargeDetails && transfer.stopGain < 0.1)
        text += "|stop_gain = 1|, which keeps the large details";
    else
        text += "a smaller |feature_size|";
    return text;
}

/// Why the steps do not converge, and what to change.
std::string convergingFilter(const FilterOptions& options) {
    const TransferFunctionOptions& transfer = options.transferFunction;
    const bool grows =
        transfer.type != FilterType::Custom && std::max(transfer.passGain, transfer.stopGain) > 1.0;
    return std::string("parts of it ") + (grows ? "grow too fast" : "shrink away") + ". Choose " +
           weakerFilter(options) + ", or a larger |tolerance|";
}

Warning foldWarning(const FilterOptions& options, const FilterResult& result) {
    return {WarningCode::FoldedFaces, std::to_string(result.foldedFaces) +
                                          (result.foldedFaces == 1 ? " face has" : " faces have") +
                                          " folded over. Choose " + weakerFilter(options)};
}

Warning toleranceWarning(const FilterOptions& options, const FilterResult& result) {
    return {WarningCode::Tolerance,
            "the tolerance of " + numberText(options.tolerance, 2) + " was not reached on " +
                percentOf(result.singularPart) + " of the surface, " +
                (isAccurateElsewhere(options, result)
                     ? "most of which collapses; elsewhere the estimated error is "
                     : "where the estimated error is at least ") +
                numberText(result.stepError, 2) + ": " + convergingFilter(options)};
}

/// Gains above 1 at the largest sizes are meant for details by those who set them.
Warnings scalingWarnings(const FilterOptions& options, const FilterResult& result) {
    constexpr double kScaling = 1.01;
    const double gain = TransferFunction(options.transferFunction, result.cutoffFrequency)(0.0);
    if (!(gain > kScaling)) return {};
    return {{WarningCode::WholeScaled,
             "the gain of the largest details is " + numberText(gain, 3) +
                 ", which scales the whole object. Choose 1 to keep its size"}};
}

Warning volumeWarning(const FilterResult& result) {
    std::ostringstream text;
    text << "components that keep their volume: " << result.volumes.preserved << " of "
         << result.components << "; open, or not consistently oriented: " << result.volumes.open;
    if (result.volumes.lost > 0)
        text << "; shrunk too far, or not movable: " << result.volumes.lost;
    text << ". Close holes and orient the faces first, or turn |preserve_volume| off";
    return {WarningCode::VolumeNotKept, text.str()};
}

/// Only a warning, as scripts use one feature size for many meshes.
Warning edgeWarning(const FilterResult& result) {
    return {WarningCode::BelowEdges,
            "the mesh has no details of the feature size " + numberText(result.featureSize, 3) +
                ", which is below its mean edge length of " + numberText(result.meanEdge, 3) +
                ". Choose at least two edges, " + numberText(2.0 * result.meanEdge, 3) +
                "; if the model has few triangles, {apply 'Subdivision Surfaces: Midpoint'|"
                "subdivide them} first"};
}

Warning shrinkingWarning(const FilterResult& result, double diagonal) {
    const double half = 0.5 * result.featureSize;
    return {WarningCode::ThinParts,
            percentOf(result.shrunkenPart) +
                " of the surface shrinks to lines or points, since it is thin compared with the "
                "feature size" +
                (result.toleranceReached ? ""
                                         : ", and on " + percentOf(result.singularPart) +
                                               " the tolerance was not reached") +
                ". Try |feature_size = " + numberText(half, 2) + "| (" +
                numberText(100.0 * half / diagonal, 2) +
                " % of the diagonal), or filter a selection without these parts"};
}

double lastFrequency(const FilterResult& result) {
    return std::sqrt(result.eigenvalues[result.eigenvalues.size() - 1]);
}

}  // namespace

Warnings fractionalWarnings(const FilterOptions& options, const FilterResult& result,
                            double diagonal) {
    Warnings warnings = surfaceWarnings(result);
    const bool isAtRest = isAllFixed(result, result.V.rows());
    if (isAtRest)
        warnings.push_back(options.creaseAngle > 0.0
                               ? Warning{WarningCode::AllFixed,
                                         "nothing can move: every vertex lies on a crease or a "
                                         "fixed boundary. Choose a larger |crease_angle|"}
                               : allFixedWarning("move"));
    const bool isDefault = options.keepThinParts;
    if (!isDefault && options.transferFunction.type != FilterType::Custom &&
        result.featureSize < result.meanEdge && !isAtRest)
        warnings.push_back(edgeWarning(result));
    const TransferFunctionOptions& transfer = options.transferFunction;
    const bool keepsTheRest = transfer.type == FilterType::LowPass && transfer.passGain >= 1.0;
    const bool shrinks = !isDefault && keepsTheRest && result.shrunkenPart > kNoticeable &&
                         isAccurateElsewhere(options, result) && result.cutoffReached;
    if (shrinks) warnings.push_back(shrinkingWarning(result, diagonal));
    append(scalingWarnings(options, result), warnings);
    if (!isDefault && result.foldedFaces > 0) warnings.push_back(foldWarning(options, result));
    if (options.preserveVolume && result.volumes.preserved < result.components)
        warnings.push_back(volumeWarning(result));
    if (!result.accuracyReached) {
        warnings.push_back(accuracyWarning(result.accuracy, result.errorEstimate, transfer.type));
        warnings.back().text +=
            ", or fewer steps; if triangles are needles, {apply 'Remeshing: Isotropic Explicit "
            "Remeshing'|remesh} first";
    }
    if (!result.toleranceReached && result.accuracyReached && !shrinks)
        warnings.push_back(toleranceWarning(options, result));
    if (!result.cutoffReached) warnings.push_back(cutoffWarning(result, lastFrequency(result)));
    append(residualWarnings(result.residuals), warnings);
    return warnings;
}

std::string fractionalText(const FilterOptions& options, const FilterResult& result,
                           double diagonal, const std::string& subject, const std::string& deed) {
    std::ostringstream text;
    text << std::setprecision(4);
    text << movementText(deed.empty() ? deedOf(options) : deed, result.meanDisplacement,
                         result.maxDisplacement, diagonal)
         << limitText(result.limitedShare) << "\n  " << headline(options, result, diagonal, subject)
         << "\n  steps: " << stepsText(result) << ", cutoff frequency " << result.cutoffFrequency
         << " rad per unit\n"
         << "  area: " << result.areaBefore << " -> " << result.areaAfter
         << ", faces folded over: " << result.foldedFaces << "\n"
         << "  " << volumeText(result.hasVolume, result.volumeBefore, result.volumeAfter) << "\n  "
         << surfaceText(result, "vertices fixed, on the boundary or a crease");
    if (options.preserveVolume)
        text << ", " << result.volumes.preserved << " with the volume preserved";
    if (const RoundedCreases& creases = result.roundedCreases; creases.vertices > 0)
        text << "\n  creases: rounded, " << creases.vertices
             << " vertices along sharp edges moved by up to " << creases.largest << " ("
             << 100.0 * creases.largest / diagonal
             << " % of the diagonal); crease_angle = 50 keeps them";
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

}  // namespace spectral
