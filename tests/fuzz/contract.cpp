#include "fuzz/contract.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>

#include "core/analysis/bands.h"
#include "core/laplacian/interior.h"
#include "core/laplacian/intrinsic_delaunay.h"
#include "core/mesh/creases.h"
#include "core/mesh/measures.h"
#include "fuzz/accuracy.h"

namespace spectral::fuzz {

namespace {

/// Whether all bits are equal, those of NaN included.
template <class T>
bool isSame(const T& a, const T& b) {
    return a.size() == b.size() &&
           (a.size() == 0 || std::memcmp(a.data(), b.data(),
                                         static_cast<std::size_t>(a.size()) * sizeof(a[0])) == 0);
}

bool isSame(const Outcome& a, const Outcome& b) {
    if (a.result.has_value() != b.result.has_value() || a.code != b.code) return false;
    return a.result ? isSame(numbersOf(*a.result), numbersOf(*b.result)) : a.text == b.text;
}

void checkOutcome(const Case& of, Verdict& verdict) {
    const Outcome& outcome = verdict.outcome;
    std::vector<Failure>& failures = verdict.failures;
    if (!outcome.isProgressSound) failures.push_back(failure("progress", "not in [0, 1]"));
    if (!outcome.result) {
        if (!outcome.code)
            failures.push_back(failure("foreign exception", outcome.text));
        else if (outcome.text.empty())
            failures.push_back(failure("no text", "of an error"));
        if (outcome.code == ErrorCode::Cancelled && of.cancelAt == 0)
            failures.push_back(failure("cancelled", "by nobody"));
        return;
    }
    if (of.mustThrow) failures.push_back(failure("accepted", "an option out of its range"));
    for (const double number : numbersOf(*outcome.result))
        if (!std::isfinite(number)) {
            failures.push_back(failure("not finite", "a number of the result is ", number));
            return;
        }
}

/// The weights of the intrinsic Delaunay Laplacian of any surface.
void checkWeights(const testing::Mesh& mesh, std::vector<Failure>& failures) {
    const Surface surface = joinedSurface(mesh.V, mesh.F);
    const SparseMatrix W = IntrinsicDelaunay(surface.X, surface.F).stiffness(surface.X);
    for (Index j = 0; j < W.outerSize(); ++j)
        for (SparseMatrix::InnerIterator it(W, j); it; ++it)
            if (it.row() != j && !(it.value() <= 0.0)) {
                failures.push_back(failure("weights", "W_ij = ", it.value()));
                return;
            }
}

void checkRepeated(const Case& of, Verdict& verdict) {
    if (!isSame(verdict.outcome, run(of, 1)))
        verdict.failures.push_back(failure("not repeatable", "a second run differs"));
    // Only the number of reports may depend on the threads.
    if (of.cancelAt == 0 && !isSame(verdict.outcome, run(of, 2)))
        verdict.failures.push_back(failure("depends on threads", "two threads differ from one"));
}

/// Calls work(vertex, row) for every vertex of the mesh on a surface, and its row of X.
template <class Work>
void forEachVertex(const Surface& surface, const Work& work) {
    for (Index i = 0; i < surface.X.rows(); ++i) work(surface.vertex[i], i);
    for (const auto& [vertex, row] : surface.copies) work(vertex, row);
}

void checkUnmoved(const Vertices& V, const Vertices& moved, const std::vector<bool>& mustStay,
                  std::vector<Failure>& failures) {
    for (Index i = 0; i < V.rows(); ++i) {
        const Eigen::RowVector3d before = V.row(i), after = moved.row(i);
        if (!mustStay[i] || isSame(before, after)) continue;
        failures.push_back(failure(before == after ? "negative zero" : "moved", "vertex ", i,
                                   " must stay where it is, and moves by ",
                                   (after - before).norm()));
        return;
    }
}

void checkFilter(const Case& of, const FilterOptions& options, const FilterResult& result,
                 std::vector<Failure>& failures) {
    const auto& [V, F] = of.mesh.mesh;
    if (result.V.rows() != V.rows()) {
        failures.push_back(failure("size", result.V.rows(), " of ", V.rows(), " vertices"));
        return;
    }
    const Surface surface = joinedSurface(V, F);
    const Components components = connectedComponents(surface.F, surface.X.rows());
    std::vector<bool> isFixed(surface.vertex.size(), false);
    if (options.boundary == Boundary::Fixed)
        isFixed = boundaryVertices(surface.F, surface.X.rows());
    if (options.creaseAngle > 0.0) {
        const auto onCrease = creaseVertices(surface.X, surface.F, options.creaseAngle);
        std::transform(isFixed.begin(), isFixed.end(), onCrease.begin(), isFixed.begin(),
                       std::logical_or<>());
    }
    const auto& [selected, weight] = options.part;
    std::vector<bool> isReached(static_cast<std::size_t>(components.count), selected.empty());
    std::vector<bool> hasWeight(isFixed.size(), weight.size() == 0);
    forEachVertex(surface, [&](Index vertex, Index row) {
        if (!selected.empty() && selected[vertex]) isReached[components.label[row]] = true;
        if (weight.size() > 0 && weight[vertex] > 0.0) hasWeight[row] = true;
    });
    std::vector<bool> mustStay(static_cast<std::size_t>(V.rows()), true);
    forEachVertex(surface, [&](Index vertex, Index row) {
        mustStay[vertex] = isFixed[row] || !isReached[components.label[row]] || !hasWeight[row];
    });
    checkUnmoved(V, result.V, mustStay, failures);

    const double sum = Eigen::Map<const Eigen::VectorXd>(
                           result.stepSizes.data(), static_cast<Index>(result.stepSizes.size()))
                           .sum();
    if (std::abs(sum - 1.0) > 1e-12 || result.steps != static_cast<int>(result.stepSizes.size()))
        failures.push_back(failure("step sizes", result.steps, " steps sum to ", sum));
    if (options.steps > 0 && result.steps != options.steps)
        failures.push_back(failure("step sizes", result.steps, " instead of ", options.steps));
    if (result.components != components.count)
        failures.push_back(failure("components", result.components));
    if (result.fixedVertices != std::count(isFixed.begin(), isFixed.end(), true) ||
        result.unreferencedVertices + result.joinedVertices != V.rows() - surface.X.rows())
        failures.push_back(failure("counts", "of fixed or unreferenced vertices"));

    const auto& [preserved, open, lost] = result.volumes;
    if (preserved + open + lost != (options.preserveVolume ? components.count : 0))
        failures.push_back(failure("volumes", preserved, ", ", open, ", ", lost));
    const double roundOff = 1e-15 * V.cwiseAbs().maxCoeff();
    const double before = result.volumeBefore;
    if (preserved == 1 && components.count == 1 &&
        !(std::abs(result.volumeAfter - before) <=
          1e-9 * std::abs(before) + 4.0 * roundOff * (result.areaBefore + result.areaAfter)))
        failures.push_back(failure("volumes", before, " becomes ", result.volumeAfter));
    const double moved = (result.V - V).rowwise().norm().maxCoeff();
    if (std::abs(moved - result.maxDisplacement) >
        1e-9 * moved + 4.0 * roundOff + widestCut(V, surface))
        failures.push_back(failure("displacement", moved, " instead of ", result.maxDisplacement));
}

void checkArtefacts(const Case& of, const Artefacts& result, std::vector<Failure>& failures) {
    if (result.length.size() != of.mesh.mesh.V.rows())
        failures.push_back(failure("size", result.length.size()));
    else if (result.length.minCoeff() < 0.0 || result.length.maxCoeff() != result.maximum ||
             result.rms > result.maximum * (1.0 + 1e-12))
        failures.push_back(failure("lengths", "root mean square ", result.rms, ", maximum ",
                                   result.maximum, ", largest ", result.length.maxCoeff()));
}

void checkDenoise(const Case& of, const DenoiseOptions& options, const DenoiseResult& result,
                  std::vector<Failure>& failures) {
    const auto& [V, F] = of.mesh.mesh;
    const Surface surface = joinedSurface(V, F);
    const std::vector<bool> onRim = boundaryVertices(surface.F, surface.X.rows());
    std::vector<bool> mustStay(static_cast<std::size_t>(V.rows()), true);
    forEachVertex(surface, [&](Index vertex, Index row) {
        mustStay[vertex] =
            options.strength == 0.0 || (options.boundary == Boundary::Fixed && onRim[row]);
    });
    checkUnmoved(V, result.V, mustStay, failures);
    if (result.diagnosis.spikes > 0 || result.diagnosis.kind == NoiseKind::Voxels ||
        result.diagnosis.kind == NoiseKind::Impulses)
        return;
    // Preserving volumes may add an offset of twice that size.
    const double most = std::max(6.0 * result.noiseHeight, 0.3 * result.diagnosis.noise.meanEdge) *
                        (result.volumes.preserved > 0 ? 3.0 : 1.0);
    if (!(result.maxDisplacement <= most * (1.0 + 1e-9) + 1e-15 * V.cwiseAbs().maxCoeff()))
        failures.push_back(failure("displacement", result.maxDisplacement, " of at most ", most));
}

bool isAscending(const Eigen::VectorXd& v) { return std::is_sorted(v.begin(), v.end()); }

void checkHarmonics(const Case& of, const HarmonicsOptions& options,
                    const ManifoldHarmonics& result, std::vector<Failure>& failures) {
    const Index k = options.basisSize;
    if (result.Phi.rows() != of.mesh.mesh.V.rows() || result.Phi.cols() != k ||
        result.lambda.size() != k || result.residuals.size() != k)
        failures.push_back(failure("size", result.Phi.rows(), " x ", result.Phi.cols()));
    if (result.wholeSize < k || result.inertiaCount != result.wholeSize)
        failures.push_back(failure("certificate", result.wholeSize, " harmonics of ",
                                   result.inertiaCount, " for ", k));
    if (!isAscending(result.lambda) || result.lambda.minCoeff() < 0.0)
        failures.push_back(
            failure("eigenvalues", "negative or not ascending, from ", result.lambda.minCoeff()));
}

void checkSpectrum(const GeometrySpectrum& result, std::vector<Failure>& failures) {
    const double total = result.totalEnergy, sum = result.octaveEnergies.sum();
    if (!(std::abs(sum - total) <= 1e-9 * total))
        failures.push_back(failure("energies", "octaves sum to ", sum, " of ", total));
    const double ofBasis = result.amplitudes.squaredNorm() * result.area;
    if (!(ofBasis <= total * (1.0 + 1e-6)))
        failures.push_back(failure("energies", "the basis has ", ofBasis, " of ", total));
    if (!isAscending(result.frequencies) || !isAscending(result.cumulativeEnergy) ||
        !(std::abs(result.cumulativeEnergy.tail(1)[0] - 1.0) <= 1e-9))
        failures.push_back(failure("spectrum", "frequencies or cumulative energy not ascending"));
    if (result.octaveEnergies.minCoeff() < 0.0 || !(result.featureSize99 > 0.0) ||
        !(result.featureSize50 >= result.featureSize90) ||
        !(result.featureSize90 >= result.featureSize99))
        failures.push_back(failure("spectrum", "feature sizes ", result.featureSize50, ", ",
                                   result.featureSize90, ", ", result.featureSize99));
}

/// A partition of unity, centres in their own bands.
std::vector<Failure> checkBands(const BandsOptions& options) {
    const Bands bands(options.diagonal, options.lowest, options.highest, options.perOctave);
    for (int j = 0; j < bands.count(); ++j)
        if (bands.nearest(bands.featureSize(j)) != j)
            return {failure("bands", "centre ", j, " is in another band")};
    constexpr int kFrequencies = 97;
    constexpr double kRoundOff = 1e-30;  // cos^2 of pi / 2
    for (int i = 0; i <= kFrequencies; ++i) {
        const double omega =
            0.1 * options.lowest *
            std::pow(100.0 * options.highest / options.lowest, i / double{kFrequencies});
        double sum = 0.0;
        for (int j = 0; j < bands.count(); ++j) {
            const double value = bands.window(j, omega);
            const bool isBeyond = omega > bands.end(j) * (1.0 + 1e-9);
            if (value < 0.0 || value > 1.0 || (isBeyond && value > kRoundOff))
                return {failure("bands", "window ", j, " is ", value)};
            sum += value;
        }
        if (std::abs(sum - 1.0) > 1e-12) return {failure("bands", "sum to ", sum)};
    }
    return {};
}

/// Checks what a result promises, for each kind of options.
struct CheckResult {
    const Case& of;
    Verdict& verdict;
    bool compares;

