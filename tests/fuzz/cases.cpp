#include "fuzz/cases.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "core/mesh/measures.h"
#include "core/support/frequency.h"
#include "core/support/threads.h"
#include "core/transfer/custom_gain.h"
#include "support/evaluation.h"

namespace spectral::fuzz {

namespace {

LaplacianKind kindOf(Choices& choices) {
    return choices.oneIn(3) ? LaplacianKind::Cotangent : LaplacianKind::IntrinsicDelaunay;
}

Boundary boundaryOf(Choices& choices) {
    return choices.oneIn(3) ? Boundary::Fixed : Boundary::Free;
}

double featureSizeOf(Choices& choices, double diagonal) {
    const double share =
        choices.oneIn(3) ? choices.logUniform(1e-9, 1e3) : choices.logUniform(0.01, 1.0);
    return share * diagonal;
}

/// From 1 to beyond the number of vertices.
int basisSizeOf(Choices& choices, Index vertices) {
    const auto n = static_cast<int>(vertices);
    switch (choices.below(4)) {
        case 0: return choices.between(1, 12);
        case 1: return choices.between(std::max(1, n - 3), n + 3);
        default: return choices.between(1, std::max(2, n));
    }
}

TransferFunctionOptions transferFunctionOf(Choices& choices) {
    TransferFunctionOptions options;
    options.type = static_cast<FilterType>(choices.below(4));
    options.response = choices.oneIn(6) ? Response::Ideal : static_cast<Response>(choices.below(2));
    options.order = choices.pick({1, 2, 2, 4, 8, 64});
    options.bandWidth =
        choices.oneIn(3) ? choices.logUniform(0.02, 0.1) : choices.logUniform(0.1, 4.0);
    options.passGain = choices.pick({1.0, 1.0, 0.0, 0.5, 2.0, 3.0});
    options.stopGain = choices.pick({0.0, 0.0, 0.05, 1.0, 1.0, 3.0});
    options.power = choices.pick({1.0, 1.0, 1.0, 0.5, 0.01});
    return options;
}

/// Puts one option out of its range.
void spoil(Choices& choices, FilterOptions& options) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    TransferFunctionOptions& F = options.transferFunction;
    switch (choices.below(9)) {
        case 0: options.featureSize = choices.pick({0.0, -1.0, kNan, kInfinity}); return;
        case 1: options.steps = -1; return;
        case 2:
            options.steps = 0;
            options.tolerance = choices.pick({-1e-9, -1.0, kNan, kInfinity});
            return;
        case 3: options.conformalShare = choices.pick({-0.1, 1.1, kNan}); return;
        case 4: F.order = choices.pick({0, -1, 65}); return;
        case 5: F.bandWidth = choices.pick({0.0, -1.0, kNan, kInfinity}); return;
        case 6: F.passGain = choices.pick({-1.0, kNan, kInfinity}); return;
        case 7: F.stopGain = choices.pick({-1e-9, kNan, kInfinity}); return;
        default: F.power = choices.pick({0.0, -1.0, 1.5, kNan}); return;
    }
}

FilterOptions filterOptions(Choices& choices, double diagonal, Index vertices) {
    FilterOptions options;
    options.transferFunction = transferFunctionOf(choices);
    options.featureSize = featureSizeOf(choices, diagonal);
    options.steps = choices.pick({0, 0, 1, 1, 1, 1, 2, 3, 12});
    options.tolerance = choices.logUniform(1e-8, 0.1) * diagonal;
    options.laplacian = kindOf(choices);
    options.basisUpdate = static_cast<BasisUpdate>(choices.below(3));
    options.conformalShare = choices.pick({0.0, 0.0, 0.1, 1.0});
    options.boundary = boundaryOf(choices);
    if (choices.oneIn(4)) options.evaluation.spectrum = Spectrum::Truncated;
    options.evaluation.truncation.basisSize = basisSizeOf(choices, vertices);
    options.evaluation.truncation.reinjectResidual = !choices.oneIn(3);
    return options;
}

double sizeOf(Choices& choices) { return choices.logUniform(1e-3, 200.0); }

/// A transfer function as a user may write it; some are negative or infinite somewhere.
std::string gainText(Choices& choices) {
    std::ostringstream text;
    const double a = choices.uniform(0.0, 3.0), b = choices.logUniform(1e-3, 30.0);
    switch (choices.below(8)) {
        case 0: text << "1 / (1 + " << b << " * w^" << choices.between(1, 8) << ")"; break;
        case 1: text << a << " + exp(-" << b << " * l / f)"; break;
        case 2: text << "w < " << b << " ? " << a << " : " << choices.pick({0.0, 0.5, 1.0}); break;
        case 3: text << "1 + " << a / 3.0 << " * sin(" << b << " * log2(w + 1e-9))"; break;
        case 4: text << a << " - log(w / " << b << ")"; break;
        default:
            for (int i = choices.between(1, 6); i > 0; --i)
                text << sizeOf(choices) << choices.pick({"%", "%", "e"}) << ":"
                     << choices.pick({0.0, 0.01, 0.5, 1.0, 1.0, 2.0, 4.0}) << (i > 1 ? "," : "");
    }
    return text.str();
}

std::vector<bool> selectionOf(Choices& choices, Index vertices) {
    const int n = static_cast<int>(std::min<Index>(vertices, 65536));
    std::vector<bool> selected(static_cast<std::size_t>(vertices), choices.oneIn(8));
    const int from = n > 0 ? choices.below(n) : 0, until = n > 0 ? choices.between(from, n) : 0;
    for (int i = from; i < until; ++i) selected[i] = true;
    return selected;
}

/// A list of numbers, in order.
class Numbers {
  public:
    Numbers& operator<<(double x) {
        all.push_back(x);
        return *this;
    }
    template <class Derived>
    Numbers& operator<<(const Eigen::DenseBase<Derived>& X) {
        all.push_back(static_cast<double>(X.size()));
        for (Index j = 0; j < X.cols(); ++j)
            for (Index i = 0; i < X.rows(); ++i) all.push_back(X(i, j));
        return *this;
    }
    std::vector<double> all;
};

void append(const FilterResult& r, Numbers& to) {
    to << r.V << r.steps << r.cutoffFrequency << r.featureSize << r.maxDisplacement
       << r.rmsDisplacement << r.areaBefore << r.areaAfter << r.volumeBefore << r.volumeAfter
       << r.components << r.unreferencedVertices << r.fixedVertices << r.factorizations << r.solves
       << r.accuracy << r.errorEstimate << r.accuracyReached << r.stepError << r.toleranceReached
       << r.singularPart << r.cutoffReached << r.eigenvalues << r.residuals << r.inertiaCount
       << r.computedBases << r.volumes.preserved << r.volumes.open << r.volumes.lost;
    for (const double alpha : r.stepSizes) to << alpha;
}

void append(const Artefacts& r, Numbers& to) {
    to << r.rms << r.maximum << r.length << r.errorEstimate;
}

void append(const ManifoldHarmonics& r, Numbers& to) {
    to << r.lambda << r.Phi << r.wholeSize << r.residuals << r.inertiaCount;
}

void append(const GeometrySpectrum& r, Numbers& to) {
    to << r.diagonal << r.meanEdge << r.area << r.totalEnergy << r.frequencies << r.amplitudes
       << r.octaveFeatureSizes << r.octaveEnergies << r.octaveAmplitudes << r.cumulativeEnergy
       << r.featureSize50 << r.featureSize90 << r.featureSize99 << r.bandFeatureSizes
       << r.bandAmplitudes << r.bandNoise << r.diagnosis.noise.height << r.noiseFeatureSize
       << r.mismatch;
}

void append(const DenoiseResult& r, Numbers& to) {
    const NoiseEstimate& noise = r.diagnosis.noise;
    to << r.V << noise.height << noise.size << noise.correlation << noise.meanEdge << r.noiseHeight
       << r.noiseSize << static_cast<double>(r.diagnosis.spikes) << r.rounds << r.maxDisplacement
       << r.rmsDisplacement << r.volumeBefore << r.volumeAfter << r.volumes.preserved;
}

const char* nameOf(LaplacianKind kind) {
    return kind == LaplacianKind::Cotangent ? "cotangent" : "delaunay";
}
const char* nameOf(Boundary boundary) { return boundary == Boundary::Fixed ? "fixed" : "free"; }

/// Writes the options of each entry point; feature sizes in diagonals.
struct Describe {
    std::ostream& text;
    double diagonal;

