#include "core/analysis/surface_texture.h"

#include <algorithm>
#include <iomanip>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/contract/advice.h"
#include "core/contract/common_fields.h"
#include "core/contract/filters.h"
#include "core/contract/report.h"
#include "core/contract/surface_report.h"
#include "core/mesh/measures.h"

namespace spectral {

namespace {

/// Two default feature sizes: twelve vertices per wave are few enough to measure it.
double wavinessOf(const MeshLengths& mesh) {
    return 2.0 * defaultFeatureSize(mesh.meanEdge, mesh.surfaceDiagonal);
}

Fields<TextureOptions> textureFields() {
    using Call = TextureOptions;
    return {
        field<Call>([](auto& call) -> auto& { return call.waviness; }, "waviness",
                    "Waviness cutoff",
                    "Nesting index of the L-filter: what is larger is waviness or form, and no "
                    "roughness. Waves of this length keep half of their height, as in ISO "
                    "16610-61.")
            .in("length, above 0")
            .above(0.0)
            .length("auto", wavinessOf, "twelve mean edges, at most 10 % of the diagonal"),
        field<Call>([](auto& call) -> auto& { return call.noise; }, "noise", "Noise cutoff",
                    "Nesting index of the S-filter: what is smaller is noise, and no roughness. "
                    "The default: none is removed.")
            .in("length, at least 0")
            .length("auto", nullptr, "0: no S-filter"),
        field<Call>([](auto& call) -> auto& { return call.form; }, "form", "Form size",
                    "Size of the F-operator: heights that vary more slowly are form. The default: "
                    "eight times |waviness|.")
            .in("length, above the waviness cutoff")
            .length("auto", nullptr, "0: eight waviness cutoffs")
            .advanced(),
        field<Call>([](auto& call) -> auto& { return call.creaseAngle; }, "crease_angle",
                    "Crease angle (degrees)",
                    "Edges between faces whose planes differ by more are creases. The surface "
                    "within a waviness cutoff of them, and of boundaries, is left out: it has the "
                    "height 0. 180 keeps creases.")
            .in("degrees, 0 to 180")
            .to(180.0)
            .advanced(),
        laplacianField<Call>([](auto& call) -> auto& { return call.laplacian; }),
    };
}

struct Measured : SurfaceTexture {
    double waviness = 0.0, noise = 0.0;
};

Entries<Measured> textureEntries() {
    using R = Measured;
    return {
        {"waviness", "cutoff of the L-filter, length",
         [](const R& r) -> Value { return r.waviness; }},
        {"noise", "cutoff of the S-filter, length; 0: none",
         [](const R& r) -> Value { return r.noise; }},
        {"Sa", "mean of the magnitude of the height, length",
         [](const R& r) -> Value { return r.Sa; }},
        {"Sq", "root mean square of the height, length", [](const R& r) -> Value { return r.Sq; }},
        {"Ssk", "skewness of the heights", [](const R& r) -> Value { return r.Ssk; }},
        {"Sku", "kurtosis of the heights, 3 if they are normally distributed",
         [](const R& r) -> Value { return r.Sku; }},
        {"Sp", "height of the highest peak, length", [](const R& r) -> Value { return r.Sp; }},
        {"Sv", "depth of the deepest valley, length", [](const R& r) -> Value { return r.Sv; }},
        {"Sz", "from the deepest valley to the highest peak, length",
         [](const R& r) -> Value { return r.Sz; }},
        {"Sdq", "root mean square of the slope", [](const R& r) -> Value { return r.Sdq; }},
        {"Sdr", "additional area of the texture, relative to that of the reference surface",
         [](const R& r) -> Value { return r.Sdr; }},
        {"area", "of the reference surface where it is evaluated, length²",
         [](const R& r) -> Value { return r.area; }},
        {"vertices_evaluated", "number of vertices that count",
         [](const R& r) -> Value { return r.evaluated; }},
        {"vertices_left_out", "number of vertices within a cutoff of a boundary or a crease",
         [](const R& r) -> Value { return r.leftOut; }},
        {"error_estimate", "estimated largest error of the filtered coordinates, length",
         [](const R& r) -> Value { return r.errorEstimate; }},
    };
}

std::string textOf(const Measured& texture) {
    std::ostringstream text;
    text << std::setprecision(4) << "Surface Texture: waviness cutoff " << texture.waviness;
    if (texture.noise > 0.0) text << ", noise cutoff " << texture.noise;
    text << "\n  Sa " << texture.Sa << ", Sq " << texture.Sq << ", Sp " << texture.Sp << ", Sv "
         << texture.Sv << ", Sz " << texture.Sz << "\n  Ssk " << texture.Ssk << ", Sku "
         << texture.Sku << ", Sdq " << texture.Sdq << ", Sdr " << 100.0 * texture.Sdr
         << " %\n  evaluated: " << texture.evaluated << " vertices; left out: " << texture.leftOut
         << " within a cutoff of boundaries and creases";
    return text.str();
}

FilterOutput run(const FilterInput& input, const MeshLengths& mesh, const Values& given,
                 const Progress& progress) {
    const TextureOptions options = callOf(textureFields(), given, mesh);
    Measured texture{surfaceTexture(input.V, input.F, options, progress), options.waviness,
                     options.noise};
    FilterOutput output;
    output.report = reportOf(textureEntries(), texture);
    output.text = textOf(texture);
    output.warnings = percentageWarnings(mesh);
    if (!texture.accuracyReached)
        output.warnings.push_back(accuracyWarning(1e-8, texture.errorEstimate / mesh.diagonal));
    output.values = std::move(texture.height);
    return output;
}

}  // namespace

Filter surfaceTextureContract() {
    return {
        "Surface Texture",
        "compute_scalar_surface_texture_per_vertex",
        "Measures how *rough* a surface is, on any shape: separates roughness from waviness and "
        "form with the Gaussian filter of ISO 16610-61, a spectral low-pass, and reports the "
        "parameters of ISO 25178-2: Sa, Sq, Ssk, Sku, Sp, Sv, Sz, Sdq, Sdr. The height of each "
        "vertex above the smooth surface, in the units of the mesh, becomes the vertex quality; "
        "no vertex moves.",
        "",
        parametersOf(textureFields()),
        describedBy(textureEntries()),
        run};
}

}  // namespace spectral
