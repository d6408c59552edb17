#pragma once

#include <Eigen/Core>
#include <mutex>
#include <utility>
#include <vector>

#include "types.h"

namespace spectral {

/// The eigenpairs that runs have found, in a matrix of the size that they will have in the end.
/// While threads add pairs, those that were there before may be read.
class PairStore {
  public:
    PairStore(Index rows, Index capacity) : Phi_(rows, capacity) {
        pairs_.reserve(static_cast<std::size_t>(capacity));
    }

    Index size() const { return static_cast<Index>(pairs_.size()); }
    double lambda(Index i) const { return pairs_[static_cast<std::size_t>(i)].lambda; }
    unsigned run(Index i) const { return pairs_[static_cast<std::size_t>(i)].run; }
    Eigen::VectorXd lambdas() const;
    auto vectors(Index first, Index count) { return Phi_.middleCols(first, count); }

    /// Takes room for pairs with these eigenvalues; returns the first of their columns. May be
    /// called by several threads.
    /// @param run  tells pairs of equal eigenvalues apart, whatever the order of the calls.
    /// @throws SolverFailure  when there are more pairs than there can be.
    Index claim(const Eigen::VectorXd& lambda, unsigned run);

    void clear() { pairs_.clear(); }

    /// Brings the pairs into ascending order, in place.
    void sort();

    /// The matrix of all vectors; the store is empty afterwards.
    Eigen::MatrixXd release() { return std::move(Phi_); }

  private:
    struct Pair {
        double lambda = 0.0;
        unsigned run = 0;
        Index place = 0;  // among the pairs of its run
    };
    Eigen::MatrixXd Phi_;
    std::vector<Pair> pairs_;  // of the first columns
    std::mutex mutex_;
};

}  // namespace spectral
