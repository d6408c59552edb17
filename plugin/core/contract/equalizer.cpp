#include "core/contract/equalizer.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/contract/common_fields.h"
#include "core/contract/filters.h"
#include "core/contract/fractional_report.h"
#include "core/contract/number_text.h"
#include "core/contract/surface_report.h"
#include "core/filter/equalizer_bands.h"
#include "core/filter/fractional_filter.h"
#include "core/mesh/contacts.h"
#include "core/support/errors.h"
#include "core/transfer/equalizer.h"

namespace spectral {

namespace {

/// Maximum number of automatic steps if previews are to follow the sliders: five evaluations.
constexpr int kMaxPreviewSteps = 2;

struct EqualizerCall {
    std::array<double, kEqualizerTimes.size()> gains{1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
    double smallestSize = 0.0;
    bool selected = false;
    Boundary boundary = Boundary::Free;
    bool accurate = false;
};

std::string gainName(std::size_t i) { return "gain_" + std::to_string(kEqualizerTimes[i]) + "x"; }

double smallestSizeOf(const MeshLengths& mesh) {
    return defaultSmallestSize(mesh.meanEdge, mesh.surfaceDiagonal);
}

Fields<EqualizerCall> equalizerFields() {
    using Call = EqualizerCall;
    Fields<Call> fields;
    for (std::size_t i = 0; i < kEqualizerTimes.size(); ++i) {
        const std::string times = std::to_string(kEqualizerTimes[i]);
        const bool isSmallest = kEqualizerTimes[i] == 1;
        fields.push_back(
            field<Call>(
                [i](auto& call) -> auto& { return call.gains[i]; }, gainName(i).c_str(),
                ("Details of " + times + " x the smallest size").c_str(),
                ("Factor for the height of details of " + (isSmallest ? "" : times + " times ") +
                 "the smallest size" + (isSmallest ? " and of all finer ones" : "") +
                 ": 1 keeps them, 2 doubles them, 0.5 halves them, 0 removes them.")
                    .c_str())
                .in("factor")
                .to(kMaxEqualizerGain));
    }
    fields.push_back(
        field<Call>(&Call::smallestSize, "smallest_size", "Smallest size",
                    "Size of the details that the last slider scales; it doubles with each slider "
                    "above. The default is three mean edges: a mesh has hardly any finer "
                    "details.")
            .in("length")
            .above(0.0)
            .length("auto", smallestSizeOf, "three mean edges, at most 2.5 % of the diagonal"));
    fields.push_back(selectedField<Call>(&Call::selected, "eight times the smallest size"));
    fields.push_back(boundaryField<Call>(
        &Call::boundary, "*free*: it moves like the rest. *fixed*: it stays exactly in place."));
    fields.push_back(
        field<Call>(
            &Call::accurate, "accurate", "Accurate",
            "Off: at most two steps. Changes by gains of 0.5 to 2 are then accurate to about "
            "1 %, those by a gain of 0 may be off by a third; the report states the "
            "error. On: as many steps as needed for an accuracy of 0.05 % of the "
            "diagonal. A preview is one step: changes by a gain of 2 are a tenth off, "
            "those by a gain of 0 up to a half; *Apply* in a dialog is accurate in any "
            "case.")
            .advanced());
    return fields;
}

/// The sliders' gains, from fine to coarse.
/// @throws InvalidOption  when a gain is invalid; it names the slider.
std::vector<double> gainsOf(const EqualizerCall& call) {
    for (std::size_t i = 0; i < call.gains.size(); ++i)
        if (!std::isfinite(call.gains[i]) || call.gains[i] < 0.0)
            throw InvalidOption(gainName(i) + " = " + textOf(call.gains[i]) +
                                ": must be finite and not negative; 0 removes details, 1 keeps "
                                "them, 2 doubles them");
    return {call.gains.rbegin(), call.gains.rend()};
}

/// "details of 0.24 (12 %) x 2, of 0.12 (6 %) x 0.5": the sliders not at 1.
std::string changesText(const EqualizerCall& call, double diagonal) {
    std::ostringstream text;
    text << std::setprecision(3);
    const char* before = "details of ";
    for (std::size_t i = 0; i < call.gains.size(); ++i)
        if (call.gains[i] != 1.0)
            text << std::exchange(before, ", of ")
                 << lengthText(kEqualizerTimes[i] * call.smallestSize, 3, diagonal) << " x "
                 << call.gains[i];
    return text.str();
}

/// The result of a quick run, which has no tolerance to reach; its error is still reported.
FilterResult withoutTolerance(FilterResult result) {
    result.toleranceReached = true;
    result.singularPart = 0.0;
    return result;
}

/// Every component keeps its centre, so that larger ones can move away from smaller ones in them.
Warnings partingWarnings(const FilterInput& input, const MeshLengths& mesh, const Vertices& moved) {
    const Parting parting = partingOf(input.V, input.F, moved, mesh.meanEdge);
    if (parting.components == 0) return {};
    return {{WarningCode::PartedComponents,
             std::to_string(parting.components) + " of " + std::to_string(parting.all) +
                 " components " + (parting.components == 1 ? "moves" : "move") + " up to " +
                 lengthText(parting.distance, 3, mesh.diagonal) +
                 " away from another that it touched, since each keeps its centre: choose gains "
                 "closer to 1, or select the region to be filtered"}};
}

FilterOutput run(const FilterInput& input, const MeshLengths& mesh, const Values& given,
                 const Progress& progress) {
    const EqualizerCall call = callOf(equalizerFields(), given, mesh);
    const Equalizer equalizer = octaveEqualizer(call.smallestSize, gainsOf(call));
    FilterOptions options;
    options.transferFunction.type = FilterType::Custom;
    options.transferFunction.custom = equalizer;
    options.featureSize = equalizer.middleSize();
    options.tolerance = defaultTolerance(mesh);
    if (!call.accurate) options.maxSteps = kMaxPreviewSteps;
    options.boundary = call.boundary;
    if (call.selected) options.part.selected = input.selected;
    FilterResult result = fractionalFilter(input.V, input.F, options, progress);
    FilterOutput output;
    output.report = reportOf(fractionalEntries(), result);
    const FilterResult reported = call.accurate ? result : withoutTolerance(result);
    output.warnings = fractionalWarnings(options, reported, mesh.diagonal);
    append(percentageWarnings(mesh), output.warnings);
    const std::string changes = changesText(call, mesh.diagonal);
    if (changes.empty()) {
        output.summary = "all gains are 1; nothing changed";
        output.text = "Spectral Equalizer: " + output.summary;
        return output;
    }
    output.text =
        fractionalText(options, reported, mesh.diagonal, "Spectral Equalizer: " + changes);
    output.V = std::move(result.V);
    append(partingWarnings(input, mesh, output.V), output.warnings);
    return output;
}

/// What previews keep: the bands of one mesh, and what they were computed for.
struct KeptBands {
    Vertices V;
    Faces F;
    double smallestSize;
    Boundary boundary;
    std::vector<bool> selected;
    EqualizerBands bands;

