#include "core/analysis/artefacts.h"

#include <iomanip>
#include <sstream>
#include <string>
#include <utility>

#include "core/contract/common_fields.h"
#include "core/contract/filters.h"
#include "core/contract/report.h"
#include "core/contract/surface_report.h"
#include "core/contract/transfer_fields.h"

namespace spectral {

namespace {

Fields<ArtefactOptions> artefactFields() {
    return {
        featureSizeField<ArtefactOptions>(
            &ArtefactOptions::featureSize,
            "Feature size of the low-pass or band filter that was applied. A percentage refers to "
            "the diagonal of this mesh, which the filter may have changed: enter the length that "
            "the filter reported."),
        laplacianField<ArtefactOptions>(&ArtefactOptions::laplacian),
    };
}

struct Measured : Artefacts {
    double featureSize = 0.0, diagonal = 0.0;
};

Entries<Measured> artefactEntries() {
    using R = Measured;
    return {
        {"rms", "root mean square of the artefacts over the surface, length", &R::rms},
        {"maximum", "largest length of the artefacts at a vertex, length", &R::maximum},
        {"feature_size", "as applied, length", &R::featureSize},
        {"diagonal", "of the bounding box, length", &R::diagonal},
    };
}

std::string textOf(const Measured& artefacts) {
    const double percent = 100.0 / artefacts.diagonal;
    std::ostringstream text;
    text << std::setprecision(4) << "Spectral Artefacts: root mean square " << artefacts.rms
         << ", largest " << artefacts.maximum << std::setprecision(2) << " ("
         << percent * artefacts.rms << " % and " << percent * artefacts.maximum
         << " % of the diagonal)\n  ripples finer than half of feature size "
         << std::setprecision(4) << artefacts.featureSize << "; estimated error of these lengths "
         << std::setprecision(2) << artefacts.errorEstimate;
    return text.str();
}

FilterOutput run(const FilterInput& input, const MeshLengths& mesh, const Values& given,
                 const Progress& progress) {
    const ArtefactOptions options = callOf(artefactFields(), given, mesh);
    Measured artefacts{measureArtefacts(input.V, input.F, options, progress), options.featureSize,
                       mesh.diagonal};
    FilterOutput output;
    output.report = reportOf(artefactEntries(), artefacts);
    output.text = textOf(artefacts);
    output.warnings = percentageWarnings(mesh);
    output.values = std::move(artefacts.length);
    return output;
}

}  // namespace

Filter artefactsContract() {
    return {
        "Spectral Artefacts",
        "compute_scalar_spectral_artefacts_per_vertex",
        "Measures the *artefacts* (artifacts) that a filter has left in a shape: spikes, creases "
        "and ripples much finer than the details it should keep. Apply it to the filtered mesh, "
        "with the filter's feature size. Their length becomes the vertex quality; no vertex "
        "moves.",
        "",
        parametersOf(artefactFields()),
        describedBy(artefactEntries()),
        run};
}

}  // namespace spectral
