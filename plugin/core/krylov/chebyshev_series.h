#pragma once

#include <functional>
#include <vector>

namespace spectral {

/// Chebyshev series of a function on an interval,
///     f(t) ~ sum_k c_k T_k(x),  with x from -1 to 1 as t runs from `first` to `last`,
/// from its values at the nodes of the series.
class ChebyshevSeries {
  public:
    /// @param nodes  number of nodes and coefficients, >= 1.
    ChebyshevSeries(const std::function<double(double)>& f, double first, double last, int nodes);

    const std::vector<double>& coefficients() const { return coefficients_; }

    /// Sum of the moduli of the coefficients from the k-th on: bounds the error of the first k.
    double tail(std::size_t k) const { return tail_[k]; }

    /// Number of leading coefficients needed for the accuracy. If it exceeds half of the nodes, the
    /// function is not resolved: the coefficients beyond are aliases.
    int lengthFor(double accuracy) const;

    /// The sum of all terms at t.
    double operator()(double t) const;

    double least() const { return least_; }      ///< Smallest value at the nodes.
    double largest() const { return largest_; }  ///< Largest value at the nodes.

  private:
    double first_, last_;
    std::vector<double> coefficients_, tail_;
    double least_ = 0.0, largest_ = 0.0;
};

}  // namespace spectral
