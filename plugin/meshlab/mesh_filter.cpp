#include "meshlab/mesh_filter.h"

#include <common/mlexception.h>
#include <vcg/complex/algorithms/update/color.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/mesh/measures.h"

namespace {

using spectral::FilterOutput;
using spectral::Values;

constexpr int kMovesVertices =
    MeshModel::MM_VERTCOORD | MeshModel::MM_VERTNORMAL | MeshModel::MM_FACENORMAL;

/// Vertex attribute that holds the details.
const char* const kDetails = "spectral_details";

/// Prefix of the names of the vertex attributes that hold harmonics, followed by the mode.
const char* const kHarmonic = "harmonic_";

void writePositions(const MeshMatrices& input, const Values&, FilterOutput& output,
                    MeshModel& mesh) {
    if (output.V.rows() > 0) setPositions(input, output.V, mesh);
    if (output.details.rows() == 0) return;
    setDetails(input.vertexIndex, kDetails, output.details, mesh);
    output.text +=
        std::string(
            "\n  no vertex has moved: the details are stored as the vertex quality and the "
            "attribute ") +
        kDetails;
}

void writeQuality(const MeshMatrices& input, const Values&, FilterOutput& output, MeshModel& mesh) {
    setQuality(input.vertexIndex, output.values, mesh);
}

void writeColors(const MeshMatrices& input, const Values&, FilterOutput& output, MeshModel& mesh) {
    mesh.updateDataMask(MeshModel::MM_VERTCOLOR);
    for (Eigen::Index i = 0; i < output.values.rows(); ++i)
        for (int c = 0; c < 3; ++c)
            mesh.cm.vert[input.vertexIndex[i]].C()[c] =
                static_cast<unsigned char>(output.values(i, c));
}

/// The length of the artefacts as quality, in colours from 0 to the largest.
void writeArtefacts(const MeshMatrices& input, const Values&, FilterOutput& output,
                    MeshModel& mesh) {
    setQuality(input.vertexIndex, output.values, mesh);
    mesh.updateDataMask(MeshModel::MM_VERTCOLOR);
    vcg::tri::UpdateColor<CMeshO>::PerVertexQualityRamp(
        mesh.cm, 0, static_cast<Scalarm>(output.values.maxCoeff()));
}

/// @param t  in [-1, 1].
vcg::Color4b blueWhiteRed(double t) {
    const auto faded =
        static_cast<unsigned char>(std::lround(255.0 * (1.0 - std::min(std::abs(t), 1.0))));
    return t < 0.0 ? vcg::Color4b(faded, faded, 255, 255) : vcg::Color4b(255, faded, faded, 255);
}

/// One harmonic as quality, in colours: blue below 0, white at 0, red above; full colour at the
/// extreme.
void writeHarmonics(const MeshMatrices& input, const Values& given, FilterOutput& output,
                    MeshModel& mesh) {
    if (std::get<bool>(given.at("store_basis")))
        setAttributes(input.vertexIndex, kHarmonic, output.basis, mesh);
    setQuality(input.vertexIndex, output.values, mesh);
    mesh.updateDataMask(MeshModel::MM_VERTCOLOR);
    const double extreme = output.values.cwiseAbs().maxCoeff();
    const double scale = extreme > 0.0 ? 1.0 / extreme : 0.0;
    for (std::size_t i = 0; i < input.vertexIndex.size(); ++i)
        mesh.cm.vert[input.vertexIndex[i]].C() =
            blueWhiteRed(scale * output.values(static_cast<Eigen::Index>(i), 0));
}

void writeNothing(const MeshMatrices&, const Values&, FilterOutput&, MeshModel&) {}

/// The values that a filter reads; no rows if the mesh has none.
/// @throws MLException  when it needs some.
Eigen::MatrixXd valuesOf(const MeshModel& mesh, const MeshMatrices& input, MeshValues needed) {
    if (needed == MeshValues::Colors) {
        if (!mesh.hasPerVertexColor())
            throw MLException(
                "the mesh has no vertex colours to filter: apply a filter that sets them first, "
                "e.g. 'Per Vertex Color Function' or 'Transfer Color: Texture to Vertex'");
        return vertexColors(mesh.cm, input);
    }
    if (mesh.hasPerVertexQuality()) return vertexQuality(mesh.cm, input);
    if (needed == MeshValues::Quality)
        throw MLException(
            "the mesh has no vertex quality to filter: apply a filter that computes one first, "
            "e.g. 'Per Vertex Quality Function'");
    return {};
}

bool isStorable(const Eigen::MatrixXd& values) {
    return values.size() == 0 || values.cwiseAbs().maxCoeff<Eigen::PropagateNumbers>() <=
                                     std::numeric_limits<Scalarm>::max();
}

}  // namespace

std::vector<MeshFilter> allMeshFilters() {
    using Class = FilterPlugin::FilterClass;
    constexpr int kQuality = MeshModel::MM_VERTQUALITY, kColor = MeshModel::MM_VERTCOLOR;
    const auto smoothing = FilterPlugin::Smoothing, quality = FilterPlugin::Quality,
               measure = FilterPlugin::Measure;
    const std::vector<spectral::Filter>& all = spectral::allFilters();
    return {
        {all[0], smoothing, kMovesVertices | kQuality, MeshValues::None, writePositions},
        {all[1], smoothing, kMovesVertices, MeshValues::None, writePositions},
        {all[2], smoothing, kMovesVertices, MeshValues::None, writePositions},
        {all[3], Class(smoothing | quality), kQuality, MeshValues::Quality, writeQuality},
        {all[4], Class(smoothing | FilterPlugin::VertexColoring), kColor, MeshValues::Colors,
         writeColors},
        {all[5], Class(quality | measure), kQuality | kColor, MeshValues::None, writeArtefacts},
        {all[6], quality, kQuality | kColor, MeshValues::None, writeHarmonics},
        {all[7], measure, MeshModel::MM_NONE, MeshValues::None, writeNothing},
    };
}

FilterOutput applyTo(MeshModel& mesh, const MeshFilter& filter, const Values& given,
                     const spectral::Progress& progress) {
    progress.report(0.0, "reading the mesh");
    checkExtent(mesh.cm);
    const MeshMatrices input = toMatrices(mesh.cm);
    FilterOutput output = spectral::apply(
        filter.contract,
        {input.V, input.F, selectedVertices(mesh.cm, input), valuesOf(mesh, input, filter.values)},
        given, progress);
    if (!isStorable(output.values))
        throw MLException(
            "the filtered quality exceeds the largest number: choose smaller gains, or apply 'Per "
            "Vertex Quality Function', q / 1000, first");
    if (filter.changes != MeshModel::MM_NONE) {
        reportWriting(input, mesh.cm, progress);
        filter.write(input, given, output, mesh);
    }
    return output;
}
