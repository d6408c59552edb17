#include "core/transfer/transfer_function.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <utility>

#include "core/support/errors.h"
#include "core/support/types.h"

namespace spectral {

namespace {

/// Beyond this order x^2m overflows within an octave or two: the filter is ideal up to round-off.
constexpr int kMaxOrder = 64;

/// Least gain of a notch in fractional powers, relative to the pass gain: 1 % of a detail cannot be
/// seen. A zero has a cusp, which takes 40 times the work and is not reached; 0.2 % twice as much.
constexpr double kLeastNotch = 0.01;

/// Range of a custom transfer function, octaves on either side of the cutoff: wider than the
/// relevant spectrum of any mesh.
constexpr int kOctaves = 16;

void requireGain(double gain, const char* name) {
    if (!std::isfinite(gain) || gain < 0.0)
        throw InvalidOption(std::string(name) + " = " + textOf(gain) +
                            ": a gain must be finite and not negative, because a fractional power "
                            "of a negative gain does not exist; 0 removes, 1 keeps, 2 doubles");
}

/// The same for a custom gain at the frequency omega.
void requireGain(double gain, double omega, double cutoff) {
    if (std::isfinite(gain) && gain >= 0.0) return;
    std::ostringstream text;
    text << "transfer_function is " << gain << " at w = " << omega / cutoff << " (details of size "
         << 2.0 * kPi / omega
         << "): a gain must be finite and not negative; max(0, ...) avoids negative gains";
    throw InvalidOption(text.str());
}

}  // namespace

TransferFunction::TransferFunction(const TransferFunctionOptions& options, double cutoff)
    : options_(options), cutoff_(cutoff) {
    if (!std::isfinite(cutoff) || cutoff <= 0.0)
        throw InvalidOption("the cutoff frequency is " + textOf(cutoff) +
                            ", but must be finite and positive: choose a feature size above zero");
    if (options.order < 1 || options.order > kMaxOrder)
        throw InvalidOption("order = " + std::to_string(options.order) +
                            ": a Butterworth order must be between 1 and " +
                            std::to_string(kMaxOrder));
    if (!std::isfinite(options.bandWidth) || options.bandWidth <= 0.0)
        throw InvalidOption("band_width = " + textOf(options.bandWidth) +
                            ": the width of a band must be a positive number of octaves");
    requireGain(options.passGain, "pass_gain");
    requireGain(options.stopGain, "stop_gain");
    if (!(options.power > 0.0 && options.power <= 1.0))
        throw InvalidOption("power = " + textOf(options.power) +
                            ": the power of the filter must be above 0 and at most 1, the whole "
                            "filter");
    options.type == FilterType::Custom ? sampleCustom() : sample();
}

double TransferFunction::operator()(double omega) const { return power(omega, 1.0); }

double TransferFunction::power(double omega, double alpha) const {
    const double c = options_.dispersion;
    const double x = (c > 0.0 ? omega * std::sqrt(1.0 + c * omega * omega) : omega) / cutoff_;
    const double exponent = alpha * options_.power;
    if (options_.type == FilterType::Custom) return std::pow(custom(omega), exponent);
    // A band-stop is 1 minus the band-pass B: stopGain applies where B is 1.
    double at0 = options_.stopGain, at1 = options_.passGain;
    if (options_.type == FilterType::BandStop) {
        std::swap(at0, at1);
        if (exponent < 1.0 && options_.response != Response::Ideal)
            at1 = std::max(at1, kLeastNotch * at0);
    }
    const double octaves = octavesDown(x), B = std::exp2(-octaves);
    if (at0 == 0.0) return std::pow(at1, exponent) * std::exp2(-exponent * octaves);
    // 1 - B without cancellation: a small power would amplify its round-off.
    const double gain =
        B < 0.5 ? at0 + (at1 - at0) * B : at1 + (at1 - at0) * std::expm1(-std::log(2.0) * octaves);
    return std::pow(gain, exponent);
}

TransferFunction TransferFunction::whole() const {
    TransferFunction whole = *this;
    whole.options_.power = 1.0;
    return whole;
}

/// -log2 of the prototype B, >= 0; for a band-stop, that of the band-pass.
double TransferFunction::octavesDown(double x) const {
    // Map the frequency to that of the equivalent low-pass with cutoff 1.
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
        case FilterType::Custom: break;  // has no prototype
    }
    switch (options_.response) {
        case Response::Gaussian: return 0.5 * y * y;
        case Response::Butterworth: {
            // log2(1 + y^2m) / 2 without overflow
            const double exponent = 2.0 * options_.order * std::log(y);
            const double softplus = exponent > 0.0 ? exponent + std::log1p(std::exp(-exponent))
                                                   : std::log1p(std::exp(exponent));
            return 0.5 * softplus / std::log(2.0);
        }
        case Response::Ideal: break;
    }
    return y <= 1.0 ? 0.0 : std::numeric_limits<double>::infinity();
}

