#include <common/parameters/rich_parameters.h>
#include <vcg/complex/algorithms/update/color.h>

#include <iomanip>
#include <sstream>
#include <string>

#include "core/analysis/artefacts.h"
#include "core/support/steady_progress.h"
#include "meshlab/filters/common_parameters.h"
#include "meshlab/mesh_conversion.h"
#include "meshlab/mesh_filter.h"

namespace {

const char* const kArtefactsHelp =
    "Measures the <b>artefacts</b> that a filter has left in a shape: spikes, creases and ripples "
    "much finer than the details it should keep. Apply it to the filtered mesh, with the filter's "
    "feature size. Their length becomes the vertex quality; no vertex moves.";

RichParameterList artefactsParameters(const MeshModel& mesh) {
    RichParameterList list;
    list.addParam(featureSizeParameter(
        mesh,
        "Feature size of the low-pass or band filter that was applied. A percentage refers to the "
        "diagonal of this mesh, which the filter may have changed: enter the length that the "
        "filter reported."));
    list.addParam(laplacianParameter());
    return list;
}

std::string textOf(const spectral::Artefacts& artefacts, double featureSize, double diagonal) {
    std::ostringstream text;
    text << std::setprecision(4) << "Spectral Artefacts above twice the cutoff of feature size "
         << featureSize << "\n  root mean square " << artefacts.rms << " ("
         << artefacts.rms / diagonal << " diagonals), largest " << artefacts.maximum << " ("
         << artefacts.maximum / diagonal << " diagonals), estimated error of these lengths "
         << artefacts.errorEstimate;
    return text.str();
}

FilterOutcome applyArtefacts(const RichParameterList& parameters, MeshModel& mesh,
                             const spectral::Progress& progress) {
    const MeshMatrices input = toMatrices(mesh.cm);
    spectral::ArtefactOptions options;
    options.featureSize = featureSize(parameters);
    options.laplacian = laplacianKind(parameters);
    const spectral::Artefacts artefacts = spectral::withSteadyProgress(
        progress, spectral::measureArtefacts, input.V, input.F, options);

    reportWriting(input, mesh.cm, progress);
    setQuality(input.vertexIndex, artefacts.length, mesh);
    mesh.updateDataMask(MeshModel::MM_VERTCOLOR);
    vcg::tri::UpdateColor<CMeshO>::PerVertexQualityRamp(mesh.cm, 0,
                                                        static_cast<Scalarm>(artefacts.maximum));
    const double diagonal = mesh.cm.bbox.Diag();
    return {{{"rms", artefacts.rms},
             {"maximum", artefacts.maximum},
             {"feature_size", options.featureSize},
             {"diagonal", diagonal}},
            textOf(artefacts, options.featureSize, diagonal),
            percentageWarnings(input)};
}

}  // namespace

MeshFilter artefactsMeshFilter() {
    return {"Spectral Artefacts",
            "compute_scalar_spectral_artefacts_per_vertex",
            kArtefactsHelp,
            FilterPlugin::FilterClass(FilterPlugin::Quality | FilterPlugin::Measure),
            MeshModel::MM_VERTQUALITY | MeshModel::MM_VERTCOLOR,
            artefactsParameters,
            applyArtefacts};
}
