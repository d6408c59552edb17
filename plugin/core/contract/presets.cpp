#include "core/contract/presets.h"

#include <array>
#include <utility>

#include "core/contract/equalizer.h"

namespace spectral {

namespace {

using Gains = std::array<double, kEqualizerTimes.size()>;

// Texts and numbers explicitly: a literal would become a bool.
Value text(const char* value) { return std::string(value); }

Preset filtering(const char* name, const char* purpose, const char* type, const char* size,
                 Values others = {}) {
    others.insert({{"filter_type", text(type)}, {"feature_size", text(size)}});
    return {name, "apply_coord_spectral_filter_fractional", purpose, std::move(others)};
}

Preset denoising(const char* name, const char* purpose, Values options) {
    return {name, "apply_coord_spectral_denoise", purpose, std::move(options)};
}

/// @param gains  of the sliders, from coarse to fine.
Preset equalizing(const char* name, const char* purpose, const Gains& gains) {
    Preset preset{name, "apply_coord_spectral_equalizer", purpose, {}};
    for (std::size_t i = 0; i < gains.size(); ++i)
        preset.options["gain_" + std::to_string(kEqualizerTimes[i]) + "x"] = gains[i];
    return preset;
}

}  // namespace

const std::vector<Preset>& allPresets() {
    static const std::vector<Preset> presets{
        // The default size: about the finest waves that the mesh can represent.
        filtering("smooth", "removes the finest waves", "low-pass", "auto"),
        filtering("remove-details", "removes details below 5 %", "low-pass", "5%"),
        filtering("extract-details", "what remove-details takes away", "low-pass", "5%",
                  {{"result", text("details")}}),
        filtering("sharpen", "doubles details below 3 %", "high-pass", "3%",
                  {{"stop_gain", 1.0}, {"pass_gain", 2.0}}),
        filtering("enhance", "raises details of about 8 %", "band-pass", "8%",
                  {{"stop_gain", 1.0}, {"pass_gain", 2.5}}),
        filtering("caricature", "doubles large features of about 25 %", "band-pass", "25%",
                  {{"stop_gain", 1.0}, {"pass_gain", 2.0}, {"band_width", 1.5}}),
        filtering("print", "smooths for a printer, keeps the volume", "low-pass", "auto",
                  {{"preserve_volume", true}}),
        filtering("terrain", "smooths ground, keeps its border, so that tiles fit", "low-pass",
                  "auto", {{"boundary", text("fixed")}}),
        equalizing("clear", "an equalizer that raises details of 6 to 24 edges",
                   {1.0, 1.0, 1.4, 1.6, 1.4, 1.0}),
        equalizing("relief", "an equalizer that raises details of 24 to 96 edges",
                   {1.4, 1.8, 1.6, 1.2, 1.0, 1.0}),
        equalizing("worn", "an equalizer that flattens finer details more",
                   {1.0, 1.0, 0.8, 0.5, 0.2, 0.0}),
        denoising("scan", "removes the noise as measured", {{"strength", 1.0}}),
        denoising("museum", "removes 0.7 of the noise, at most an edge: spares details",
                  {{"strength", 0.7}, {"max_displacement", text("1e")}}),
        denoising("teeth", "keeps borders, as margins; moves at most half an edge",
                  {{"boundary", text("fixed")}, {"max_displacement", text("0.5e")}}),
    };
    return presets;
}

}  // namespace spectral
