#include "meshlab/filters/fractional_parameters.h"

#include <common/parameters/rich_parameters.h>

#include "core/support/errors.h"
#include "meshlab/filters/common_parameters.h"
#include "meshlab/filters/transfer_parameters.h"

using spectral::FilterOptions;

namespace {

// In the order of the core's enumerations.
QStringList basisUpdates() { return {"full", "conformal", "none"}; }
QStringList weights() { return {"none", "vertex quality"}; }
QStringList results() { return {"filtered shape", "details"}; }
QStringList spectra() { return {"full", "truncated"}; }

}  // namespace

RichParameterList fractionalFilterParameters(const MeshModel& mesh) {
    const FilterOptions defaults;
    const Scalarm diagonal = mesh.cm.bbox.Diag();
    RichParameterList list;

    addTransferParameters(mesh, list);
    list.addParam(selectedParameter(mesh));
    list.addParam(RichInt(
        "steps", defaults.steps, "Steps (0 = automatic)",
        "The filter is applied in this many weak steps, because a single strong one turns "
        "thin parts into spikes or balloons. 0 approximates infinitely many of them, to the "
        "tolerance; 10 is the scheme of the paper with ten steps; 1 is the classical "
        "one-shot filter.",
        true));
    list.addParam(RichPercentage(
        "tolerance", static_cast<Scalarm>(defaultTolerance(mesh)), 0, diagonal, "Tolerance",
        "With 0 steps: largest distance of the surface from the result of infinitely many steps, "
        "for all but a thousandth of it. Larger is faster.",
        true));
    list.addParam(RichInt(
        "passes", defaults.passes, "Passes (0 = automatic)",
        "With 0 steps: the number of passes of 1, 2, 4, ... steps, whatever the tolerance. A log "
        "tells how many a run took: with that number it is repeated exactly.",
        true));
    list.addParam(RichEnum(
        "basis_update", static_cast<int>(defaults.basisUpdate), basisUpdates(), "Basis update",
        "What every step recomputes from the current shape. <b>full</b>, the paper's scheme: all "
        "of its frequencies. <b>conformal</b>: its areas only (Kazhdan et al. 2012); thin parts "
        "are "
        "drawn in smoothly instead of turning into spikes. "
        "<b>none</b>: nothing; the number of steps then makes no difference.",
        true));
    list.addParam(RichFloat(
        "conformal_share", static_cast<Scalarm>(defaults.conformalShare), "Conformal share",
        "For the full update: from 0, the paper's scheme, to 1, the conformal update. 0.1 is "
        "enough to contract thin parts that a strong full update leaves as hair-thin spikes.",
        true));
    list.addParam(RichEnum(
        "spectrum", static_cast<int>(defaults.evaluation.spectrum), spectra(), "Spectrum",
        "<b>full</b> filters all frequencies of the mesh, and is fast. <b>truncated</b> computes "
        "only the lowest frequencies (as many as the basis size) and treats all others alike, as "
        "older methods do; every step takes long, so set a number of steps, e.g. 10.",
        true));
    list.addParam(
        RichInt("basis_size", defaults.evaluation.truncation.basisSize, "Basis size",
                "Number of frequencies (manifold harmonics) of a truncated spectrum, e.g. 300. "
                "Must be below the number of vertices; time and memory grow with it.",
                true));
    list.addParam(RichBool("reinject_residual", defaults.evaluation.truncation.reinjectResidual,
                           "Reinject residual",
                           "For a truncated spectrum: keep the details beyond the basis, with the "
                           "mean gain of their frequencies. Off: drop them.",
                           true));
    list.addParam(laplacianParameter());
    list.addParam(boundaryParameter(
        "<b>free</b>: it moves like the rest; strong smoothing rounds it off and pulls it in. "
        "<b>fixed</b>: it stays exactly in place, and the surface in between is filtered."));
    list.addParam(RichFloat(
        "crease_angle", static_cast<Scalarm>(defaults.creaseAngle), "Crease angle (0 = off)",
        "Edges whose two faces meet at more than this angle, in degrees, stay in place, and "
        "nothing is filtered across them. For the edges of a machine part, e.g. 40.",
        true));
    list.addParam(RichBool("preserve_volume", defaults.preserveVolume, "Preserve volume",
                           "Move the surface along its normals until every closed component has "
                           "regained its volume. Open components have none.",
                           true));
    list.addParam(
        RichEnum("weight", 0, weights(), "Weight",
                 "<b>vertex quality</b>: how much of the filter each vertex gets, from 0 (nothing) "
                 "to 1 (all), to paint where to filter. <b>none</b>: all of it.",
                 true));
    list.addParam(RichEnum(
        "result", 0, results(), "Result",
        "<b>details</b>: no vertex moves. What the filter would remove, input minus result, is "
        "stored as the vertex attribute spectral_details, and its length along the normal, "
        "positive outwards, replaces the vertex quality (after it has served as the weight).",
        true));
    return list;
}