    bool areOf(const FilterInput& input, const EqualizerCall& call,
               const std::vector<bool>& wanted) const {
        return smallestSize == call.smallestSize && boundary == call.boundary &&
               selected == wanted && V.rows() == input.V.rows() && F.rows() == input.F.rows() &&
               V == input.V && F == input.F;
    }
};

FilterOutput preview(const FilterInput& input, const MeshLengths& mesh, const Values& given,
                     std::shared_ptr<void>& kept, const Progress& progress) {
    const EqualizerCall call = callOf(equalizerFields(), given, mesh);
    const Equalizer equalizer = octaveEqualizer(call.smallestSize, gainsOf(call));
    const std::string changes = changesText(call, mesh.diagonal);
    if (call.accurate || changes.empty()) return run(input, mesh, given, progress);
    const std::vector<bool> selected = call.selected ? input.selected : std::vector<bool>();
    auto* last = static_cast<KeptBands*>(kept.get());
    if (last == nullptr || !last->areOf(input, call, selected)) {
        kept.reset();
        BandOptions options;
        options.smallestSize = call.smallestSize;
        options.octaves = static_cast<int>(call.gains.size());
        options.boundary = call.boundary;
        options.part.selected = selected;
        try {
            auto made = std::make_shared<KeptBands>(
                KeptBands{input.V, input.F, call.smallestSize, call.boundary, selected,
                          EqualizerBands(input.V, input.F, options, progress)});
            last = made.get();
            kept = std::move(made);
        } catch (const Error& error) {
            if (error.code() != ErrorCode::OutOfMemory) throw;
            return run(input, mesh, given, progress);
        }
    }
    const Surface& surface = last->bands.surface();
    const Vertices displacement = last->bands.displacement(equalizer);
    const Eigen::VectorXd length = displacement.rowwise().norm();
    FilterOutput output;
    output.text = movementText("Preview", length.mean(), length.maxCoeff(), mesh.diagonal) +
                  "\n  Spectral Equalizer: " + changes +
                  "; a draft in one step: where a gain is 2 the movement is about a tenth off, "
                  "where it is 0 up to a half; Apply computes the accurate shape";
    output.V = moved(input.V, surface, displacement);
    output.warnings = partingWarnings(input, mesh, output.V);
    return output;
}

}  // namespace

std::string equalizerLabel(std::size_t i, double smallestSize, double diagonal) {
    return "Details of " + lengthText(kEqualizerTimes[i] * smallestSize, 3, diagonal);
}

Filter equalizerContract() {
    // Three lines: MeshLab shows all of the help above the parameters.
    return {"Spectral Equalizer",
            "apply_coord_spectral_equalizer",
            "Each slider scales the height of *details of one size*, from coarse to fine: 1 keeps, "
            "2 doubles, 0 removes them. With *Preview* the shape follows. To deepen the folds of a "
            "robe, set the slider of their size to 2.",
            "",
            parametersOf(equalizerFields()),
            describedBy(fractionalEntries()),
            run,
            "",
            nullptr,
            preview,
            "accurate"};
}

}  // namespace spectral
