#include <common/parameters/rich_parameters.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>

#include "core/analysis/manifold_harmonics.h"
#include "core/support/errors.h"
#include "core/support/steady_progress.h"
#include "meshlab/error_messages.h"
#include "meshlab/filters/common_parameters.h"
#include "meshlab/mesh_conversion.h"
#include "meshlab/mesh_filter.h"

namespace {

constexpr int kDefaultMode = 1;  // the first that is not constant on a connected surface

/// Prefix of the names of the vertex attributes, followed by the mode.
const char* const kAttribute = "harmonic_";

const char* const kHarmonicsHelp =
    "Computes the <b>manifold harmonics</b> of a surface, its standing waves from low to high "
    "frequencies, like those of a drum of this shape. One of them becomes the vertex quality, in "
    "colours: red where it is positive, blue where it is negative.";

RichParameterList harmonicsParameters(const MeshModel&) {
    RichParameterList list;
    list.addParam(RichInt(
        "mode", kDefaultMode, "Mode",
        "Number of the harmonic to show, below the basis size. The constant ones come first, one "
        "for each component (none with a fixed boundary); higher ones are finer."));
    list.addParam(
        RichInt("basis_size", spectral::HarmonicsOptions().basisSize, "Basis size",
                "Number of harmonics to compute, constant ones included. Must be below the number "
                "of vertices that are not fixed; time and memory grow with it."));
    list.addParam(RichBool("store_basis", false, "Store basis",
                           "Keep all harmonics as vertex attributes named harmonic_0, harmonic_1 "
                           "and so on, one number per vertex each. Those of an earlier run are "
                           "replaced. They are orthonormal with the vertex areas as weights."));
    list.addParam(laplacianParameter());
    list.addParam(
        boundaryParameter("<b>free</b>: the waves have zero slope across the boundary. "
                          "<b>fixed</b>: they are zero there, like the skin of a drum."));
    return list;
}

void checkMode(int mode, int basisSize) {
    if (mode >= 0 && (mode < basisSize || basisSize < 1))
        return;  // truncatedBasis rejects basisSize < 1
    throw spectral::InvalidOption("mode = " + std::to_string(mode) +
                                  ": a basis of basis_size = " + std::to_string(basisSize) +
                                  " has the modes 0 to " + std::to_string(basisSize - 1));
}

std::string textOf(const spectral::ManifoldHarmonics& harmonics, int mode) {
    const double lambda = harmonics.lambda[mode];
    const auto size = static_cast<int>(harmonics.lambda.size());
    std::ostringstream text;
    text << std::setprecision(4) << "Manifold Harmonics: mode " << mode << " of " << size
         << ", eigenvalue " << lambda;
    if (lambda > 0.0) text << ", wavelength " << 2.0 * spectral::kPi / std::sqrt(lambda);
    if (harmonics.wholeSize > size)
        text << "\n  the basis splits a multiple eigenvalue; basis_size = " << harmonics.wholeSize
             << " would not";
    text << "\n  none of the lowest is missing: the inertia of W - sigma D counts "
         << harmonics.inertiaCount << "; largest relative residual "
         << harmonics.residuals.maxCoeff();
    return text.str();
}

/// @param t  in [-1, 1].
vcg::Color4b blueWhiteRed(double t) {
    const auto faded =
        static_cast<unsigned char>(std::lround(255.0 * (1.0 - std::min(std::abs(t), 1.0))));
    return t < 0.0 ? vcg::Color4b(faded, faded, 255, 255) : vcg::Color4b(255, faded, faded, 255);
}

/// Colours a signed function: blue below 0, white at 0, red above; full colour at the extreme.
void setDivergingColors(const std::vector<std::size_t>& vertexIndex, const Eigen::VectorXd& values,
                        MeshModel& mesh) {
    mesh.updateDataMask(MeshModel::MM_VERTCOLOR);
    const double extreme = values.cwiseAbs().maxCoeff();
    const double scale = extreme > 0.0 ? 1.0 / extreme : 0.0;
    for (std::size_t i = 0; i < vertexIndex.size(); ++i)
        mesh.cm.vert[vertexIndex[i]].C() =
            blueWhiteRed(scale * values[static_cast<Eigen::Index>(i)]);
}

FilterOutcome applyHarmonics(const RichParameterList& parameters, MeshModel& mesh,
                             const spectral::Progress& progress) {
    const int mode = parameters.getInt("mode");
    spectral::HarmonicsOptions options;
    options.basisSize = parameters.getInt("basis_size");
    options.laplacian = laplacianKind(parameters);
    options.boundary = boundaryCondition(parameters);
    checkMode(mode, options.basisSize);
    const MeshMatrices input = toMatrices(mesh.cm);
    const spectral::ManifoldHarmonics harmonics = spectral::withSteadyProgress(
        progress, spectral::manifoldHarmonics, input.V, input.F, options);

    reportWriting(input, mesh.cm, progress);
    if (parameters.getBool("store_basis"))
        setAttributes(input.vertexIndex, kAttribute, harmonics.Phi, mesh);
    setQuality(input.vertexIndex, harmonics.Phi.col(mode), mesh);
    setDivergingColors(input.vertexIndex, harmonics.Phi.col(mode), mesh);
    return {{{"eigenvalues", QVariant::fromValue(harmonics.lambda)},
             {"residuals", QVariant::fromValue(harmonics.residuals)},
             {"inertia_count", harmonics.inertiaCount}},
            textOf(harmonics, mode),
            residualWarnings(harmonics.residuals)};
}

}  // namespace

MeshFilter harmonicsMeshFilter() {
    return {"Manifold Harmonics",
            "compute_scalar_manifold_harmonic_per_vertex",
            kHarmonicsHelp,
            FilterPlugin::Quality,
            MeshModel::MM_VERTQUALITY | MeshModel::MM_VERTCOLOR,
            harmonicsParameters,
            applyHarmonics};
}