double TransferFunction::custom(double omega) const {
    const double farthest = std::exp2(kOctaves);
    return options_.custom(std::clamp(omega, cutoff_ / farthest, cutoff_ * farthest));
}

void TransferFunction::sample() {
    // A Butterworth filter of order m rolls off within 1/m octaves, or 1/m of the bandwidth; a
    // Gaussian one within four times that width.
    constexpr int kPerFall = 8;
    const bool isBand =
        options_.type == FilterType::BandPass || options_.type == FilterType::BandStop;
    const double width = isBand ? options_.bandWidth : 1.0;
    const int order = options_.response == Response::Butterworth ? options_.order : 2;
    for (int i = -2 * kPerFall * order; i <= 2 * kPerFall * order; ++i)
        samples_.push_back(cutoff_ * std::exp2(width * i / (kPerFall * order)));
    if (options_.response != Response::Ideal || options_.passGain == options_.stopGain) return;
    const double half = std::exp2(0.5 * options_.bandWidth);
    if (isBand)
        jumps_ = {cutoff_ / half, cutoff_ * half};
    else
        jumps_ = {cutoff_};
}

void TransferFunction::sampleCustom() {
    constexpr int kPerOctave = 16;
    constexpr double kResolved = 0.02;  // largest change between samples, relative to F's range
    std::vector<double> omega;
    for (int i = -kOctaves * kPerOctave; i <= kOctaves * kPerOctave; ++i)
        omega.push_back(cutoff_ * std::exp2(static_cast<double>(i) / kPerOctave));
    double least = std::numeric_limits<double>::infinity(), largest = 0.0;
    for (const double frequency : omega) {
        const double gain = custom(frequency);
        requireGain(gain, frequency, cutoff_);
        least = std::min(least, gain);
        largest = std::max(largest, gain);
    }
    for (std::size_t i = 0; i + 1 < omega.size(); ++i) {
        samples_.push_back(omega[i]);
        sampleBetween(omega[i], omega[i + 1], kResolved * (largest - least));
    }
    samples_.push_back(omega.back());
}

/// Appends samples and jumps in the interval (from, to).
void TransferFunction::sampleBetween(double from, double to, double tolerance) {
    constexpr double kJump = 1e-9;  // relative width in which only a discontinuous gain varies
    if (!(std::abs(custom(to) - custom(from)) > tolerance)) return;
    const double middle = std::sqrt(from * to);
    if (to - from <= kJump * to) {
        jumps_.push_back(middle);
        return;
    }
    requireGain(custom(middle), middle, cutoff_);
    sampleBetween(from, middle, tolerance);
    samples_.push_back(middle);
    sampleBetween(middle, to, tolerance);
}

bool TransferFunction::isOne() const {
    return std::all_of(samples_.begin(), samples_.end(),
                       [&](double omega) { return (*this)(omega) == 1.0; });
}

bool TransferFunction::isConstantBeyondJumps() const {
    if (options_.type != FilterType::Custom || jumps_.empty()) return true;
    const double last = custom(samples_.back());
    return std::all_of(std::upper_bound(samples_.begin(), samples_.end(), jumps_.back()),
                       samples_.end(), [&](double omega) { return custom(omega) == last; });
}

Gain fractionalPower(const TransferFunction& F, double alpha) {
    // Kovnatsky et al. 2012, Eq. 11.
    return [F, alpha](double omega) { return F.power(omega, alpha); };
}

double meanGain(const TransferFunction& F, double from, double to) {
    // Simpson's rule on panels cut at the jumps. F varies on the scale of its cutoff, but [from,
    // to] may span decades beyond it: the panels grow geometrically with the frequency.
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
        // Evaluate slightly inside the panel: at a jump, the two sides differ.
        const double width = cuts[i + 1] - cuts[i];
        const double inset = 1e-9 * width;
        integral +=
            width / 6.0 *
            (F(cuts[i] + inset) + 4.0 * F(0.5 * (cuts[i] + cuts[i + 1])) + F(cuts[i + 1] - inset));
    }
    return integral / (to - from);  // Kovnatsky et al. 2012, Eq. 9
}

}  // namespace spectral
