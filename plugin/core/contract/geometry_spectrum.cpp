#include "core/analysis/geometry_spectrum.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>
#include <vector>

#include "core/contract/common_fields.h"
#include "core/contract/filters.h"
#include "core/contract/noise_text.h"
#include "core/contract/number_text.h"
#include "core/contract/report.h"
#include "core/contract/surface_report.h"

namespace spectral {

namespace {

Fields<SpectrumOptions> spectrumFields() {
    using Call = SpectrumOptions;
    return {
        field<Call>(&Call::basisSize, "basis_size", "Basis size",
                    "Number of the largest features (manifold harmonics, constant ones included) "
                    "that are also computed individually, for scripts that need them; this takes "
                    "most of the time. The octaves cover all features in any case. On a small "
                    "mesh, all harmonics are computed.")
            .in("number of harmonics"),
        laplacianField<Call>(&Call::laplacian),
        boundaryField<Call>(&Call::boundary,
                            "*free*: it is part of the shape. *fixed*: only the details that it "
                            "does not determine are measured."),
    };
}

Entries<GeometrySpectrum> spectrumEntries() {
    using R = GeometrySpectrum;
    return {
        {"diagonal", "of the bounding box, length", &R::diagonal},
        {"mean_edge", "mean edge, length", &R::meanEdge},
        {"default_feature_size", "default of `feature_size` for this mesh, length",
         [](const R& r) -> Value { return defaultFeatureSize(r.meanEdge, r.surfaceDiagonal); }},
        {"area", "of the surface, length²", &R::area},
        {"total_energy", "integral of the squared length of the shape over the surface, length⁴",
         &R::totalEnergy},
        {"frequencies", "of the lowest harmonics, ascending, radians per length; 0 for constants",
         &R::frequencies},
        {"amplitudes", "amplitudes of the harmonics of `frequencies`, length; 0 for constants",
         &R::amplitudes},
        {"octave_feature_sizes", "centres of the octaves, descending, length",
         &R::octaveFeatureSizes},
        {"octave_energies", "energies of the octaves, length⁴", &R::octaveEnergies},
        {"octave_amplitudes",
         "amplitudes of the octaves, root mean square over the surface, length",
         &R::octaveAmplitudes},
        {"cumulative_energy",
         "share of the energy in each octave and all larger ones, ascending to 1",
         &R::cumulativeEnergy},
        {"band_feature_sizes",
         "centres of the third octaves with at least 30 harmonics, descending, length",
         &R::bandFeatureSizes},
        {"band_amplitudes", "amplitudes of the third octaves of `band_feature_sizes`, length",
         &R::bandAmplitudes},
        {"band_noise",
         "amplitudes that white noise of height 1 at the vertices has in these third octaves",
         &R::bandNoise},
        {"noise_height", "of the noise that was filtered or found, length; 0: none",
         [](const R& r) -> Value {
             return r.diagnosis.isNoise() ? r.diagnosis.noise.height : 0.0;
         }},
        {"noise_feature_size",
         "in details smaller than this there is more noise than shape, length; 0: in none",
         &R::noiseFeatureSize},
        {"feature_size_50", "half of the energy is in features of at least this size, length",
         &R::featureSize50},
        {"feature_size_90", "90 % of the energy is in features of at least this size, length",
         &R::featureSize90},
        {"feature_size_99", "99 % of the energy is in features of at least this size, length",
         &R::featureSize99},
        {"mismatch",
         "share of the energy that may belong to other octaves; above 0.01 with a warning",
         &R::mismatch},
    };
}

/// A bar for an amplitude, 12 cells at `largest`, three less for each factor of ten: bars begin at
/// the left edge, so that they are a chart in MeshLab's log, too, whose letters differ in width.
std::string barOf(double amplitude, double largest) {
    constexpr double kCells = 12.0, kDecades = 4.0;
    if (amplitude <= 0.0) return {};
    const double length = kCells * (1.0 + std::log10(amplitude / largest) / kDecades);
    std::string bar;
    for (long cell = std::max(1L, std::lround(length)); cell > 0; --cell) bar += "\u2588";
    return bar;
}

std::string textOf(const GeometrySpectrum& spectrum, const std::string& noise) {
    const auto size = [&](double length) { return lengthText(length, 4, spectrum.diagonal); };
    std::ostringstream text;
    text << "Geometry Spectrum: to smooth, try feature size "
         << size(spectrum.noiseFeatureSize > 0.0
                     ? spectrum.noiseFeatureSize
                     : defaultFeatureSize(spectrum.meanEdge, spectrum.surfaceDiagonal))
         << "\n  half of the shape's energy is in details of at least "
         << size(spectrum.featureSize50) << ", 90 % in those of at least "
         << size(spectrum.featureSize90) << ", 99 % " << size(spectrum.featureSize99)
         << "; percent are of the diagonal";
    text << "\n  " << noise;
    if (spectrum.diagnosis.isNoise()) text << ": Spectral Denoise removes it";
    if (spectrum.noiseFeatureSize > 0.0)
        text << ". It is more than the shape in details smaller than "
             << size(spectrum.noiseFeatureSize);
    text << "\n  root mean square height of the details of each size, bars in logarithmic scale:";
    const double largest =
        spectrum.octaveAmplitudes.size() > 0 ? spectrum.octaveAmplitudes.maxCoeff() : 0.0;
    for (Eigen::Index j = 0; j < spectrum.octaveEnergies.size(); ++j)
        text << "\n  " << barOf(spectrum.octaveAmplitudes[j], largest) << ' '
             << std::setprecision(3) << spectrum.octaveAmplitudes[j] << " at "
             << size(spectrum.octaveFeatureSizes[j]);
    return text.str();
}

Warnings warningsOf(const GeometrySpectrum& spectrum) {
    constexpr double kAccurate = 0.01;
    if (spectrum.mismatch <= kAccurate) return {};
    return {{WarningCode::MixedSizes,
             "up to " + numberText(100.0 * std::min(1.0, spectrum.mismatch), 3) +
                 " % of the energy may belong to other sizes: the mesh has needle triangles, or "
                 "parts far away"}};
}

FilterOutput run(const FilterInput& input, const MeshLengths& mesh, const Values& given,
                 const Progress& progress) {
    const SpectrumOptions options = callOf(spectrumFields(), given, mesh);
    const GeometrySpectrum spectrum = geometrySpectrum(input.V, input.F, options, progress);
    FilterOutput output;
    output.report = reportOf(spectrumEntries(), spectrum);
    output.summary = diagnosisText(spectrum.diagnosis);
    output.text = textOf(spectrum, output.summary);
    output.warnings = warningsOf(spectrum);
    append(percentageWarnings(mesh), output.warnings);
    return output;
}

}  // namespace

Filter geometrySpectrumContract() {
    return {
        "Geometry Spectrum",
        "get_geometry_spectrum",
        "Measures how much of a shape lies in details of each size, and where noise begins: use "
        "it to *choose a feature size* for the spectral filters. The log charts the root mean "
        "square height of the details in each octave of sizes; no vertex moves.",
        "",
        parametersOf(spectrumFields()),
        describedBy(spectrumEntries()),
        run};
}

}  // namespace spectral
