#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/support/types.h"

namespace spectral {

enum class FilterType { LowPass, HighPass, BandPass, BandStop, Custom };
enum class Response { Gaussian, Butterworth, Ideal };

/// Shape of a transfer function; the frequency axis is set by TransferFunction.
struct TransferFunctionOptions {
    FilterType type = FilterType::LowPass;
    Response response = Response::Gaussian;
    int order = 2;            ///< Butterworth order m, 1 to 64.
    double bandWidth = 1.0;   ///< Full width of a band between its -3 dB points, octaves, > 0.
    double passGain = 1.0;    ///< Gain in the pass band, >= 0.
    double stopGain = 0.0;    ///< Gain in the stop band, >= 0.
    double power = 1.0;       ///< Fractional power, 0 < power <= 1; 1 is the whole filter.
    double dispersion = 0.0;  ///< c, length^2, >= 0: a mesh shows waves of the frequency
                              ///< omega (1 + c omega^2)^1/2 at the frequency omega.
    Gain custom;              ///< Gain for FilterType::Custom, which otherwise uses only the power.
};

/// Transfer function F(omega) = (stopGain + (passGain - stopGain) B(omega / omega_c))^power.
///
/// The prototype B is -3 dB (1/sqrt 2) at its cutoff; with x = omega / omega_c and b = bandWidth:
///   low-pass   Gaussian 2^(-x^2/2), Butterworth 1/sqrt(1 + x^2m), ideal 1 for x <= 1, else 0;
///   high-pass  the low-pass at 1/x;
///   band-pass  Gaussian 2^(-(2 log2(x)/b)^2/2), Butterworth 1/sqrt(1 + ((x - 1/x)/q)^2m) with
///              q = 2^(b/2) - 2^(-b/2), ideal 1 inside |log2 x| <= b/2;
///   band-stop  1 minus the band-pass; in fractional powers, unless ideal, F is at least 1 % of
///              passGain: those of a zero have a cusp, which no few steps or solves follow.
/// A custom F is custom(omega)^power, with omega clamped to sixteen octaves on either side of
/// omega_c. F is finite and >= 0 everywhere, so that every fractional power of it exists.
class TransferFunction {
  public:
    /// @param cutoff  omega_c, radians per length unit, > 0: the cutoff (low-pass, high-pass) or
    ///                the centre of the band.
    /// @throws InvalidOption  when an option is out of range, or a custom gain is negative or not
    ///                        finite; the message names the frequency.
    TransferFunction(const TransferFunctionOptions& options, double cutoff);

    /// Gain F(omega) at the frequency omega >= 0 (radians per length unit; infinity is allowed).
    double operator()(double omega) const;

    /// F(omega)^alpha, alpha > 0, even where F itself underflows: a Gaussian to the power of 1/100
    /// still matters there.
    double power(double omega, double alpha) const;

    double cutoff() const { return cutoff_; }

    double appliedPower() const { return options_.power; }

    /// The same transfer function with power = 1, of which F is a power.
    TransferFunction whole() const;

    /// Frequencies at which F jumps, ascending; empty for a continuous F.
    const std::vector<double>& discontinuities() const { return jumps_; }

    /// Whether F is 1 at every frequency: the filter changes nothing.
    bool isOne() const;

    /// Whether F is constant beyond its last jump.
    bool isConstantBeyondJumps() const;

    /// Frequencies around the cutoff, dense enough that F varies little in between.
    const std::vector<double>& samples() const { return samples_; }

  private:
    double octavesDown(double x) const;
    double custom(double omega) const;
    void sample();
    void sampleCustom();
    void sampleBetween(double from, double to, double tolerance);

    TransferFunctionOptions options_;
    double cutoff_;
    std::vector<double> jumps_, samples_;  // ascending
};

/// The gain F^alpha of one fractional step (Kovnatsky et al. 2012, Eq. 11).
///
/// @param alpha  fractional power, 0 < alpha <= 1; 1 is the whole filter.
/// Filters keep the constant mode (omega = 0), whatever F(0) is.
Gain fractionalPower(const TransferFunction& F, double alpha);

/// Mean of F over the frequencies in [from, to], 0 <= from < to. With power = 1, the gain for the
/// residual of a truncated basis (Vallet and Levy 2008, section 4.3; Kovnatsky et al. 2012, Eq. 9).
double meanGain(const TransferFunction& F, double from, double to);

}  // namespace spectral
