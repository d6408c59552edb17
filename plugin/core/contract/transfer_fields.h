#pragma once

#include <string>

#include "core/contract/table.h"
#include "core/mesh/mesh.h"
#include "core/support/progress.h"
#include "core/transfer/transfer_function.h"

namespace spectral {

/// What a transfer function is called with, which filters of shapes and of signals share.
struct TransferOptions {
    TransferFunctionOptions transferFunction;
    double featureSize = 0.0;  ///< Length units; for gains at sizes, the middle of these.
};

/// The options of a filter, which have these members, and a custom gain as users write it.
template <class Options>
struct TransferCall : Options {
    std::string customGain = "20%:1, 5%:2, 1%:0.1";  ///< An example to edit.
};

/// Adds their parameters for a `Call` that derives from TransferCall: first what to change and how
/// strongly, then the shape of the gain.
template <class Call>
void addTransferFields(Fields<Call>& fields);

/// Sets the gain of the type custom: parses it, or takes samples (FilterInput::gain), which make
/// the type custom; and the feature size that it is for.
/// @throws InvalidOption  when there is a mistake.
void resolveCustomGain(const std::string& customGain, const MeshLengths& mesh,
                       const Eigen::MatrixXd& samples, TransferFunctionOptions& transfer,
                       double& featureSize);

/// The name of a filter type, as in the choices of `filter_type`.
std::string nameOf(FilterType type);

/// The default feature size of a mesh.
double featureSizeOf(const MeshLengths& mesh);

/// Field `feature_size`.
template <class Call, class At>
Field<Call> featureSizeField(At at, const char* help) {
    return field<Call>(at, "feature_size", "Feature size", help)
        .in("length")
        .above(0.0)
        .length("auto", featureSizeOf, "six mean edges, at most 5 % of the diagonal");
}

inline bool isBand(FilterType type) {
    return type == FilterType::BandPass || type == FilterType::BandStop;
}

template <class Call>
void addTransferFields(Fields<Call>& fields) {
    const auto ifCustom = [](const Call& call) -> const char* {
        return call.transferFunction.type == FilterType::Custom ? "with |filter_type = custom|"
                                                                : nullptr;
    };
    fields.push_back(
        field<Call>(
            [](auto& call) -> auto& { return call.transferFunction.type; }, "filter_type",
            "Filter type",
            "Which details to change, by their size: *low-pass* keeps those larger than the "
            "feature size and removes the rest; *high-pass* acts on smaller ones (with "
            "|stop_gain| 1 and |pass_gain| 2 it sharpens); *band-pass* acts on details of "
            "about the feature size (with |stop_gain| 1 and |pass_gain| above 1 it enhances "
            "them), *band-stop* removes them; *custom* takes the |transfer_function|.")
            .of({"low-pass", "high-pass", "band-pass", "band-stop", "custom"}));
    fields.push_back(featureSizeField<Call>(
        &Call::featureSize,
        "Size at which the filter cuts off: a wavelength along the surface, that is, a bump and "
        "the hollow next to it. A low-pass leaves a quarter of the height of waves half as long, "
        "and nine tenths of that of waves twice as long. To remove bumps, try four times their "
        "width. "
        "At the default size a low-pass removes the noise of a scan, and thinner parts, such as "
        "fingers and wires, keep their thickness; at any other size they shrink."));
    fields.push_back(field<Call>([](auto& call) -> auto& { return call.transferFunction.power; },
                                 "power", "Fraction of the filter",
                                 "Fraction of the filter to apply, as a power of its gains: 0.5 is "
                                 "half strength (a gain of 4 becomes 2).")
                         .in("exponent")
                         .above(0.0)
                         .to(1.0));
    fields.push_back(field<Call>([](auto& call) -> auto& { return call.transferFunction.passGain; },
                                 "pass_gain", "Pass gain",
                                 "Factor for the details that the filter passes: 1 keeps them, 2 "
                                 "doubles their height, 0 removes them.")
                         .in("factor")
                         .unusedIf(ifCustom));
    fields.push_back(field<Call>([](auto& call) -> auto& { return call.transferFunction.stopGain; },
                                 "stop_gain", "Stop gain",
                                 "Factor for all other details: 0 removes them, 0.5 halves their "
                                 "height, 1 keeps them.")
                         .in("factor")
                         .unusedIf(ifCustom));
    fields.push_back(
        field<Call>(&Call::customGain, "transfer_function", "Transfer function",
                    "For the type custom: gains at feature sizes, like an equalizer, as size:gain "
                    "with sizes in percent of the diagonal (5%), mean edges (6e) or as lengths; or "
                    "an expression of w, the feature size over the wavelength, such as 1/(1 + w^4) "
                    "(f is the frequency, l = f^2).")
            .advanced()
            .unusedIf([](const Call& call) -> const char* {
                return call.transferFunction.type == FilterType::Custom
                           ? nullptr
                           : "without |filter_type = custom|";
            }));
    fields.push_back(
        field<Call>([](auto& call) -> auto& { return call.transferFunction.bandWidth; },
                    "band_width", "Band width (octaves)",
                    "Width of the band for band-pass and band-stop, in octaves: with "
                    "1, its largest details are twice as large as its smallest.")
            .in("octaves")
            .above(0.0)
            .advanced()
            .unusedIf([](const Call& call) -> const char* {
                return isBand(call.transferFunction.type)
                           ? nullptr
                           : "without |filter_type = band-pass| or band-stop";
            }));
    fields.push_back(
        field<Call>([](auto& call) -> auto& { return call.transferFunction.response; }, "response",
                    "Response",
                    "How sharply the filter separates sizes: *gaussian* is gradual and "
                    "never rings; *butterworth* is sharper the higher its |order|; "
                    "*ideal* cuts off abruptly and may leave ripples.")
            .of({"gaussian", "butterworth", "ideal"})
            .advanced()
            .unusedIf(ifCustom));
    fields.push_back(field<Call>([](auto& call) -> auto& { return call.transferFunction.order; },
                                 "order", "Butterworth order",
                                 "Steepness of the butterworth response, from 1 (gentle) to 64 "
                                 "(nearly ideal).")
                         .in("order")
                         .from(1.0)
                         .to(64.0)
                         .advanced()
                         .unusedIf([](const Call& call) -> const char* {
                             return call.transferFunction.type != FilterType::Custom &&
                                            call.transferFunction.response == Response::Butterworth
                                        ? nullptr
                                        : "without |response = butterworth|";
                         }));
}

}  // namespace spectral
