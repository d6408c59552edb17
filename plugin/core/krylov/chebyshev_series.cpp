#include "core/krylov/chebyshev_series.h"

#include <algorithm>
#include <cmath>

#include "core/support/types.h"

namespace spectral {

ChebyshevSeries::ChebyshevSeries(const std::function<double(double)>& f, double first, double last,
                                 int nodes)
    : first_(first),
      last_(last),
      coefficients_(static_cast<std::size_t>(nodes), 0.0),
      tail_(coefficients_.size() + 1, 0.0) {
    const std::size_t count = coefficients_.size(), period = 4 * count;
    std::vector<double> cosine(period);  // cos(pi i / (2 nodes))
    for (std::size_t i = 0; i < period; ++i)
        cosine[i] = std::cos(kPi * static_cast<double>(i) / (2.0 * nodes));
    std::vector<double> value(count);
    for (std::size_t i = 0; i < count; ++i)
        value[i] = f(first + (last - first) * 0.5 * (1.0 + cosine[2 * i + 1]));
    const auto [least, largest] = std::minmax_element(value.begin(), value.end());
    least_ = *least;
    largest_ = *largest;
    for (std::size_t k = count; k-- > 0;) {
        double sum = 0.0;
        for (std::size_t i = 0, angle = k; i < count; ++i) {  // k (2 i + 1), modulo the period
            sum += value[i] * cosine[angle];
            angle += 2 * k;
            if (angle >= period) angle -= period;
        }
        coefficients_[k] = sum * (k == 0 ? 1.0 : 2.0) / nodes;
        tail_[k] = tail_[k + 1] + std::abs(coefficients_[k]);
    }
}

int ChebyshevSeries::lengthFor(double accuracy) const {
    return static_cast<int>(
        std::partition_point(tail_.begin(), tail_.end(), [&](double t) { return t > accuracy; }) -
        tail_.begin());
}

double ChebyshevSeries::operator()(double t) const {
    const double x = 2.0 * (t - first_) / (last_ - first_) - 1.0;
    double newest = 0.0, before = 0.0;  // Clenshaw's recurrence
    for (std::size_t k = coefficients_.size(); k-- > 1;) {
        const double next = coefficients_[k] + 2.0 * x * newest - before;
        before = newest;
        newest = next;
    }
    return coefficients_[0] + x * newest - before;
}

}  // namespace spectral
