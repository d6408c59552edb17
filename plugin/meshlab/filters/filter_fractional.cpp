#include "core/filter/fractional_filter.h"
#include "core/mesh/measures.h"
#include "meshlab/filters/fractional_help.h"
#include "meshlab/filters/fractional_parameters.h"
#include "meshlab/filters/fractional_report.h"
#include "meshlab/host_workarounds/steady_progress.h"
#include "meshlab/mesh_conversion.h"
#include "meshlab/mesh_filter.h"

namespace {

FilterOutcome apply(const RichParameterList& parameters, MeshModel& mesh,
                    const spectral::Progress& progress) {
    const MeshMatrices input = toMatrices(mesh.cm);
    const spectral::FilterOptions options = fractionalFilterOptions(parameters, mesh, input);
    const spectral::FilterResult result =
        spectral::withSteadyProgress(progress, [&](const spectral::Progress& steady) {
            return spectral::fractionalFilter(input.V, input.F, options, steady);
        });
    reportWriting(input, mesh.cm, progress);
    setPositions(input.vertexIndex, result.V, mesh);
    return {reportDictionary(result),
            reportText(options, result, spectral::boundingBoxDiagonal(input.V)),
            warningsOf(options, result)};
}

}  // namespace

MeshFilter fractionalMeshFilter() {
    MeshFilter filter;
    filter.name = "Spectral Filter (Fractional)";
    filter.pythonName = "apply_coord_spectral_filter_fractional";
    filter.help = fractionalFilterHelp();
    filter.category = FilterPlugin::Smoothing;
    filter.changes = MeshModel::MM_VERTCOORD | MeshModel::MM_VERTNORMAL | MeshModel::MM_FACENORMAL;
    filter.parameters = fractionalFilterParameters;
    filter.apply = apply;
    return filter;
}
