#include "meshlab/filters/transfer_parameters.h"

#include <common/parameters/rich_parameters.h>

#include "core/mesh/measures.h"
#include "core/mesh/mesh_check.h"
#include "core/support/frequency.h"
#include "core/transfer/custom_gain.h"
#include "meshlab/filters/common_parameters.h"

namespace {

// In the order of the core's enumerations.
QStringList filterTypes() { return {"low-pass", "high-pass", "band-pass", "band-stop", "custom"}; }
QStringList responses() { return {"gaussian", "butterworth", "ideal"}; }

/// Default transfer function, an example to edit.
const char* const kExample = "20%:1, 5%:2, 1%:0.1";

}  // namespace

void addTransferParameters(const MeshModel& mesh, RichParameterList& list) {
    const spectral::TransferFunctionOptions transfer;
    list.addParam(RichEnum(
        "filter_type", static_cast<int>(transfer.type), filterTypes(), "Filter type",
        "Which details to change, by their size. <b>low-pass</b> keeps details larger than the "
        "feature size and removes the rest. <b>high-pass</b> acts on smaller ones: with stop gain "
        "1 and pass gain 2 it sharpens. <b>band-pass</b> acts on details of about the feature "
        "size: with stop gain 1 and pass gain above 1 it enhances them. <b>band-stop</b> removes "
        "them. <b>custom</b>: the transfer function below."));
    list.addParam(featureSizeParameter(
        mesh,
        "Size at which the filter cuts off: a wavelength along the surface, i.e. a bump and the "
        "hollow next to it. A low-pass leaves a quarter of the height of waves half as long, and "
        "nine tenths of that of waves twice as long. To remove bumps, try four times their width. "
        "Default: six mean edges of this mesh, at most 5 % of its diagonal, which removes the "
        "noise of a scan. A low-pass of this size keeps parts that are thinner; one of another "
        "size draws them in."));
    list.addParam(RichFloat("pass_gain", static_cast<Scalarm>(transfer.passGain), "Pass gain",
                            "Factor for the details that the filter passes: 1 keeps them, 2 "
                            "doubles their height, 0 removes them. Not negative."));
    list.addParam(RichFloat("stop_gain", static_cast<Scalarm>(transfer.stopGain), "Stop gain",
                            "Factor for all other details: 0 removes them, 0.5 halves their "
                            "height, 1 keeps them. Not negative."));
    list.addParam(RichString("transfer_function", kExample, "Transfer function",
                             "For the type custom: gains at feature sizes, like an equalizer, as "
                             "size:gain with sizes in percent of the diagonal (5%), mean edges "
                             "(6e) or as lengths; or an expression of w, the feature size over the "
                             "wavelength, such as 1/(1 + w^4) (f is the frequency, l = f^2)."));
    list.addParam(RichFloat("band_width", static_cast<Scalarm>(transfer.bandWidth),
                            "Band width (octaves)",
                            "Width of the band for band-pass and band-stop, in octaves: with 1, "
                            "its largest details are twice as large as its smallest.",
                            true));
    list.addParam(RichEnum("response", static_cast<int>(transfer.response), responses(), "Response",
                           "How sharply the filter separates sizes. <b>gaussian</b> is gradual and "
                           "never rings; <b>butterworth</b> is sharper the higher its order; "
                           "<b>ideal</b> cuts off abruptly and may leave ripples.",
                           true));
    list.addParam(RichInt(
        "order", transfer.order, "Butterworth order",
        "Steepness of the butterworth response, from 1 (gentle) to 64 (nearly ideal).", true));
    list.addParam(RichFloat("power", static_cast<Scalarm>(transfer.power), "Power",
                            "Fraction of the filter to apply, as a power of its gains: 0.5 is half "
                            "of the filter (a gain of 4 becomes 2). Above 0, at most 1.",
                            true));
}

ChosenTransfer chosenTransfer(const RichParameterList& parameters, const MeshMatrices& mesh) {
    ChosenTransfer chosen;
    spectral::TransferFunctionOptions& transfer = chosen.options;
    transfer.type =
        static_cast<spectral::FilterType>(choice(parameters, "filter_type", filterTypes()));
    transfer.response =
        static_cast<spectral::Response>(choice(parameters, "response", responses()));
    transfer.order = parameters.getInt("order");
    transfer.bandWidth = parameters.getFloat("band_width");
    transfer.passGain = parameters.getFloat("pass_gain");
    transfer.stopGain = parameters.getFloat("stop_gain");
    transfer.power = parameters.getFloat("power");
    chosen.featureSize = featureSize(parameters);
    if (transfer.type == spectral::FilterType::Custom) {
        spectral::checkMesh(mesh.V, mesh.F);  // before it is measured
        const spectral::CustomGain custom = spectral::parseGain(
            parameters.getString("transfer_function").toStdString(),
            spectral::cutoffFrequency(chosen.featureSize),
            {spectral::boundingBoxDiagonal(mesh.V), spectral::meanEdgeLength(mesh.V, mesh.F)});
        transfer.custom = custom.gain;
        chosen.featureSize = 2.0 * spectral::kPi / custom.cutoff;
    }
    return chosen;
}

void warnIfUnused(bool isChanged, bool isUsed, const char* name, const char* condition,
                  std::vector<std::string>& warnings) {
    if (isChanged && !isUsed) warnings.push_back(std::string(name) + " has no effect " + condition);
}

std::vector<std::string> unusedTransferParameters(const RichParameterList& parameters) {
    const spectral::TransferFunctionOptions defaults;
    const auto type =
        static_cast<spectral::FilterType>(choice(parameters, "filter_type", filterTypes()));
    const auto response =
        static_cast<spectral::Response>(choice(parameters, "response", responses()));
    const bool isCustom = type == spectral::FilterType::Custom;
    const bool isBand =
        type == spectral::FilterType::BandPass || type == spectral::FilterType::BandStop;
    const auto isChanged = [&](const char* name, double usual) {
        return parameters.getFloat(name) != static_cast<Scalarm>(usual);
    };
    std::vector<std::string> warnings;
    const char* const withCustom = "with filter_type = custom";
    warnIfUnused(isChanged("pass_gain", defaults.passGain), !isCustom, "pass_gain", withCustom,
                 warnings);
    warnIfUnused(isChanged("stop_gain", defaults.stopGain), !isCustom, "stop_gain", withCustom,
                 warnings);
    warnIfUnused(parameters.getString("transfer_function") != kExample, isCustom,
                 "transfer_function", "without filter_type = custom", warnings);
    warnIfUnused(isChanged("band_width", defaults.bandWidth), isBand, "band_width",
                 "without filter_type = band-pass or band-stop", warnings);
    warnIfUnused(response != defaults.response, !isCustom, "response", withCustom, warnings);
    warnIfUnused(parameters.getInt("order") != defaults.order,
                 !isCustom && response == spectral::Response::Butterworth, "order",
                 "without response = butterworth", warnings);
    return warnings;
}

std::string nameOf(spectral::FilterType type) {
    return filterTypes()[static_cast<int>(type)].toStdString();
}