    void operator()(const FilterOptions& o) const {
        const char* updates[] = {"full", "conformal", "none"};
        text << "filter " << testing::describe(o.transferFunction) << " power "
             << o.transferFunction.power << ", size " << o.featureSize / diagonal << ", steps "
             << o.steps << ", passes " << o.passes << (o.keepThinParts ? ", thin parts kept" : "")
             << ", tolerance " << o.tolerance / diagonal << ", " << nameOf(o.laplacian) << ", "
             << nameOf(o.boundary) << ", update " << updates[static_cast<int>(o.basisUpdate)]
             << " share " << o.conformalShare;
        if (o.evaluation.spectrum == Spectrum::Truncated)
            text << ", truncated to " << o.evaluation.truncation.basisSize
                 << (o.evaluation.truncation.reinjectResidual ? "" : " without residual");
        if (!o.part.selected.empty())
            text << ", " << std::count(o.part.selected.begin(), o.part.selected.end(), true)
                 << " selected";
        if (o.part.weight.size() > 0)
            text << ", weights " << o.part.weight.minCoeff() << " to " << o.part.weight.maxCoeff();
        if (o.creaseAngle != 0.0) text << ", creases " << o.creaseAngle;
        if (o.preserveVolume) text << ", volume preserved";
    }
    void operator()(const ArtefactOptions& o) const {
        text << "artefacts, size " << o.featureSize / diagonal << ", " << nameOf(o.laplacian);
    }
    void operator()(const HarmonicsOptions& o) const {
        text << "harmonics " << o.basisSize << ", " << nameOf(o.laplacian) << ", "
             << nameOf(o.boundary);
    }
    void operator()(const SpectrumOptions& o) const {
        text << "spectrum " << o.basisSize << ", " << nameOf(o.laplacian) << ", "
             << nameOf(o.boundary);
    }
    void operator()(const BandsOptions& o) const {
        text << "bands " << o.lowest << " to " << o.highest << ", " << o.perOctave
             << " per octave, diagonal " << o.diagonal;
    }
    void operator()(const DenoiseOptions& o) const {
        text << "denoise, strength " << o.strength << ", noise " << o.noiseHeight / diagonal
             << " of size " << o.noiseSize / diagonal << (o.selected.empty() ? "" : ", selected")
             << (o.keepCreases ? "" : ", creases smoothed") << ", " << nameOf(o.boundary);
    }
};

/// Calls the entry point of each kind of options.
struct Call {
    const testing::Mesh& mesh;
    const Progress& progress;

