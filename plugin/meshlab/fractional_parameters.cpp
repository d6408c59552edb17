#include "fractional_parameters.h"

#include <common/parameters/rich_parameters.h>

#include "common_parameters.h"
#include "core/filter/transfer_function.h"

using spectral::FilterOptions;

namespace {

/// In parts of the diagonal of the bounding box.
constexpr double kDefaultTolerance = 0.0005;

}  // namespace

RichParameterList fractionalFilterParameters(const MeshModel& mesh) {
    const FilterOptions defaults;
    const spectral::TransferFunctionOptions& transfer = defaults.transferFunction;
    const Scalarm diagonal = mesh.cm.bbox.Diag();
    RichParameterList list;

    // The order of the entries is that of the core's enumerations.
    list.addParam(RichEnum(
        "filter_type", static_cast<int>(transfer.type),
        {"low-pass", "high-pass", "band-pass", "band-stop"}, "Filter type",
        "What to do with details, by their size. <b>low-pass</b> keeps what is larger than the "
        "feature size and removes the rest. <b>high-pass</b> acts on what is smaller: with stop "
        "gain 1 and pass gain 2 it sharpens. <b>band-pass</b> acts on details of about the feature "
        "size: with stop gain 1 and pass gain above 1 it enhances them. <b>band-stop</b> removes "
        "them."));
    list.addParam(featureSizeParameter(
        mesh,
        "Size of the details where the filter turns over: the wavelength of a wave along the "
        "surface, a bump and the hollow next to it. To remove bumps, try twice their width. "
        "By default six mean edges of this mesh, at most 5 % of its diagonal: enough to remove the "
        "noise of a scan."));
    list.addParam(RichFloat(
        "pass_gain", static_cast<Scalarm>(transfer.passGain), "Pass gain",
        "Factor for the details that the filter passes: 1 keeps them, 2 doubles their height, 0 "
        "removes them. Not negative."));
    list.addParam(RichFloat(
        "stop_gain", static_cast<Scalarm>(transfer.stopGain), "Stop gain",
        "Factor for all other details: 0 removes them, 0.5 halves their height, 1 keeps them. Not "
        "negative."));
    list.addParam(RichFloat(
        "band_width", static_cast<Scalarm>(transfer.bandWidth), "Band width (octaves)",
        "Width of the band of band-pass and band-stop, in octaves: 1 means that its largest "
        "details are twice as large as its smallest.",
        true));
    list.addParam(RichEnum(
        "response", static_cast<int>(transfer.response), {"gaussian", "butterworth", "ideal"},
        "Response",
        "How sharply the filter tells sizes apart. <b>gaussian</b> changes over gently and never "
        "rings; <b>butterworth</b> is sharper the higher its order; <b>ideal</b> cuts at once and "
        "may leave ripples.",
        true));
    list.addParam(RichInt(
        "order", transfer.order, "Butterworth order",
        "Steepness of the butterworth response, from 1 (gentle) to 64 (nearly ideal).", true));
    list.addParam(RichFloat(
        "power", static_cast<Scalarm>(transfer.power), "Power",
        "The part of the filter to apply, as a power of its gains: 0.5 is half of the filter (a "
        "gain of 4 becomes 2). Above 0, at most 1.",
        true));
    list.addParam(RichInt(
        "steps", defaults.steps, "Steps (0 = automatic)",
        "The filter is applied as this many weak steps, because a single strong one turns thin "
        "parts into spikes or balloons. 0 takes as many as the tolerance needs; 10 is the scheme "
        "of the paper [1] with ten steps; 1 is the classical one-shot filter.",
        true));
    list.addParam(RichPercentage(
        "tolerance", static_cast<Scalarm>(kDefaultTolerance) * diagonal, 0, diagonal, "Tolerance",
        "With 0 steps: how far the surface may be from where infinitely many steps would put it "
        "(but a thousandth of it, where thin parts pinch off). More is faster.",
        true));
    list.addParam(RichEnum(
        "basis_update", static_cast<int>(defaults.basisUpdate), {"full", "conformal", "none"},
        "Basis update",
        "What every step learns from the shape that the step before has made. <b>full</b>, the "
        "paper's scheme, takes its frequencies anew. <b>conformal</b> takes its areas anew [4]: "
        "thin parts shrink instead of turning into spikes. <b>none</b> keeps the frequencies of "
        "the input; then the number of steps does not matter.",
        true));
    list.addParam(RichFloat(
        "conformal_share", static_cast<Scalarm>(defaults.conformalShare), "Conformal share",
        "For the full update: from 0, the scheme of the paper, to 1, the conformal update. 0.1 is "
        "enough to draw in thin parts that a strong full update leaves as hair-thin spikes.",
        true));
    list.addParam(RichEnum(
        "spectrum", static_cast<int>(defaults.evaluation.spectrum), {"full", "truncated"},
        "Spectrum",
        "<b>full</b> filters all frequencies that the mesh can carry, and is fast. "
        "<b>truncated</b> computes only the lowest frequencies (as many as the basis size) and "
        "treats all the others alike, as older methods do; each step computes them, so give a "
        "number of steps, e.g. 10.",
        true));
    list.addParam(RichInt(
        "basis_size", defaults.evaluation.basisSize, "Basis size",
        "How many frequencies (manifold harmonics) a truncated spectrum has, e.g. 300. Must be "
        "below the number of vertices; time and memory grow with it.",
        true));
    list.addParam(RichBool(
        "reinject_residual", defaults.evaluation.reinjectResidual, "Reinject residual",
        "For a truncated spectrum: keep the details beyond the basis, with the mean gain of their "
        "frequencies. Off: drop them.",
        true));
    list.addParam(laplacianParameter(
        "How the frequencies of the surface are measured. <b>intrinsic delaunay</b> works on any "
        "triangles, also needles, holes, doubled or crossing sheets, and stays stable in strong "
        "filters. <b>cotangent</b> is the formula of the paper; every triangle needs an area."));
    list.addParam(boundaryParameter(
        "What happens at the rims of an open surface and of its holes. <b>free</b>: they move as "
        "the rest does; a strong smoothing rounds them off and draws them in. <b>fixed</b>: every "
        "rim stays exactly where it is, and the surface between is filtered."));
    return list;
}

FilterOptions fractionalFilterOptions(const RichParameterList& parameters) {
    FilterOptions options;
    spectral::TransferFunctionOptions& transfer = options.transferFunction;
    transfer.type = static_cast<spectral::FilterType>(parameters.getEnum("filter_type"));
    transfer.response = static_cast<spectral::Response>(parameters.getEnum("response"));
    transfer.order = parameters.getInt("order");
    transfer.bandWidth = parameters.getFloat("band_width");
    transfer.passGain = parameters.getFloat("pass_gain");
    transfer.stopGain = parameters.getFloat("stop_gain");
    transfer.power = parameters.getFloat("power");
    options.featureSize = featureSize(parameters);
    options.steps = parameters.getInt("steps");
    options.tolerance = parameters.getAbsPerc("tolerance");
    options.basisUpdate = static_cast<spectral::BasisUpdate>(parameters.getEnum("basis_update"));
    options.conformalShare = parameters.getFloat("conformal_share");
    options.evaluation.spectrum = static_cast<spectral::Spectrum>(parameters.getEnum("spectrum"));
    options.evaluation.basisSize = parameters.getInt("basis_size");
    options.evaluation.reinjectResidual = parameters.getBool("reinject_residual");
    options.laplacian = laplacianKind(parameters);
    options.boundary = boundaryCondition(parameters);
    return options;
}
