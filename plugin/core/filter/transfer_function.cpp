#include "core/filter/transfer_function.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/laplacian/frequency.h"
#include "core/support/errors.h"
#include "core/support/types.h"

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
    if (!(options.power > 0.0 && options.power <= 1.0))
        throw InvalidOption("power = " + std::to_string(options.power) +
                            ": the part of the filter to apply is above 0 and at most 1, the whole "
                            "filter");
}

double TransferFunction::operator()(double omega) const { return power(omega, 1.0); }

double TransferFunction::power(double omega, double alpha) const {
    const double x = omega / cutoff_, exponent = alpha * options_.power;
    const double stop = options_.stopGain, pass = options_.passGain;
    const bool passesOnly = stop == 0.0 && options_.type != FilterType::BandStop;
    if (!passesOnly) return std::pow(stop + (pass - stop) * prototype(x), exponent);
    return std::pow(pass, exponent) * std::exp2(-exponent * octavesDown(x));
}

TransferFunction TransferFunction::whole() const {
    TransferFunctionOptions options = options_;
    options.power = 1.0;
    return TransferFunction(options, cutoff_);
}

double TransferFunction::prototype(double x) const {
    const double B = std::exp2(-octavesDown(x));
    return options_.type == FilterType::BandStop ? 1.0 - B : B;
}

/// -log2 of the prototype B, >= 0; of the band-pass for a band-stop.
double TransferFunction::octavesDown(double x) const {
    // The frequency as the low-pass sees it: its cutoff is at 1.
    double y = x;
    switch (options_.type) {
        case FilterType::LowPass: break;
        case FilterType::HighPass: y = 1.0 / x; break;
        case FilterType::BandPass:
        case FilterType::BandStop: {
            const double b = options_.bandWidth;
            const double q = std::exp2(0.5 * b) - std::exp2(-0.5 * b);
            y = options_.response == Response::Butterworth ? std::abs(x - 1.0 / x) / q
                                                           : 2.0 * std::abs(std::log2(x)) / b;
            break;
        }
    }
    switch (options_.response) {
        case Response::Gaussian: return 0.5 * y * y;
        case Response::Butterworth: {
            // log2(1 + y^2m) / 2, without forming a power that overflows
            const double exponent = 2.0 * options_.order * std::log(y);
            const double softplus = exponent > 0.0 ? exponent + std::log1p(std::exp(-exponent))
                                                   : std::log1p(std::exp(exponent));
            return 0.5 * softplus / std::log(2.0);
        }
        case Response::Ideal: break;
    }
    return y <= 1.0 ? 0.0 : std::numeric_limits<double>::infinity();
}

std::vector<double> TransferFunction::discontinuities() const {
    if (options_.response != Response::Ideal || options_.passGain == options_.stopGain) return {};
    if (options_.type == FilterType::LowPass || options_.type == FilterType::HighPass)
        return {cutoff_};
    const double half = std::exp2(0.5 * options_.bandWidth);
    return {cutoff_ / half, cutoff_ * half};
}

std::vector<double> TransferFunction::samples() const {
    // A Butterworth filter of order m falls from its pass band within 1/m octaves, or 1/m of the
    // width of a band; a Gaussian one matters up to four widths away.
    constexpr int kPerFall = 8;
    const bool isBand =
        options_.type == FilterType::BandPass || options_.type == FilterType::BandStop;
    const double width = isBand ? options_.bandWidth : 1.0;
    const int order = options_.response == Response::Butterworth ? options_.order : 2;
    std::vector<double> samples;
    for (int i = -2 * kPerFall * order; i <= 2 * kPerFall * order; ++i)
        samples.push_back(cutoff_ * std::exp2(width * i / (kPerFall * order)));
    return samples;
}

Gain fractionalPower(const TransferFunction& F, double alpha) {
    return [F, alpha](double omega) { return F.power(omega, alpha); };
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
