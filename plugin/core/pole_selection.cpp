#include "pole_selection.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace spectral {

namespace {

constexpr double kPi = 3.14159265358979323846;

/// Chebyshev nodes: degrees up to this are told apart, more than any Krylov space should need.
constexpr int kNodes = 256;

/// Poles that are tried: powers of two times the cutoff's lambda.
constexpr int kLowestPower = -6, kHighestPower = 12;

/// cos(pi i / (2 kNodes)) for all i of one period.
std::vector<double> cosineTable() {
    std::vector<double> table(4 * kNodes);
    for (std::size_t i = 0; i < table.size(); ++i)
        table[i] = std::cos(kPi * static_cast<double>(i) / (2.0 * kNodes));
    return table;
}

/// Number of Chebyshev coefficients on [thetaMin, 1] after which the sum of the others is below the
/// accuracy: the degree of a polynomial that comes as near as that.
int requiredDegree(const Gain& gain, double pole, double lambdaMax, double accuracy,
                   const std::vector<double>& cosine) {
    const double thetaMin = pole / (lambdaMax + pole);
    std::vector<double> value(kNodes);
    for (int i = 0; i < kNodes; ++i) {
        const double theta = thetaMin + (1.0 - thetaMin) * 0.5 * (1.0 + cosine[2 * i + 1]);
        value[i] = gain(std::sqrt(std::max(0.0, pole / theta - pole)));
    }
    double tail = 0.0;
    for (int degree = kNodes - 1; degree > 0; --degree) {
        double coefficient = 0.0;
        for (int i = 0; i < kNodes; ++i)
            coefficient += value[i] * cosine[degree * (2 * i + 1) % (4 * kNodes)];
        tail += std::abs(coefficient) * 2.0 / kNodes;
        if (tail > accuracy) return degree;
    }
    return 0;
}

}  // namespace

double selectPole(const Gain& gain, double cutoff, double lambdaMax, double accuracy) {
    const std::vector<double> cosine = cosineTable();
    double best = cutoff * cutoff;
    int lowest = kNodes;
    for (int power = kLowestPower; power <= kHighestPower; ++power) {
        const double pole = std::exp2(power) * cutoff * cutoff;
        const int degree = requiredDegree(gain, pole, lambdaMax, accuracy, cosine);
        if (degree < lowest) {
            lowest = degree;
            best = pole;
        }
    }
    return best;
}

double bulkSpectrumEnd(const Laplacian& laplacian) {
    Eigen::VectorXd local = 2.0 * laplacian.W.diagonal().cwiseQuotient(laplacian.D);
    const Index percentile = std::min<Index>(local.size() - 1, local.size() * 99 / 100);
    std::nth_element(local.data(), local.data() + percentile, local.data() + local.size());
    return local[percentile];
}

}  // namespace spectral