    void operator()(const FilterOptions& options) const {
        const auto& result = std::get<FilterResult>(*verdict.outcome.result);
        checkFilter(of, options, result, verdict.failures);
        compare(options, result);
    }
    void operator()(const ArtefactOptions& options) const {
        const auto& result = std::get<Artefacts>(*verdict.outcome.result);
        checkArtefacts(of, result, verdict.failures);
        compare(options, result);
    }
    void operator()(const HarmonicsOptions& options) const {
        const auto& result = std::get<ManifoldHarmonics>(*verdict.outcome.result);
        checkHarmonics(of, options, result, verdict.failures);
        compare(options, result);
    }
    void operator()(const SpectrumOptions& options) const {
        const auto& result = std::get<GeometrySpectrum>(*verdict.outcome.result);
        checkSpectrum(result, verdict.failures);
        compare(options, result);
    }
    void operator()(const DenoiseOptions& options) const {
        checkDenoise(of, options, std::get<DenoiseResult>(*verdict.outcome.result),
                     verdict.failures);
    }
    void operator()(const BandsOptions&) const {}

  private:
    template <class OptionsOf, class ResultOf>
    void compare(const OptionsOf& options, const ResultOf& result) const {
        if (compares) compareWithDense(of.mesh.mesh, options, result, verdict);
    }
};

}  // namespace

Verdict check(const Case& of, bool compares) {
    Verdict verdict;
    if (const auto* bands = std::get_if<BandsOptions>(&of.options)) {
        verdict.failures = checkBands(*bands);
        return verdict;
    }
    const testing::Mesh before = of.mesh.mesh;
    verdict.outcome = run(of, 1);
    if (!isSame(before.V, of.mesh.mesh.V) || !isSame(before.F, of.mesh.mesh.F))
        verdict.failures.push_back(failure("input", "has been changed"));
    checkOutcome(of, verdict);
    if (of.repeats) checkRepeated(of, verdict);
    if (verdict.outcome.result && verdict.failures.empty())
        std::visit(CheckResult{of, verdict, compares}, of.options);
    if (verdict.outcome.result) checkWeights(of.mesh.mesh, verdict.failures);
    return verdict;
}

double widestCut(const Vertices& V, const Surface& surface) {
    double widest = 0.0;
    for (const auto& [vertex, row] : surface.copies)
        widest = std::max(widest, (V.row(vertex) - V.row(surface.vertex[row])).norm());
    return widest;
}

}  // namespace spectral::fuzz
