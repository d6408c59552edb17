#include "meshlab/mesh_filter.h"

#include <common/mlexception.h>
#include <vcg/complex/append.h>

#include <QFileInfo>
#include <algorithm>
#include <limits>
#include <sstream>
#include <utility>

#include "core/mesh/measures.h"
#include "meshlab/host_workarounds/filter_dialog.h"
#include "meshlab/host_workarounds/given_output.h"
#include "meshlab/vertex_colors.h"

namespace {

using spectral::FilterOutput;
using spectral::Values;

constexpr int kMovesVertices =
    MeshModel::MM_VERTCOORD | MeshModel::MM_VERTNORMAL | MeshModel::MM_FACENORMAL;

/// Vertex attribute that holds the details.
const char* const kDetails = "spectral_details";

/// Vertex attribute that holds the height of noise.
const char* const kNoiseHeight = "noise_height";

/// Prefix of the names of the vertex attributes that hold harmonics, followed by the mode.
const char* const kHarmonic = "harmonic_";

/// Vertex attributes that hold quality and colours from before a filter wrote its own.
const char* const kQualityBefore = "quality_before";
const char* const kColorBefore = "color_before";

/// What was there before the first such filter is kept, and the text says so: runs after that
/// replace what they have written themselves.
template <class Keep>
void keepBefore(const char* what, const std::string& name, FilterOutput& output, MeshModel& mesh,
                Keep keep) {
    if (vcg::tri::HasPerVertexAttribute(mesh.cm, name)) return;
    keep();
    output.text += "\n  the vertex " + std::string(what) + " from before: attribute " + name;
}

void replaceQuality(const MeshMatrices& input, const Eigen::VectorXd& values, FilterOutput& output,
                    MeshModel& mesh) {
    if (mesh.hasPerVertexQuality())
        keepBefore("quality", kQualityBefore, output, mesh, [&] {
            setAttribute(input.vertexIndex, kQualityBefore, vertexQuality(mesh.cm, input), mesh);
        });
    setQuality(input.vertexIndex, values, mesh);
}

void keepColors(const MeshMatrices& input, FilterOutput& output, MeshModel& mesh) {
    if (mesh.hasPerVertexColor())
        keepBefore("colours", kColorBefore, output, mesh, [&] {
            setVectors(input.vertexIndex, kColorBefore, vertexColors(mesh.cm, input), mesh);
        });
}

/// The size that all but a hundredth of the values do not exceed, or if that is 0 the largest.
double usualExtent(const Eigen::VectorXd& values) {
    std::vector<double> sizes(values.size());
    Eigen::VectorXd::Map(sizes.data(), values.size()) = values.cwiseAbs();
    const auto at = sizes.begin() + (99 * (values.size() - 1)) / 100;
    std::nth_element(sizes.begin(), at, sizes.end());
    return *at > 0.0 ? *at : values.cwiseAbs().maxCoeff();
}

/// Colours for values with a sign, and a line on what they mean.
/// @param what  the values are.
void showSigned(const MeshMatrices& input, const Eigen::VectorXd& values, double extent,
                FilterOutput& output, MeshModel& mesh,
                const char* what = "the values are the vertex quality") {
    keepColors(input, output, mesh);
    setSignedColors(input.vertexIndex, values, extent > 0.0 ? extent : 1.0, mesh);
    std::ostringstream text;
    text.precision(3);
    text << "\n  colours: blue " << -extent << ", white 0, red " << extent << "; " << what
         << ", from " << values.minCoeff() << " to " << values.maxCoeff();
    output.text += text.str();
}

/// How far each vertex has moved along its normal, as colours and in the report.
void showDisplacement(const MeshMatrices& input, const Eigen::VectorXd& outward,
                      FilterOutput& output, MeshModel& mesh) {
    const double extent = usualExtent(outward);
    showSigned(input, outward, extent, output, mesh,
               "displacement along the normal, outwards positive");
    output.report["color_extent"] = extent;
    output.report["max_inward_displacement"] = std::max(0.0, -outward.minCoeff());
    output.report["max_outward_displacement"] = std::max(0.0, outward.maxCoeff());
}

void writePositions(const MeshMatrices& input, const Values&, FilterOutput& output,
                    MeshModel& mesh) {
    if (output.V.rows() > 0) setPositions(input, output.V, mesh);
    if (output.values.rows() > 0) {
        setAttribute(input.vertexIndex, kNoiseHeight, output.values, mesh);
        output.text += std::string("\n  the height of the noise: attribute ") + kNoiseHeight;
    }
    if (output.details.rows() == 0) return;
    const Eigen::VectorXd outward = alongNormals(input, output.details, mesh.cm);
    setVectors(input.vertexIndex, kDetails, output.details, mesh);
    output.text +=
        std::string("\n  no vertex has moved: the details are the attribute ") + kDetails;
    replaceQuality(input, outward, output, mesh);
    showSigned(input, outward, usualExtent(outward), output, mesh);
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

/// The length of the artefacts as quality, and in colours whose scale is that of the feature size:
/// meshes can be compared, and a good one stays white.
void writeArtefacts(const MeshMatrices& input, const Values&, FilterOutput& output,
                    MeshModel& mesh) {
    constexpr double kFullColor = 0.1;
    const double extent = kFullColor * std::get<double>(output.report.at("feature_size"));
    replaceQuality(input, output.values, output, mesh);
    keepColors(input, output, mesh);
    setSizeColors(input.vertexIndex, output.values, extent, mesh);
    std::ostringstream text;
    text.precision(3);
    text << "\n  colours: white 0, dark red " << extent
         << " and more, a tenth of the feature size; the values are the vertex quality";
    output.text += text.str();
}

/// Heights as quality, and in colours.
void writeHeights(const MeshMatrices& input, const Values&, FilterOutput& output, MeshModel& mesh) {
    replaceQuality(input, output.values, output, mesh);
    showSigned(input, output.values, usualExtent(output.values), output, mesh);
}

/// One harmonic as quality, and in colours.
void writeHarmonics(const MeshMatrices& input, const Values& given, FilterOutput& output,
                    MeshModel& mesh) {
    if (std::get<bool>(given.at("store_basis")))
        setAttributes(input.vertexIndex, kHarmonic, output.basis, mesh);
    replaceQuality(input, output.values, output, mesh);
    showSigned(input, output.values, output.values.cwiseAbs().maxCoeff(), output, mesh);
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

Values withoutChoice(const spectral::Filter& filter, Values given) {
    given.erase(filter.choice);
    return given;
}

bool isSameRun(const KeptRun& kept, const spectral::Filter& filter, const MeshMatrices& input,
               const Values& given) {
    return kept.filter == &filter && kept.V.rows() == input.V.rows() &&
           kept.F.rows() == input.F.rows() && kept.V == input.V && kept.F == input.F &&
           kept.given == withoutChoice(filter, given);
}

/// The output of a run, or of one before from which it can be taken, or what was handed over.
FilterOutput outputOf(const MeshModel& mesh, const MeshFilter& filter, const MeshMatrices& input,
                      const Values& given, const RunOptions& options,
                      const spectral::Progress& progress) {
    if (std::optional<FilterOutput> handedOver = takeGivenOutput()) {
        for (const Eigen::Index rows :
             {handedOver->V.rows(), handedOver->details.rows(), handedOver->values.rows()})
            if (rows > 0 && rows != input.V.rows())
                throw MLException("the result is that of a mesh with another number of vertices");
        return *std::move(handedOver);
    }
    const spectral::Filter& contract = filter.contract;
    KeptRun* const kept = options.kept;
    const bool isChoice = kept != nullptr && contract.choose != nullptr;
    if (isChoice && isSameRun(*kept, contract, input, given)) {
        FilterOutput output = kept->output;
        contract.choose(output, given);
        return output;
    }
    spectral::FilterInput read{input.V, input.F, selectedVertices(mesh.cm, input),
                               valuesOf(mesh, input, filter.values)};
    using Names = spectral::Words::Names;
    read.words = {hasWindows() ? Names::Labels : Names::Python, true};
    constexpr const char* kLimit = "MESHLAB_SPECTRAL_MEMORY";
    if (qEnvironmentVariableIsSet(kLimit))
        read.words.moreMemory = std::string("raise the environment variable ") + kLimit;
    if (kept != nullptr && options.isPreview) {
        if (std::exchange(kept->previewed, &contract) != &contract) kept->bands.reset();
        FilterOutput output = spectral::preview(contract, read, given, kept->bands, progress);
        while (const auto newer = options.newer ? options.newer() : std::nullopt)
            output = spectral::preview(contract, read, *newer, kept->bands, progress);
        return output;
    }
    FilterOutput output = spectral::apply(contract, read, given, progress);
    if (isChoice) {
        kept->filter = &contract;
        kept->V = input.V;
        kept->F = input.F;
        kept->given = withoutChoice(contract, given);
        kept->output = output;
    }
    return output;
}

/// Adds a hidden layer with the mesh as it is, like MeshLab's filter Duplicate Current Layer.
/// @return  its name.
QString keepAsLayer(const MeshModel& mesh, MeshDocument& document) {
    MeshModel* const copy = document.addNewMesh("", nameOf(mesh) + " (original)", false);
    copy->updateDataMask(&mesh);
    vcg::tri::Append<CMeshO, CMeshO>::MeshAppendConst(copy->cm, mesh.cm);
    for (const std::string& texture : copy->cm.textures)
        copy->addTexture(texture, mesh.getTexture(texture));
    copy->cm.Tr = mesh.cm.Tr;
    copy->updateBoxAndNormals();
    copy->setVisible(false);
    return copy->label();
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
        {all[0], smoothing, kMovesVertices | kQuality | kColor, MeshValues::None, writePositions},
        {all[1], smoothing, kMovesVertices | kColor, MeshValues::None, writePositions},
        {all[2], smoothing, kMovesVertices | kColor, MeshValues::None, writePositions},
        {all[3], Class(smoothing | quality), kQuality, MeshValues::Quality, writeQuality},
        {all[4], Class(smoothing | FilterPlugin::VertexColoring), kColor, MeshValues::Colors,
         writeColors},
        {all[5], Class(quality | measure), kQuality | kColor, MeshValues::None, writeArtefacts},
        {all[6], quality, kQuality | kColor, MeshValues::None, writeHarmonics},
        {all[7], measure, MeshModel::MM_NONE, MeshValues::None, writeNothing},
        {all[8], Class(quality | measure), kQuality | kColor, MeshValues::None, writeHeights},
    };
}

QString nameOf(const MeshModel& mesh) { return QFileInfo(mesh.label()).completeBaseName(); }

int changedBy(const MeshFilter& filter, const FilterOutput& output, bool isColored) {
    if (output.V.rows() == 0) return filter.changes;
    return isColored ? kMovesVertices | MeshModel::MM_VERTCOLOR : kMovesVertices;
}

FilterOutput applyTo(MeshModel& mesh, const MeshFilter& filter, const Values& given,
                     const RunOptions& options, const spectral::Progress& progress) {
    progress.report(0.0, "reading the mesh");
    checkExtent(mesh.cm);
    const MeshMatrices input = toMatrices(mesh.cm);
    FilterOutput output = outputOf(mesh, filter, input, given, options, progress);
    if (!isStorable(output.values))
        throw MLException(
            "the filtered quality exceeds the largest number: choose smaller gains, or apply 'Per "
            "Vertex Quality Function', q / 1000, first");
    if (filter.changes != MeshModel::MM_NONE) {
        reportWriting(input, mesh.cm, progress);
        if (options.layers != nullptr)
            output.text += "\n  the original is kept, hidden: layer " +
                           keepAsLayer(mesh, *options.layers).toStdString();
        Eigen::VectorXd outward = Eigen::VectorXd::Zero(input.V.rows());
        if (options.isColored && output.V.rows() > 0)  // while the mesh has its normals from before
            outward = alongNormals(input, output.V - input.V, mesh.cm);
        filter.write(input, given, output, mesh);
        if (options.isColored && output.details.rows() == 0)
            showDisplacement(input, outward, output, mesh);
    }
    return output;
}
