#include <common/parameters/rich_parameters.h>

#include <algorithm>
#include <iomanip>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/analysis/geometry_spectrum.h"
#include "core/mesh/measures.h"
#include "core/support/steady_progress.h"
#include "core/transfer/transfer_function.h"
#include "meshlab/filters/common_parameters.h"
#include "meshlab/filters/surface_report.h"
#include "meshlab/mesh_conversion.h"
#include "meshlab/mesh_filter.h"

namespace {

using spectral::GeometrySpectrum;

const char* const kGeometrySpectrumHelp =
    "Measures how much of a shape lies in details of each size, and where noise begins: use it to "
    "<b>choose a feature size</b>. The log lists the root mean square height of the details in "
    "each octave of sizes; no vertex moves.";

RichParameterList geometrySpectrumParameters(const MeshModel&) {
    RichParameterList list;
    list.addParam(
        RichInt("basis_size", spectral::SpectrumOptions().basisSize, "Basis size",
                "Number of the largest features (manifold harmonics, constant ones included) that "
                "are also computed individually, for scripts that need them; this takes most of "
                "the time. The octaves cover all features in any case. On a small mesh, all "
                "harmonics are computed."));
    list.addParam(laplacianParameter());
    list.addParam(
        boundaryParameter("<b>free</b>: it is part of the shape. <b>fixed</b>: only the details "
                          "that it does not determine are measured."));
    return list;
}

/// A length, also as a percentage of the diagonal.
std::string withPercent(double length, double diagonal) {
    std::ostringstream text;
    text << std::setprecision(4) << length << " (" << std::setprecision(3)
         << 100.0 * length / diagonal << " %)";
    return text.str();
}

std::string textOf(const GeometrySpectrum& spectrum) {
    std::ostringstream text;
    text << std::setprecision(4) << "Geometry Spectrum: octaves of all details";
    if (spectrum.frequencies.size() > 0)
        text << ", and " << spectrum.frequencies.size() << " harmonics";
    text << "; in brackets: percent of the diagonal, " << spectrum.diagonal << "; energy: of this "
         << "size and all larger ones\n"
         << std::left << "  " << std::setw(20) << "feature size" << std::setw(11) << "amplitude"
         << "energy";
    // Narrow enough for MeshLab's log, which would wrap the lines.
    for (Eigen::Index j = 0; j < spectrum.octaveEnergies.size(); ++j)
        text << "\n  " << std::setw(20)
             << withPercent(spectrum.octaveFeatureSizes[j], spectrum.diagonal) << std::setw(11)
             << std::setprecision(3) << spectrum.octaveAmplitudes[j] << std::fixed
             << std::setprecision(5) << 100.0 * spectrum.cumulativeEnergy[j] << " %"
             << std::defaultfloat;
    if (spectrum.noiseHeight > 0.0)
        text << "\n  details smaller than "
             << withPercent(spectrum.noiseFeatureSize, spectrum.diagonal)
             << " look like vertex noise, with a root mean square height of "
             << withPercent(spectrum.noiseHeight, spectrum.diagonal);
    text << "\n  50 % of the energy at feature sizes of at least "
         << withPercent(spectrum.featureSize50, spectrum.diagonal) << ", 90 % "
         << withPercent(spectrum.featureSize90, spectrum.diagonal) << ", 99 % "
         << withPercent(spectrum.featureSize99, spectrum.diagonal);
    return text.str();
}

std::vector<std::string> warningsOf(const GeometrySpectrum& spectrum) {
    constexpr double kAccurate = 0.01;
    if (spectrum.mismatch <= kAccurate) return {};
    std::ostringstream text;
    text << std::setprecision(3) << "up to " << 100.0 * std::min(1.0, spectrum.mismatch)
         << " % of the energy may belong to other sizes: the mesh has needle triangles, or parts "
            "far away";
    return {text.str()};
}

FilterOutcome applyGeometrySpectrum(const RichParameterList& parameters, MeshModel& mesh,
                                    const spectral::Progress& progress) {
    const MeshMatrices input = toMatrices(mesh.cm);
    spectral::SpectrumOptions options;
    options.basisSize = parameters.getInt("basis_size");
    options.laplacian = laplacianKind(parameters);
    options.boundary = boundaryCondition(parameters);
    const GeometrySpectrum spectrum = spectral::withSteadyProgress(
        progress, spectral::geometrySpectrum, input.V, input.F, options);
    std::vector<std::string> warnings = warningsOf(spectrum);
    append(percentageWarnings(input), warnings);
    return {{{"diagonal", spectrum.diagonal},
             {"mean_edge", spectrum.meanEdge},
             {"default_feature_size",
              spectral::defaultFeatureSize(spectrum.meanEdge, spectrum.surfaceDiagonal)},
             {"area", spectrum.area},
             {"total_energy", spectrum.totalEnergy},
             {"frequencies", QVariant::fromValue(spectrum.frequencies)},
             {"amplitudes", QVariant::fromValue(spectrum.amplitudes)},
             {"octave_feature_sizes", QVariant::fromValue(spectrum.octaveFeatureSizes)},
             {"octave_energies", QVariant::fromValue(spectrum.octaveEnergies)},
             {"octave_amplitudes", QVariant::fromValue(spectrum.octaveAmplitudes)},
             {"cumulative_energy", QVariant::fromValue(spectrum.cumulativeEnergy)},
             {"band_feature_sizes", QVariant::fromValue(spectrum.bandFeatureSizes)},
             {"band_amplitudes", QVariant::fromValue(spectrum.bandAmplitudes)},
             {"band_noise", QVariant::fromValue(spectrum.bandNoise)},
             {"noise_height", spectrum.noiseHeight},
             {"noise_feature_size", spectrum.noiseFeatureSize},
             {"feature_size_50", spectrum.featureSize50},
             {"feature_size_90", spectrum.featureSize90},
             {"feature_size_99", spectrum.featureSize99},
             {"mismatch", spectrum.mismatch}},
            textOf(spectrum),
            std::move(warnings)};
}

}  // namespace

MeshFilter geometrySpectrumMeshFilter() {
    return {"Geometry Spectrum",   "get_geometry_spectrum", kGeometrySpectrumHelp,
            FilterPlugin::Measure, MeshModel::MM_NONE,      geometrySpectrumParameters,
            applyGeometrySpectrum};
}
