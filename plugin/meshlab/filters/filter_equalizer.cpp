#include <common/parameters/rich_parameters.h>

#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/filter/fractional_filter.h"
#include "core/mesh/measures.h"
#include "core/mesh/mesh_check.h"
#include "core/support/errors.h"
#include "core/support/steady_progress.h"
#include "core/transfer/equalizer.h"
#include "meshlab/filters/common_parameters.h"
#include "meshlab/filters/fractional_report.h"
#include "meshlab/filters/surface_report.h"
#include "meshlab/mesh_conversion.h"
#include "meshlab/mesh_filter.h"

namespace {

// Three lines: MeshLab shows all of it above the parameters.
const char* const kEqualizerHelp =
    "Each slider scales the height of <b>details of one size</b>, from coarse to fine: 1 keeps, 2 "
    "doubles, 0 removes them. With <i>Preview</i> the shape follows. To deepen the folds of a "
    "robe, set the slider of their size to 2.";

/// Sizes of the sliders from coarse to fine, as multiples of the smallest size.
constexpr int kTimes[] = {32, 16, 8, 4, 2, 1};

constexpr Scalarm kMaxGain = 4;

/// Maximum number of automatic steps if previews are to follow the sliders: five evaluations.
constexpr int kMaxPreviewSteps = 2;

QString gainName(int times) { return QString("gain_%1x").arg(times); }

/// "0.24 (12 %)": a length, also as a percentage of the diagonal.
QString lengthAndPercentage(double length, double diagonal) {
    return QString("%1 (%2 %)").arg(length, 0, 'g', 3).arg(100.0 * length / diagonal, 0, 'g', 3);
}

RichParameterList equalizerParameters(const MeshModel& mesh) {
    const Scalarm diagonal = mesh.cm.bbox.Diag();
    const double edge = meanEdge(mesh);
    const double smallest = spectral::defaultSmallestSize(edge, surfaceDiagonal(mesh));
    RichParameterList list;
    for (const int times : kTimes) {
        // The reference documentation is generated without a mesh: there are no sizes.
        const QString size = edge > 0.0 ? lengthAndPercentage(times * smallest, diagonal)
                                        : QString("%1 x the smallest size").arg(times);
        const QString finer = times == 1 ? " and of all finer ones" : "";
        list.addParam(RichDynamicFloat(
            gainName(times), 1, 0, kMaxGain, "Details of " + size,
            QString("Factor for the height of details of %1 times the smallest size%2: 1 keeps "
                    "them, 2 doubles them, 0.5 halves them, 0 removes them.")
                .arg(times)
                .arg(finer)));
    }
    list.addParam(RichPercentage(
        "smallest_size", static_cast<Scalarm>(smallest), 0, diagonal, "Smallest size",
        "Size of the details that the last slider scales; it doubles with each slider above. The "
        "labels of the sliders show the sizes for the default, three mean edges of this mesh: it "
        "has hardly any finer details." +
            meanEdgeText(edge)));
    list.addParam(selectedParameter(mesh, "eight times the smallest size"));
    list.addParam(boundaryParameter(
        "<b>free</b>: it moves like the rest. <b>fixed</b>: it stays exactly in place."));
    list.addParam(RichBool(
        "accurate", false, "Accurate",
        "Off: at most two steps, fast enough for the preview. Changes by gains of 0.5 to 2 are "
        "then accurate to about 1 %, those by a gain of 0 may be off by a third; the log states "
        "the error. On: as many steps as needed for an accuracy of 0.05 % of the diagonal.",
        true));
    return list;
}

/// The sliders' gains, from fine to coarse.
/// @throws spectral::InvalidOption  when a gain is invalid; it names the slider.
std::vector<double> chosenGains(const RichParameterList& parameters) {
    std::vector<double> gains;
    for (const int times : kTimes) {
        const double gain = parameters.getDynamicFloat(gainName(times));
        if (!std::isfinite(gain) || gain < 0.0)
            throw spectral::InvalidOption(gainName(times).toStdString() + " = " +
                                          spectral::textOf(gain) +
                                          ": must be finite and not negative; 0 removes details, 1 "
                                          "keeps them, 2 doubles them");
        gains.insert(gains.begin(), gain);
    }
    return gains;
}

/// "details of 0.24 (12 %) x 2, of 0.12 (6 %) x 0.5": the sliders not at 1.
std::string changesText(const RichParameterList& parameters, double smallest, double diagonal) {
    std::ostringstream text;
    text << std::setprecision(3);
    const char* before = "details of ";
    for (const int times : kTimes) {
        const double gain = parameters.getDynamicFloat(gainName(times));
        if (gain == 1.0) continue;
        text << std::exchange(before, ", of ")
             << lengthAndPercentage(times * smallest, diagonal).toStdString() << " x " << gain;
    }
    return text.str();
}

/// The result of a quick run, which has no tolerance to reach; its error is still reported.
spectral::FilterResult withoutTolerance(spectral::FilterResult result) {
    result.toleranceReached = true;
    result.singularPart = 0.0;
    return result;
}

FilterOutcome applyEqualizer(const RichParameterList& parameters, MeshModel& mesh,
                             const spectral::Progress& progress) {
    const MeshMatrices input = toMatrices(mesh.cm);
    spectral::checkMesh(input.V, input.F);  // before it is measured
    const double smallest = parameters.getAbsPerc("smallest_size");
    const spectral::Equalizer equalizer =
        spectral::octaveEqualizer(smallest, chosenGains(parameters));
    spectral::FilterOptions options;
    options.transferFunction.type = spectral::FilterType::Custom;
    options.transferFunction.custom = equalizer;
    options.featureSize = equalizer.middleSize();
    const double diagonal = spectral::boundingBoxDiagonal(input.V);
    options.tolerance = defaultTolerance(mesh);
    const bool isAccurate = parameters.getBool("accurate");
    if (!isAccurate) options.maxSteps = kMaxPreviewSteps;
    options.boundary = boundaryCondition(parameters);
    options.part.selected = chosenVertices(parameters, mesh, input);
    const spectral::FilterResult result = spectral::withSteadyProgress(
        progress, spectral::fractionalFilter, input.V, input.F, options);
    const spectral::FilterResult reported = isAccurate ? result : withoutTolerance(result);
    const std::string changes = changesText(parameters, smallest, diagonal);
    FilterOutcome outcome{reportDictionary(result), "",
                          fractionalWarnings(options, reported, diagonal)};
    append(percentageWarnings(input), outcome.warnings);
    if (changes.empty()) {
        outcome.summary = "all gains are 1; nothing changed";
        outcome.text = "Spectral Equalizer: " + outcome.summary;
        return outcome;
    }
    outcome.text =
        fractionalReportText(options, reported, diagonal, "Spectral Equalizer: " + changes);
    reportWriting(input, mesh.cm, progress);
    setPositions(input, result.V, mesh);
    return outcome;
}

}  // namespace

MeshFilter equalizerMeshFilter() {
    return {"Spectral Equalizer", "apply_coord_spectral_equalizer",
            kEqualizerHelp,       FilterPlugin::Smoothing,
            kMovesVertices,       equalizerParameters,
            applyEqualizer};
}
