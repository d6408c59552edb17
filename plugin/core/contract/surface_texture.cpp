#include "core/analysis/surface_texture.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/contract/advice.h"
#include "core/contract/common_fields.h"
#include "core/contract/filters.h"
#include "core/contract/number_text.h"
#include "core/contract/report.h"
#include "core/contract/surface_report.h"
#include "core/mesh/measures.h"

namespace spectral {

namespace {

/// Two default feature sizes: twelve vertices per wave are few enough to measure it.
double wavinessOf(const MeshLengths& mesh) {
    return 2.0 * defaultFeatureSize(mesh.meanEdge, mesh.surfaceDiagonal);
}

struct TextureCall : TextureOptions {
    bool onlySelected = false;
};

Fields<TextureCall> textureFields() {
    using Call = TextureCall;
    return {
        field<Call>(
            &Call::waviness, "waviness", "Waviness cutoff",
            "Nesting index of the L-filter of ISO 25178-3: what is larger is waviness or "
            "form, not roughness. Waves of this length keep half of their height, as in ISO "
            "16610-61. With a plane, sphere or cylinder as |form|, the whole diagonal means no "
            "L-filter.")
            .in("length")
            .above(0.0)
            .length("auto", wavinessOf, "twelve mean edges, at most 10 % of the diagonal"),
        field<Call>(&Call::noise, "noise", "Noise cutoff",
                    "Nesting index of the S-filter: what is smaller is noise, not roughness. "
                    "The default: nothing is removed.")
            .in("length")
            .length("auto", nullptr, "0: no S-filter"),
        field<Call>(&Call::form, "form", "Form",
                    "What counts as form (F-operator), not as roughness. *size*: heights that "
                    "vary more slowly than |form_size|; suits any shape. *plane*, *sphere*, "
                    "*cylinder*: the one nearest to the measured surface, by least squares; "
                    "better for a sphere or a cylinder with a radius of less than two waviness "
                    "cutoffs. *none*: nothing, so that curvature adds to the heights.")
            .of({"size", "none", "plane", "sphere", "cylinder"}),
        field<Call>(&Call::formSize, "form_size", "Form size",
                    "For |form| *size*: heights that vary more slowly are form. The default: eight "
                    "times |waviness|.")
            .in("length", "above the waviness cutoff")
            .length("auto", nullptr, "0: eight waviness cutoffs")
            .advanced()
            .unusedIf([](const Call& call) {
                return call.form == FormKind::Size ? nullptr : "without form = size";
            }),
        field<Call>(&Call::creaseAngle, "crease_angle", "Crease angle (degrees)",
                    "Edges between faces whose planes differ by more than this are creases, if the "
                    "form turns as much. The surface within a waviness cutoff of them, and of "
                    "boundaries, is left out: it gets the height 0. Holes of up to a quarter of a "
                    "cutoff count as missing points: nothing is left out around them. With 180 no "
                    "edge is a crease; a plane, sphere or cylinder has none.")
            .in("degrees")
            .to(180.0)
            .advanced(),
        field<Call>(&Call::onlySelected, "selected", "Only the selection",
                    "Measure only the selected faces and vertices; the others have the height 0. "
                    "A plane, sphere or cylinder is fitted to them alone."),
        laplacianField<Call>(&Call::laplacian),
    };
}

struct Measured : SurfaceTexture {
    double waviness = 0.0, noise = 0.0;
};

Entries<Measured> textureEntries() {
    using R = Measured;
    return {
        {"waviness", "cutoff of the L-filter, length", &R::waviness},
        {"noise", "cutoff of the S-filter, length; 0: none", &R::noise},
        {"Sa", "mean of the magnitude of the height, length", &R::Sa},
        {"Sq", "root mean square of the height, length", &R::Sq},
        {"Ssk", "skewness of the heights", &R::Ssk},
        {"Sku", "kurtosis of the heights, 3 if they are normally distributed", &R::Sku},
        {"Sp", "height of the highest peak, length", &R::Sp},
        {"Sv", "depth of the deepest valley, length", &R::Sv},
        {"Sz", "from the deepest valley to the highest peak, length", &R::Sz},
        {"Sdq", "root mean square of the slope", &R::Sdq},
        {"Sdr", "additional area of the texture, relative to that of the reference surface",
         &R::Sdr},
        {"Sk", "height of the core, length", &R::Sk},
        {"Spk", "reduced height of the peaks above the core, length", &R::Spk},
        {"Svk", "reduced depth of the valleys below the core, length", &R::Svk},
        {"Smr1", "share of the area above the core, 0 to 1", &R::Smr1},
        {"Smr2", "share of the area above the lower end of the core, 0 to 1", &R::Smr2},
        {"Sal", "of a height map: shortest lag at which the autocorrelation falls to .2, length",
         [](const R& r) -> Value { return r.lengths.Sal; },
         [](const R& r) { return r.lengths.Sal > 0.0; }},
        {"Str",
         "of a height map: Sal over the longest such lag, 1 without a direction; none if that is "
         "longer than half of the map",
         [](const R& r) -> Value { return r.lengths.Str; },
         [](const R& r) { return r.lengths.Str > 0.0; }},
        {"area", "of the reference surface where it is evaluated, length²", &R::area},
        {"histogram_heights", "centres of the 64 bins of the histogram, ascending, length",
         &R::histogramHeights},
        {"histogram_shares", "share of the area with a height in each of these bins",
         &R::histogramShares},
        {"bearing_heights",
         "bearing curve (Abbott-Firestone): the heights that 0, 1, ..., 100 % of the area exceed, "
         "length",
         &R::bearingHeights},
        {"form_radius", "of the sphere or cylinder that was fitted, length", &R::formRadius,
         [](const R& r) { return r.formRadius > 0.0; }},
        {"vertices_evaluated", "number of vertices that count", &R::evaluated},
        {"vertices_left_out",
         "number of selected vertices within a cutoff of a boundary or a crease, or not on the "
         "fitted shape, as the caps of a cylinder",
         &R::leftOut},
        {"Sq_left_out", "root mean square height of those near a boundary, length; 0: none",
         &R::leftOutSq},
        {"vertices_too_thin",
         "number of others on parts thinner than the waviness cutoff, left out, too", &R::tooThin},
        {"error_estimate", "estimated root mean square error of the heights, length",
         &R::errorEstimate},
    };
}

std::string countText(int vertices) {
    return std::to_string(vertices) + (vertices == 1 ? " vertex" : " vertices");
}

std::string textOf(const Measured& texture) {
    std::ostringstream text;
    text << std::setprecision(4) << "Surface Texture: waviness cutoff " << texture.waviness;
    if (texture.noise > 0.0) text << ", noise cutoff " << texture.noise;
    text << "\n  Sa " << texture.Sa << ", Sq " << texture.Sq << ", Sp " << texture.Sp << ", Sv "
         << texture.Sv << ", Sz " << texture.Sz << "\n  Ssk " << texture.Ssk << ", Sku "
         << texture.Sku << ", Sdq " << texture.Sdq << ", Sdr " << 100.0 * texture.Sdr << " %\n  Sk "
         << texture.Sk << ", Spk " << texture.Spk << ", Svk " << texture.Svk << ", Smr1 "
         << 100.0 * texture.Smr1 << " %, Smr2 " << 100.0 * texture.Smr2 << " %";
    if (texture.lengths.Sal > 0.0) text << "\n  Sal " << texture.lengths.Sal;
    if (texture.lengths.Str > 0.0) text << ", Str " << texture.lengths.Str;
    text << "\n  evaluated: " << texture.evaluated << " vertices; left out: " << texture.leftOut
         << " within a cutoff of boundaries and creases";
    if (texture.formRadius > 0.0) text << "\n  form: of radius " << texture.formRadius;
    return text.str();
}

/// Tells that what is left out near boundaries is another surface than what is measured.
std::string leftOutText(const Measured& texture) {
    constexpr double kAlike = 1.5;  // the end of a low-pass changes heights by a third at most
    const double most = std::max(texture.leftOutSq, texture.Sq);
    if (texture.leftOutSq == 0.0 || most <= kAlike * std::min(texture.leftOutSq, texture.Sq))
        return {};
    return "the surface near boundaries is left out, and has other heights: its Sq is " +
           numberText(texture.leftOutSq, 3) + ", that of the rest " + numberText(texture.Sq, 3) +
           ". With a smaller |waviness| more of it is measured";
}

FilterOutput run(const FilterInput& input, const MeshLengths& mesh, const Values& given,
                 const Progress& progress) {
    static const Fields<TextureCall> fields = textureFields();
    TextureCall call = callOf(fields, given, mesh);
    if (call.onlySelected) call.selected = input.selected;
    constexpr double kSinglePrecision = 1e-6;
    if (call.waviness >= (1.0 - kSinglePrecision) * mesh.diagonal && isShape(call.form))
        call.waviness = 0.0;
    Measured texture{surfaceTexture(input.V, input.F, call, progress), call.waviness, call.noise};
    if (!std::isfinite(texture.Sq))
        throw SolverFailure(ErrorCode::SingularMatrix,
                            "the heights are lost in round-off: parts of the mesh are too far "
                            "apart, or too different in size");
    FilterOutput output;
    output.report = reportOf(textureEntries(), texture);
    output.text = textOf(texture);
    output.warnings = percentageWarnings(mesh);
    if (texture.tooThin > 0)
        output.warnings.push_back(
            {WarningCode::ThinnerThanCutoff,
             "parts thinner than the waviness cutoff are left out: " + countText(texture.tooThin) +
                 ", the first is vertex " + std::to_string(texture.firstTooThin) +
                 ". With a smaller |waviness| they are measured"});
    if (texture.leftOut > texture.evaluated)
        output.warnings.push_back(
            {WarningCode::LittleMeasured,
             "only " + std::to_string(texture.evaluated) + " of " +
                 countText(texture.leftOut + texture.evaluated + texture.tooThin) +
                 " are measured: the others are within a cutoff of boundaries or creases, or not "
                 "on the fitted shape. A smaller |waviness|, or a larger |crease_angle| such as "
                 "180, measures more"});
    constexpr double kSteep = 0.7;  // Sq is .5 % off at .4, and 3.5 % at 1
    if (!isShape(call.form) && texture.Sdq > kSteep)
        output.warnings.push_back(
            {WarningCode::SteepTexture, "slopes of the texture are steep, Sdq " +
                                            numberText(texture.Sdq, 3) +
                                            ": on a free shape they make heights 2 % too low, or "
                                            "more. Choose |form| plane, sphere or cylinder if "
                                            "the surface is one"});
    if (const std::string note = leftOutText(texture); !note.empty())
        output.warnings.push_back({WarningCode::OtherHeights, note});
    // Sq is half of this lower. Waves and noise have .1 % at that height, a terrain with a flat rim
    // 2.5, the flat faces of a machine part 5.
    constexpr double kFlat = 0.04;
    if (texture.flat > kFlat)
        output.warnings.push_back({WarningCode::FlatTexture,
                                   numberText(100.0 * texture.flat, 3) +
                                       " % of the area has no texture: its heights are below a "
                                       "thousandth of Sq, which lowers all means. Select what is "
                                       "rough, such as where nz > 0.5"});
    if (!texture.accuracyReached)
        output.warnings.push_back(
            accuracyWarning(kTextureAccuracy, texture.errorEstimate / mesh.diagonal));
    append(unusedWarnings(fields, call), output.warnings);
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
        "parameters of ISO 25178-2: Sa, Sq, Ssk, Sku, Sp, Sv, Sz, Sdq, Sdr, Sk, Spk, Svk, and of "
        "height maps Sal and Str. The height of each vertex above the smooth surface, in the units "
        "of the mesh, becomes the vertex quality; "
        "no vertex moves.",
        "",
        parametersOf(textureFields()),
        describedBy(textureEntries()),
        run};
}

}  // namespace spectral
