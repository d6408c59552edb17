#include "update_candidates.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "parallel_tasks.h"
#include "symmetric_product.h"

namespace spectral {

namespace {

/// Candidates below the cut that are all looked at; of the others one in so many is.
constexpr Index kNextToCut = 48, kSampling = 8;

/// Candidates that a task looks at, for which it needs copies.
constexpr Index kColumns = 8;

Index at(const std::vector<Index>& indices, Index i) {
    return indices[static_cast<std::size_t>(i)];
}

/// Rayleigh quotients and residuals, as CandidateSpectrum has them, of the columns of S, which
/// loses its constants.
void examine(const Laplacian& laplacian, const ConstantModes& constants, Eigen::MatrixXd& S,
             Eigen::Ref<Eigen::VectorXd> quotient, Eigen::Ref<Eigen::VectorXd> residual) {
    const Eigen::ArrayXd D = laplacian.D.array(), invD = D.inverse();
    constants.remove(S);
    const Eigen::MatrixXd WS = symmetricProduct(laplacian.W, S);
    for (Index j = 0; j < S.cols(); ++j) {
        const auto phi = S.col(j).array();
        const auto Wphi = WS.col(j).array();
        const double squared = (D * phi.square()).sum();
        const double q = (phi * Wphi).sum() / squared;
        quotient[j] = q;
        residual[j] = std::sqrt((invD * (Wphi - q * D * phi).square()).sum() / (q * q * squared));
    }
}

/// Brings vectors into the order of their quotients, in place.
void sortByQuotient(Eigen::Ref<Eigen::VectorXd> quotient, Eigen::Ref<Eigen::MatrixXd> vectors) {
    std::vector<Index> order(static_cast<std::size_t>(quotient.size()));
    std::iota(order.begin(), order.end(), Index{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](Index a, Index b) { return quotient[a] < quotient[b]; });
    for (Index j = 0; j < quotient.size(); ++j) {
        // What was here has gone to where its place was taken from.
        Index from = at(order, j);
        while (from < j) from = at(order, from);
        if (from == j) continue;
        std::swap(quotient[j], quotient[from]);
        vectors.col(j).swap(vectors.col(from));
    }
}

}  // namespace

CandidateSpectrum examineCandidates(const Laplacian& laplacian, const ConstantModes& constants,
                                    Index wanted, Eigen::Ref<Eigen::MatrixXd> candidates,
                                    const Progress& progress) {
    const Index all = candidates.cols(), first = std::max(Index{0}, wanted - kNextToCut);
    std::vector<Index> examined;
    for (Index i = 0; i < first; i += kSampling) examined.push_back(i);
    const auto sampled = static_cast<Index>(examined.size());
    for (Index i = first; i < all; ++i) examined.push_back(i);
    const auto count = static_cast<Index>(examined.size());

    Eigen::VectorXd quotient(count), residual(count);
    runInParallel((count + kColumns - 1) / kColumns,
                  [&](Index task, int, const StopPoint&) {
                      const Index begin = task * kColumns;
                      const Index columns = std::min(kColumns, count - begin);
                      Eigen::MatrixXd S(laplacian.D.size(), columns);
                      for (Index j = 0; j < columns; ++j)
                          S.col(j) = candidates.col(at(examined, begin + j));
                      examine(laplacian, constants, S, quotient.segment(begin, columns),
                              residual.segment(begin, columns));
                  },
                  progress, kUpdateStage);

    auto nextToCut = quotient.tail(count - sampled);
    sortByQuotient(nextToCut, candidates.rightCols(all - first));
    CandidateSpectrum spectrum{Eigen::VectorXd(all), residual.mean()};
    spectrum.quotient.tail(all - first) = nextToCut;
    // Of the others, about: in between those of the sample, which are nearly in order.
    for (Index i = 0; i < first; ++i) {
        const Index place = i / kSampling;
        const double next = place + 1 < sampled ? quotient[place + 1] : nextToCut[0];
        const double part = static_cast<double>(i % kSampling) / kSampling;
        spectrum.quotient[i] = (1.0 - part) * quotient[place] + part * next;
    }
    std::sort(spectrum.quotient.begin(), spectrum.quotient.end());
    return spectrum;
}

}  // namespace spectral
