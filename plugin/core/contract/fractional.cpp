#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/contract/common_fields.h"
#include "core/contract/filters.h"
#include "core/contract/fractional_report.h"
#include "core/contract/surface_report.h"
#include "core/contract/transfer_fields.h"
#include "core/filter/fractional_filter.h"
#include "core/support/errors.h"

namespace spectral {

namespace {

enum class Wanted { FilteredShape, Details };

struct FractionalCall : TransferCall<FilterOptions> {
    bool onlySelected = false;
    Weight weight = Weight::None;
    Wanted result = Wanted::FilteredShape;
};

const char* unlessTruncated(const FractionalCall& call) {
    return call.evaluation.spectrum == Spectrum::Truncated ? nullptr
                                                           : "without |spectrum = truncated|";
}

/// In the order users decide: what, which size, how strong, how.
Fields<FractionalCall> fractionalFields() {
    using Call = FractionalCall;
    Fields<Call> fields;
    addTransferFields(fields);
    fields.push_back(selectedField<Call>(&Call::onlySelected));
    fields.push_back(
        field<Call>(&Call::steps, "steps", "Steps (0 = automatic)",
                    "The filter is applied in this many weak steps, because a single strong one "
                    "turns thin parts into spikes or balloons. 0 approximates infinitely many of "
                    "them, to the |tolerance|; 10 is the scheme of the paper with ten steps; 1 is "
                    "the classical one-shot filter.")
            .in("number of steps")
            .to(1000.0)
            .advanced());
    fields.push_back(
        field<Call>(&Call::tolerance, "tolerance", "Tolerance",
                    "With |steps| 0: largest distance between the result and that of infinitely "
                    "many steps, on all but a thousandth of the surface. Larger is faster.")
            .in("length")
            .above(0.0)
            .length("0.05%", defaultTolerance, "0.05 % of the diagonal")
            .advanced());
    fields.push_back(
        field<Call>(&Call::passes, "passes", "Passes (0 = automatic)",
                    "With |steps| 0: the number of passes of 1, 2, 4, ... steps, whatever the "
                    "|tolerance|. The report says how many a run took: that number repeats the "
                    "run exactly.")
            .in("number of passes")
            .to(kMaxPasses)
            .advanced()
            .unusedIf([](const Call& call) -> const char* {
                return call.steps == 0 ? nullptr : "without |steps = 0|";
            }));
    fields.push_back(
        field<Call>(
            &Call::basisUpdate, "basis_update", "Basis update",
            "What every step recomputes from the current shape. *full*, the paper's scheme: "
            "all of its frequencies. *conformal*: its areas only (Kazhdan et al. 2012); "
            "thin parts are drawn in smoothly instead of turning into spikes. *none*: "
            "nothing; the number of steps then makes no difference.")
            .of({"full", "conformal", "none"})
            .advanced());
    fields.push_back(
        field<Call>(&Call::conformalShare, "conformal_share", "Conformal share",
                    "For the full update: from 0, the paper's scheme, to 1, the conformal update. "
                    "0.1 is enough to contract thin parts that a strong full update leaves as "
                    "hair-thin spikes.")
            .in("share")
            .to(1.0)
            .advanced()
            .unusedIf([](const Call& call) -> const char* {
                return call.basisUpdate == BasisUpdate::Full ? nullptr
                                                             : "without |basis_update = full|";
            }));
    fields.push_back(
        field<Call>([](auto& call) -> auto& { return call.evaluation.spectrum; }, "spectrum",
                    "Spectrum",
                    "*full* filters all frequencies of the mesh, and is fast. *truncated* computes "
                    "only the lowest frequencies (as many as the |basis_size|) and treats all "
                    "others alike, as older methods do; every step takes long, so set a number of "
                    "|steps|, e.g. 10.")
            .of({"full", "truncated"})
            .advanced());
    fields.push_back(
        field<Call>(
            [](auto& call) -> auto& { return call.evaluation.truncation.basisSize; }, "basis_size",
            "Basis size",
            "Number of frequencies (manifold harmonics) of a truncated spectrum, e.g. 300. Must be "
            "below the number of vertices; time and memory grow with it.")
            .in("number of harmonics")
            .from(1.0)
            .advanced()
            .unusedIf(unlessTruncated));
    fields.push_back(
        field<Call>(
            [](auto& call) -> auto& { return call.evaluation.truncation.reinjectResidual; },
            "reinject_residual", "Reinject residual",
            "For a truncated spectrum: keep the details beyond the basis, with the mean gain of "
            "their frequencies. Off: drop them.")
            .advanced()
            .unusedIf(unlessTruncated));
    fields.push_back(laplacianField<Call>(&Call::laplacian));
    fields.push_back(boundaryField<Call>(
        &Call::boundary,
        "*free*: it moves like the rest; strong smoothing rounds it off and pulls it in. *fixed*: "
        "it stays exactly in place, and the surface in between is filtered."));
    fields.push_back(
        field<Call>(
            &Call::creaseAngle, "crease_angle", "Crease angle (0 = off)",
            "Edges whose two faces meet at more than this angle, in degrees, stay in place, "
            "and nothing is filtered across them. For the edges of a machine part, e.g. 40.")
            .in("degrees")
            .to(180.0)
            .advanced());
    fields.push_back(
        field<Call>(&Call::preserveVolume, "preserve_volume", "Preserve volume",
                    "Move the surface along its normals until every closed component has regained "
                    "its volume. Open components have none.")
            .advanced());
    fields.push_back(maxDisplacementField<Call>(&Call::maxDisplacement));
    fields.push_back(
        weightField<Call>(&Call::weight,
                          "how much of the filter each vertex gets, from 0 (nothing) to "
                          "1 (all), so that you can paint where to filter. *none*: all of it."));
    fields.push_back(
        field<Call>(
            &Call::result, "result", "Result",
            "*details*: no vertex moves. What the filter would remove, input minus result, "
            "is stored as the vertex attribute spectral_details, and its length along the "
            "normal, positive outwards, replaces the vertex quality (after it has served as "
            "the weight).")
            .of({"filtered shape", "details"})
            .advanced());
    return fields;
}

/// Whether a size is the default of the mesh: one that nobody chose. Dialogs and `info` round its
/// number.
bool isDefaultFeatureSize(double size, const MeshLengths& mesh) {
    constexpr double kRounding = 0.01;
    const double usual = featureSizeOf(mesh);
    return std::abs(size - usual) <= kRounding * usual;
}

FilterOutput run(const FilterInput& input, const MeshLengths& mesh, const Values& given,
                 const Progress& progress) {
    static const Fields<FractionalCall> fields = fractionalFields();
    FractionalCall call = callOf(fields, given, mesh);
    // Users do not mean the default by 0, as `FilterOptions` do.
    if (call.steps == 0 && call.tolerance == 0.0)
        throw InvalidOption(
            "tolerance = 0: automatic steps need a length above zero, e.g. 0.05 % of the diagonal "
            "of the bounding box");
    call.keepThinParts = isDefaultFeatureSize(call.featureSize, mesh);
    if (input.whole) call.whole = {mesh.meanEdge, input.whole->hasThinParts, input.whole->inner};
    resolveCustomGain(call.customGain, mesh, input.gain, call.transferFunction, call.featureSize);
    if (call.onlySelected) call.part.selected = input.selected;
    call.part.weight = weightOf(call.weight, input);
    FilterResult result = fractionalFilter(input.V, input.F, call, progress);
    FilterOutput output;
    output.report = reportOf(fractionalEntries(), result);
    output.text = fractionalText(call, result, mesh.diagonal, {},
                                 call.result == Wanted::Details ? "Details found" : "");
    output.warnings = fractionalWarnings(call, result, mesh.diagonal);
    append(percentageWarnings(mesh), output.warnings);
    if (!input.whole && call.result != Wanted::Details)
        append(periodicWarnings(input.V, input.F, result.V), output.warnings);
    append(unusedWarnings(fields, call), output.warnings);
    if (call.result == Wanted::Details)
        output.details = input.V - result.V;
    else
        output.V = std::move(result.V);
    return output;
}

}  // namespace

Filter fractionalFilterContract() {
    // Three lines: MeshLab shows all of the help above the parameters.
    return {"Spectral Filter (Fractional)",
            "apply_coord_spectral_filter_fractional",
            "Smooths, sharpens or enhances details *by their size*, as an equalizer filters sound "
            "by frequency. Low-pass: details larger than the feature size stay, smaller ones go.",
            "Kovnatsky, Bronstein, Bronstein: [Stable Spectral Mesh Filtering]"
            "(https://doi.org/10.1007/978-3-642-33863-2), 2012",
            parametersOf(fractionalFields()),
            describedBy(fractionalEntries()),
            run};
}

}  // namespace spectral