    Result operator()(const FilterOptions& o) const {
        return fractionalFilter(mesh.V, mesh.F, o, progress);
    }
    Result operator()(const ArtefactOptions& o) const {
        return measureArtefacts(mesh.V, mesh.F, o, progress);
    }
    Result operator()(const HarmonicsOptions& o) const {
        return manifoldHarmonics(mesh.V, mesh.F, o, progress);
    }
    Result operator()(const SpectrumOptions& o) const {
        return geometrySpectrum(mesh.V, mesh.F, o, progress);
    }
    Result operator()(const DenoiseOptions& o) const {
        return denoise(mesh.V, mesh.F, o, progress);
    }
    Result operator()(const BandsOptions&) const { return {}; }
};

}  // namespace

Case makeCase(Choices& choices, Sizes sizes) {
    Case made;
    made.repeats = choices.oneIn(8);
    if (choices.oneIn(50)) made.cancelAt = choices.between(1, 20);
    const int entry = choices.below(20);
    if (entry == 19) {
        BandsOptions bands{choices.logUniform(1e-60, 1e75), choices.logUniform(1e-3, 1.0), 1.0,
                           choices.pick({1, 3, 12})};
        bands.lowest /= bands.diagonal;
        bands.highest = bands.lowest * choices.logUniform(1.0, 1e9);
        made.options = bands;
        return made;
    }
    made.mesh = makeMesh(choices, sizes);
    const Vertices& V = made.mesh.mesh.V;
    double diagonal = V.rows() > 0 ? boundingBoxDiagonal(V) : 1.0;
    if (!(std::isfinite(diagonal) && diagonal > 0.0)) diagonal = 1.0;
    if (entry < 12) {
        FilterOptions filter = filterOptions(choices, diagonal, V.rows());
        made.mustThrow = choices.oneIn(40);
        if (made.mustThrow) spoil(choices, filter);
        made.options = filter;
    } else if (entry < 14) {
        made.options = ArtefactOptions{featureSizeOf(choices, diagonal), kindOf(choices)};
    } else if (entry < 17) {
        const int size = basisSizeOf(choices, V.rows());
        const LaplacianKind kind = kindOf(choices);
        made.options = HarmonicsOptions{size, kind, boundaryOf(choices)};
    } else {
        const int size = basisSizeOf(choices, V.rows());
        const LaplacianKind kind = kindOf(choices);
        made.options = SpectrumOptions{size, kind, boundaryOf(choices)};
    }
    return made;
}

Case makeDenoiseCase(Choices& choices) {
    Case made;
    made.repeats = choices.oneIn(4);
    if (choices.oneIn(50)) made.cancelAt = choices.between(1, 12);
    made.mesh = makeMesh(choices, choices.oneIn(4) ? Sizes::Any : Sizes::MostlySmall);
    const Vertices& V = made.mesh.mesh.V;
    const double diagonal = V.rows() > 0 ? boundingBoxDiagonal(V) : 1.0;
    DenoiseOptions options;
    options.strength = choices.pick({0.0, 1.0, 1.0, 0.5, 3.0, 1e3});
    if (!choices.oneIn(3))  // few vertices do not reveal the noise
        options.noiseHeight = choices.logUniform(1e-4, 10.0) * diagonal;
    if (choices.oneIn(3)) options.noiseSize = choices.logUniform(1e-4, 10.0) * diagonal;
    if (V.rows() > 0 && choices.oneIn(4))
        for (Index i = 0; i < V.rows(); ++i) options.selected.push_back(i == 0 || choices.oneIn(2));
    options.keepCreases = !choices.oneIn(3);
    options.boundary = boundaryOf(choices);
    made.mustThrow = choices.oneIn(40);
    if (made.mustThrow) options.strength = choices.pick({-1.0, std::nan(""), HUGE_VAL});
    made.options = options;
    return made;
}

