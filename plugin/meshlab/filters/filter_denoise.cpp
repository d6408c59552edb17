#include <common/parameters/rich_parameters.h>

#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>
#include <vector>

#include "core/denoise/denoise.h"
#include "meshlab/filters/common_parameters.h"
#include "meshlab/host_workarounds/steady_progress.h"
#include "meshlab/mesh_conversion.h"
#include "meshlab/mesh_filter.h"

namespace {

const char* const kDenoiseHelp =
    "Removes the noise of a scan, with <b>nothing to choose</b>: measures how high the noise is "
    "(<i>noise height</i> 0), and filters as strongly as that takes. Creases become sharp, soft "
    "forms stay soft; a mesh without noise stays as it is."
    "<br><br>Face normals are filtered in weak fractional steps [1], with the Laplacian taken anew "
    "from the shape after each; it hardly connects faces across creases. The vertices follow the "
    "normals [2] and do not drift within the surface. Closed components keep their volume."
    "<br><br>Only noise that differs from vertex to vertex is removed. Ripples over many vertices "
    "are taken for shape: for those, use <i>Spectral Filter (Fractional)</i>."
    "<br><br><small>[1] Kovnatsky, Bronstein, Bronstein 2012; [2] Sun, Rosin, Martin, Langbein "
    "2007</small>";

RichParameterList denoiseParameters(const MeshModel& mesh) {
    const spectral::DenoiseOptions defaults;
    const Scalarm diagonal = mesh.cm.bbox.Diag();
    RichParameterList list;
    list.addParam(RichFloat("strength", static_cast<Scalarm>(defaults.strength), "Strength",
                            "1 removes the noise as measured. More removes finer details, too; "
                            "less leaves some noise; 0 changes nothing."));
    list.addParam(RichPercentage(
        "noise_height", static_cast<Scalarm>(defaults.noiseHeight), 0, diagonal, "Noise height",
        "Standard deviation of the noise along the normals. 0: as measured; the log then says how "
        "high it is. Give it where fine details were taken for noise, or noise for details." +
            meanEdgeTold(meanEdge(mesh))));
    list.addParam(RichBool("keep_creases", defaults.keepCreases, "Keep creases",
                           "Do not smooth across edges. Off: rounds them; for shapes that have "
                           "none."));
    list.addParam(RichEnum("boundary", static_cast<int>(defaults.boundary), boundaries(),
                           "Boundary",
                           "The boundary of an open surface, holes included. <b>fixed</b>: it "
                           "stays exactly in place. <b>free</b>: it is denoised, too.",
                           true));
    return list;
}

std::string headline(const spectral::DenoiseResult& result) {
    const bool isAsMeasured = result.noiseHeight == result.estimatedHeight;
    std::ostringstream text;
    text << std::setprecision(3) << "Spectral Denoise: ";
    if (result.rounds == 0 && isAsMeasured)
        text << "no noise found (measured: " << result.estimatedHeight / result.meanEdge
             << " mean edges)";
    else
        text << "the noise is " << result.estimatedHeight << " high (standard deviation; "
             << result.estimatedHeight / result.meanEdge << " mean edges)";
    if (!isAsMeasured) text << ", filtered as if it were " << result.noiseHeight << " high";
    if (result.rounds == 0)
        text << "; nothing changed. Against ripples over several vertices, give a noise height, "
                "e.g. a tenth of an edge, or use Spectral Filter (Fractional)";
    else
        text << "; the vertices moved by " << result.rmsDisplacement << " (root mean square), by "
             << result.maxDisplacement << " at most";
    return text.str();
}

std::string reportText(const spectral::DenoiseResult& result) {
    std::ostringstream text;
    text << headline(result) << std::setprecision(6) << "\n  volume: " << result.volumeBefore
         << " -> " << result.volumeAfter
         << " (of closed surfaces)\n  surface: " << result.components
         << (result.components == 1 ? " component" : " components");
    if (result.unreferencedVertices > 0)
        text << ", " << result.unreferencedVertices << " unreferenced vertices unchanged";
    if (result.fixedVertices > 0)
        text << ", " << result.fixedVertices << " boundary vertices fixed";
    text << "\n  work: " << result.rounds << " rounds";
    return text.str();
}

std::vector<std::string> warningsOf(const spectral::DenoiseResult& result) {
    std::vector<std::string> warnings;
    if (result.rounds > 0 && result.fixedVertices + result.unreferencedVertices == result.V.rows())
        warnings.emplace_back(
            "nothing can move: every vertex lies on the boundary, which is fixed. Choose boundary "
            "= free; if the triangles are not connected, apply 'Merge Close Vertices' first");
    constexpr double kHalf = 0.5;
    if (result.estimatedHeight > kHalf * result.meanEdge)
        warnings.emplace_back(
            "the noise is higher than half an edge: what it hides cannot be told from it. Look at "
            "the result, or remesh more coarsely first");
    return warnings;
}

FilterOutcome applyDenoise(const RichParameterList& parameters, MeshModel& mesh,
                           const spectral::Progress& progress) {
    const MeshMatrices input = toMatrices(mesh.cm);
    spectral::DenoiseOptions options;
    options.strength = parameters.getFloat("strength");
    options.noiseHeight = parameters.getAbsPerc("noise_height");
    options.keepCreases = parameters.getBool("keep_creases");
    options.boundary = boundaryCondition(parameters);
    const spectral::DenoiseResult result =
        spectral::withSteadyProgress(progress, [&](const spectral::Progress& steady) {
            return spectral::denoise(input.V, input.F, options, steady);
        });
    reportWriting(input, mesh.cm, progress);
    setPositions(input.vertexIndex, result.V, mesh);
    return {{{"noise_height", result.noiseHeight},
             {"estimated_noise_height", result.estimatedHeight},
             {"mean_edge", result.meanEdge},
             {"rms_displacement", result.rmsDisplacement},
             {"max_displacement", result.maxDisplacement},
             {"volume_before", result.volumeBefore},
             {"volume_after", result.volumeAfter},
             {"preserved_volumes", result.volumes.preserved},
             {"components", result.components},
             {"unreferenced_vertices", result.unreferencedVertices},
             {"fixed_vertices", result.fixedVertices},
             {"rounds", result.rounds}},
            reportText(result),
            warningsOf(result)};
}

}  // namespace

MeshFilter denoiseMeshFilter() {
    MeshFilter filter;
    filter.name = "Spectral Denoise";
    filter.pythonName = "apply_coord_spectral_denoise";
    filter.help = kDenoiseHelp;
    filter.category = FilterPlugin::Smoothing;
    filter.changes = MeshModel::MM_VERTCOORD | MeshModel::MM_VERTNORMAL | MeshModel::MM_FACENORMAL;
    filter.parameters = denoiseParameters;
    filter.apply = applyDenoise;
    return filter;
}