bool areDetailsWanted(const RichParameterList& parameters) {
    return choice(parameters, "result", results()) == 1;
}

std::vector<std::string> unusedParameters(const RichParameterList& parameters) {
    const FilterOptions defaults;
    const bool isFull = choice(parameters, "basis_update", basisUpdates()) ==
                        static_cast<int>(spectral::BasisUpdate::Full);
    const bool isTruncated = choice(parameters, "spectrum", spectra()) ==
                             static_cast<int>(spectral::Spectrum::Truncated);
    std::vector<std::string> warnings = unusedTransferParameters(parameters);
    warnIfUnused(
        parameters.getFloat("conformal_share") != static_cast<Scalarm>(defaults.conformalShare),
        isFull, "conformal_share", "without basis_update = full", warnings);
    warnIfUnused(parameters.getInt("passes") != defaults.passes, parameters.getInt("steps") == 0,
                 "passes", "without steps = 0", warnings);
    warnIfUnused(parameters.getInt("basis_size") != defaults.evaluation.truncation.basisSize,
                 isTruncated, "basis_size", "without spectrum = truncated", warnings);
    warnIfUnused(
        parameters.getBool("reinject_residual") != defaults.evaluation.truncation.reinjectResidual,
        isTruncated, "reinject_residual", "without spectrum = truncated", warnings);
    return warnings;
}

FilterOptions fractionalFilterOptions(const RichParameterList& parameters, const MeshModel& mesh,
                                      const MeshMatrices& matrices) {
    FilterOptions options;
    const ChosenTransfer transfer = chosenTransfer(parameters, matrices);
    options.transferFunction = transfer.options;
    options.featureSize = transfer.featureSize;
    options.steps = parameters.getInt("steps");
    options.tolerance = parameters.getAbsPerc("tolerance");
    options.passes = parameters.getInt("passes");
    options.keepThinParts = isDefaultFeatureSize(parameters, mesh, matrices);
    options.basisUpdate =
        static_cast<spectral::BasisUpdate>(choice(parameters, "basis_update", basisUpdates()));
    options.conformalShare = parameters.getFloat("conformal_share");
    options.evaluation.spectrum =
        static_cast<spectral::Spectrum>(choice(parameters, "spectrum", spectra()));
    options.evaluation.truncation.basisSize = parameters.getInt("basis_size");
    options.evaluation.truncation.reinjectResidual = parameters.getBool("reinject_residual");
    options.laplacian = laplacianKind(parameters);
    options.boundary = boundaryCondition(parameters);
    options.creaseAngle = parameters.getFloat("crease_angle");
    options.preserveVolume = parameters.getBool("preserve_volume");
    options.part.selected = chosenVertices(parameters, mesh, matrices);
    if (choice(parameters, "weight", weights()) == 1) {
        if (!mesh.hasPerVertexQuality())
            throw spectral::InvalidOption(
                "weight = vertex quality: the mesh has no vertex quality; compute one, or choose "
                "weight = none");
        options.part.weight = vertexQuality(mesh.cm, matrices);
    }
    return options;
}