void addPart(Choices& choices, Case& to) {
    auto* const options = std::get_if<FilterOptions>(&to.options);
    if (options == nullptr) return;
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    const auto& [V, F] = to.mesh.mesh;
    to.gain = choices.oneIn(2) ? gainText(choices) : "";
    const bool isMesh = V.rows() > 0 && V.allFinite() && F.rows() > 0 && F.minCoeff() >= 0 &&
                        F.maxCoeff() < V.rows();
    if (!to.gain.empty() && isMesh && options->featureSize > 0.0) try {
            const CustomGain gain = parseGain(to.gain, cutoffFrequency(options->featureSize),
                                              {boundingBoxDiagonal(V), meanEdgeLength(V, F)});
            options->transferFunction.type = FilterType::Custom;
            options->transferFunction.custom = gain.gain;
            options->featureSize = 2.0 * kPi / gain.cutoff;
        } catch (const Error&) {  // two points of equal size, or a mesh of size 0
        }
    if (choices.oneIn(3)) options->part.selected = selectionOf(choices, V.rows());
    if (choices.oneIn(3)) {
        options->part.weight = Eigen::VectorXd::Constant(V.rows(), choices.uniform(0.0, 1.0));
        for (double& w : options->part.weight)
            if (choices.oneIn(3)) w = choices.pick({0.0, 1.0, 0.5, 1e-300});
        if (V.rows() > 0 && choices.oneIn(10))
            options->part.weight[V.rows() / 2] = choices.pick({kNan, -0.1, 1.0001});
    }
    if (choices.oneIn(3))
        options->creaseAngle = choices.pick({10.0, 30.0, 40.0, 60.0, 90.0, 179.0, 180.0, 1e-30});
    if (choices.oneIn(40)) options->creaseAngle = choices.pick({-1.0, 180.1, kNan});
    options->preserveVolume = choices.oneIn(3);
    const std::vector<bool>& selected = options->part.selected;
    const Eigen::VectorXd& weight = options->part.weight;
    to.mustThrow |=
        !(options->creaseAngle >= 0.0 && options->creaseAngle <= 180.0) ||
        !((weight.array() >= 0.0) && (weight.array() <= 1.0)).all() ||
        (!selected.empty() && std::find(selected.begin(), selected.end(), true) == selected.end());
    // Last, so that seeds keep their cases.
    options->keepThinParts = choices.oneIn(2);
    if (choices.oneIn(6)) options->passes = choices.between(1, 4);
}

std::string describe(const Case& of) {
    const testing::Mesh& mesh = of.mesh.mesh;
    std::ostringstream text;
    text.precision(4);
    double diagonal = mesh.V.rows() > 0 ? boundingBoxDiagonal(mesh.V) : 1.0;
    if (!(std::isfinite(diagonal) && diagonal > 0.0)) diagonal = 1.0;
    if (!std::holds_alternative<BandsOptions>(of.options))
        text << of.mesh.name << " (" << mesh.V.rows() << " vertices, " << mesh.F.rows()
             << " triangles); ";
    std::visit(Describe{text, diagonal}, of.options);
    if (!of.gain.empty()) text << ", gain " << of.gain;
    if (of.mustThrow) text << ", an option out of range";
    if (of.cancelAt > 0) text << ", cancelled at report " << of.cancelAt;
    return text.str();
}

Outcome run(const Case& of, int threads) {
    setThreadCount(threads);
    Outcome outcome;
    int reports = 0;
    const Progress progress([&](double fraction, const std::string&) {
        if (!(fraction >= 0.0 && fraction <= 1.0)) outcome.isProgressSound = false;
        return ++reports != of.cancelAt;
    });
    try {
        outcome.result = std::visit(Call{of.mesh.mesh, progress}, of.options);
    } catch (const Error& error) {
        outcome.code = error.code();
        outcome.text = error.what();
    } catch (const std::exception& error) {
        outcome.text = error.what();
    } catch (...) {
        outcome.text = "not an exception";
    }
    return outcome;
}

std::vector<double> numbersOf(const Result& result) {
    Numbers numbers;
    std::visit([&](const auto& r) { append(r, numbers); }, result);
    return numbers.all;
}

}  // namespace spectral::fuzz
