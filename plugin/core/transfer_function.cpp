#include "transfer_function.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "errors.h"

namespace spectral {

namespace {

/// Beyond this order x^2m overflows within an octave or two and the filter is ideal to round-off.
constexpr int kMaxOrder = 64;

void requireGain(double gain, const char* name) {
    if (!std::isfinite(gain) || gain < 0.0)
        throw InvalidOption(std::string(name) + " = " + std::to_string(gain) +
                            ": a gain must be finite and not negative, because a fractional power "
                            "of a negative gain does not exist; 0 removes, 1 keeps, 2 doubles");
}

}  // namespace

TransferFunction::TransferFunction(const TransferFunctionOptions& options, double cutoff)
    : options_(options), cutoff_(cutoff) {
    if (!std::isfinite(cutoff) || cutoff <= 0.0)
        throw InvalidOption("the cutoff frequency must be finite and positive, it is " +
                            std::to_string(cutoff) + ": choose a feature size above zero");
    if (options.order < 1 || options.order > kMaxOrder)
        throw InvalidOption("order = " + std::to_string(options.order) +
                            ": a Butterworth order lies between 1 and " +
                            std::to_string(kMaxOrder));
    if (!std::isfinite(options.bandWidth) || options.bandWidth <= 0.0)
        throw InvalidOption("band_width = " + std::to_string(options.bandWidth) +
                            ": the width of a band is a positive number of octaves");
    requireGain(options.passGain, "pass_gain");
    requireGain(options.stopGain, "stop_gain");
}

double TransferFunction::operator()(double omega) const {
    return options_.stopGain + (options_.passGain - options_.stopGain) * prototype(omega / cutoff_);
}

double TransferFunction::prototype(double x) const {
    switch (options_.type) {
        case FilterType::LowPass: return lowPass(x);
        case FilterType::HighPass: return lowPass(1.0 / x);
        case FilterType::BandPass: return bandPass(x);
        case FilterType::BandStop: return 1.0 - bandPass(x);
    }
    return 0.0;
}

double TransferFunction::lowPass(double x) const {
    switch (options_.response) {
        case Response::Gaussian: return std::exp2(-0.5 * x * x);
        case Response::Butterworth: return 1.0 / std::sqrt(1.0 + std::pow(x, 2 * options_.order));
        case Response::Ideal: return x <= 1.0 ? 1.0 : 0.0;
    }
    return 0.0;
}

double TransferFunction::bandPass(double x) const {
    const double b = options_.bandWidth;
    switch (options_.response) {
        case Response::Gaussian: {
            const double t = 2.0 * std::log2(x) / b;
            return std::exp2(-0.5 * t * t);
        }
        case Response::Butterworth: {
            const double q = std::exp2(0.5 * b) - std::exp2(-0.5 * b);
            return 1.0 / std::sqrt(1.0 + std::pow(std::abs(x - 1.0 / x) / q, 2 * options_.order));
        }
        case Response::Ideal: return std::abs(std::log2(x)) <= 0.5 * b ? 1.0 : 0.0;
    }
    return 0.0;
}

std::vector<double> TransferFunction::discontinuities() const {
    if (options_.response != Response::Ideal || options_.passGain == options_.stopGain) return {};
    if (options_.type == FilterType::LowPass || options_.type == FilterType::HighPass)
        return {cutoff_};
    const double half = std::exp2(0.5 * options_.bandWidth);
    return {cutoff_ / half, cutoff_ * half};
}

Gain fractionalPower(const TransferFunction& F, double alpha) {
    return [F, alpha](double omega) { return std::pow(F(omega), alpha); };
}

double meanGain(const TransferFunction& F, double from, double to) {
    // F varies on the scale of its cutoff, [from, to] may span decades beyond it: panels that grow
    // geometrically with the distance from the cutoff, cut at the jumps, Simpson's rule in each.
    constexpr int kPanelsPerOctave = 64;
    std::vector<double> cuts{from, to};
    for (const double jump : F.discontinuities())
        if (jump > from && jump < to) cuts.push_back(jump);
    const double smallest = F.cutoff() * 1e-6;
    for (double omega = std::max(from, smallest); omega < to;
         omega *= std::exp2(1.0 / kPanelsPerOctave))
        if (omega > from) cuts.push_back(omega);
    std::sort(cuts.begin(), cuts.end());

    double integral = 0.0;
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        // A hair inside the panel: at a jump each side has its own value.
        const double width = cuts[i + 1] - cuts[i];
        const double inset = 1e-9 * width;
        integral +=
            width / 6.0 *
            (F(cuts[i] + inset) + 4.0 * F(0.5 * (cuts[i] + cuts[i + 1])) + F(cuts[i + 1] - inset));
    }
    return integral / (to - from);
}

}  // namespace spectral
