#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>
#include <utility>

#include "core/analysis/manifold_harmonics.h"
#include "core/contract/advice.h"
#include "core/contract/common_fields.h"
#include "core/contract/filters.h"
#include "core/contract/report.h"
#include "core/support/errors.h"
#include "core/support/types.h"

namespace spectral {

namespace {

struct HarmonicsCall : HarmonicsOptions {
    int mode = 1;  // the first that is not constant on a connected surface
    bool storeBasis = false;
};

Fields<HarmonicsCall> harmonicsFields() {
    using Call = HarmonicsCall;
    return {
        field<Call>(&Call::mode, "mode", "Mode",
                    "Number of the harmonic to show, below the basis size. The constant ones come "
                    "first, one for each component (none with a fixed boundary); higher ones are "
                    "finer.")
            .in("number of a harmonic", "from 0, below the basis size"),
        field<Call>(&Call::basisSize, "basis_size", "Basis size",
                    "Number of harmonics to compute, constant ones included. Must be below the "
                    "number of vertices that are not fixed; time and memory grow with it.")
            .in("number of harmonics")
            .from(1.0),
        field<Call>(
            &Call::storeBasis, "store_basis", "Store basis",
            "Keep all harmonics as vertex attributes named harmonic_0, harmonic_1 and so "
            "on, one number per vertex each. Those of an earlier run are replaced. They are "
            "orthonormal with the vertex areas as weights."),
        laplacianField<Call>(&Call::laplacian),
        boundaryField<Call>(&Call::boundary,
                            "*free*: the waves have zero slope across the boundary. *fixed*: they "
                            "are zero there, like the skin of a drum."),
    };
}

Entries<ManifoldHarmonics> harmonicsEntries() {
    using R = ManifoldHarmonics;
    return {
        {"eigenvalues", "of the last basis that was computed, ascending, 1 / length²", &R::lambda},
        {"residuals", "residuals of the harmonics, relative", &R::residuals},
        {"inertia_count",
         "number of harmonics that the basis must hold, by Sylvester's law; 0 if unneeded",
         &R::inertiaCount},
        {"whole_size",
         "smallest basis size, from that computed on, that splits no multiple eigenvalue",
         &R::wholeSize},
    };
}

void checkMode(int mode, int basisSize) {
    if (mode >= 0 && (mode < basisSize || basisSize < 1))
        return;  // truncatedBasis rejects basisSize < 1
    throw InvalidOption("mode = " + std::to_string(mode) +
                        ": a basis of basis_size = " + std::to_string(basisSize) +
                        " has the modes 0 to " + std::to_string(basisSize - 1));
}

std::string textOf(const Values& report, int mode) {
    const auto& eigenvalues = std::get<Eigen::VectorXd>(report.at("eigenvalues"));
    const double lambda = eigenvalues[mode];
    const auto size = static_cast<int>(eigenvalues.size());
    const int wholeSize = std::get<int>(report.at("whole_size"));
    std::ostringstream text;
    text << std::setprecision(4) << "Manifold Harmonics: mode " << mode << " of " << size
         << ", eigenvalue " << lambda;
    if (lambda > 0.0) text << ", wavelength " << 2.0 * kPi / std::sqrt(lambda);
    if (wholeSize > size)
        text << "\n  the basis splits a multiple eigenvalue; basis_size = " << wholeSize
             << " would not";
    text << "\n  none of the lowest is missing: the inertia of W - sigma D counts "
         << std::get<int>(report.at("inertia_count")) << "; largest relative residual "
         << std::get<Eigen::VectorXd>(report.at("residuals")).maxCoeff();
    return text.str();
}

void choose(FilterOutput& output, const Values& given) {
    const HarmonicsCall call = callOf(harmonicsFields(), given, {});
    checkMode(call.mode, call.basisSize);
    output.text = textOf(output.report, call.mode);
    output.values = output.basis.col(call.mode);
}

FilterOutput run(const FilterInput& input, const MeshLengths& mesh, const Values& given,
                 const Progress& progress) {
    const HarmonicsCall call = callOf(harmonicsFields(), given, mesh);
    checkMode(call.mode, call.basisSize);
    ManifoldHarmonics harmonics = manifoldHarmonics(input.V, input.F, call, progress);
    FilterOutput output;
    output.report = reportOf(harmonicsEntries(), harmonics);
    output.warnings = residualWarnings(harmonics.residuals);
    output.basis = std::move(harmonics.Phi);
    choose(output, given);
    return output;
}

}  // namespace

Filter harmonicsContract() {
    return {
        "Manifold Harmonics",
        "compute_scalar_manifold_harmonic_per_vertex",
        "Computes the *manifold harmonics* of a surface, its spectral basis: standing waves from "
        "low to high frequency, like those of a drum of this shape. One of them becomes the vertex "
        "quality, in colours: red where it is positive, blue where it is negative.",
        "Vallet, L\u00e9vy: [Spectral Geometry Processing with Manifold Harmonics]"
        "(https://doi.org/10.1111/j.1467-8659.2008.01122.x), 2008",
        parametersOf(harmonicsFields()),
        describedBy(harmonicsEntries()),
        run,
        "mode",
        choose};
}

}  // namespace spectral
