#pragma once

#include <Eigen/Core>
#include <functional>
#include <random>
#include <vector>

#include "types.h"

namespace spectral {

/// Eigenpairs that a recurrence is not to find again.
struct KnownPairs {
    Eigen::Ref<const Eigen::MatrixXd> vectors;  ///< n x c, D-orthonormal.
    Eigen::VectorXd values;                     ///< c eigenvalues of the operator.
};

/// The block Lanczos recurrence M Q = Q T + (the next block) R, with Q^T D Q = I, for an operator M
/// that is self-adjoint in the inner product of the masses D.
///
/// A block, because a solve with several right-hand sides costs little more than one with a single
/// one: each is a pass over a factor that is far larger than the cache.
///
/// Q is semi-orthonormal: orthogonality is lost, in the directions of Ritz vectors that have
/// converged, up to the square root of the machine's precision, and then restored for the two
/// newest blocks in one pass over Q. T is the projection of M to working precision all the same
/// (Simon, The Lanczos Algorithm with Partial Reorthogonalization, 1984; for blocks, and for the
/// known pairs, Grimes, Lewis, Simon, A Shifted Block Lanczos Algorithm, 1994). Vectors that are
/// combined of the columns of Q are orthogonal to each other as far as Q is: the caller
/// orthonormalizes them.
class BlockLanczos {
  public:
    /// M U for U n x c, orthogonal to the null space of whatever M is.
    using Operator = std::function<Eigen::MatrixXd(const Eigen::MatrixXd& U)>;

    /// @param apply  is kept by reference, as are D and known.
    /// @param Q      storage: n rows, and columns for the largest dimension.
    /// @param seed   of the start vectors.
    BlockLanczos(const Operator& apply, const Eigen::VectorXd& D, const KnownPairs& known,
                 Index width, unsigned seed, Eigen::MatrixXd& Q);

    /// One block more. Begins anew, beside the space, when that is invariant: it holds one copy of
    /// a multiple eigenvalue for each column of a block.
    void extend();

    /// Columns of Q, and of T, that M has been applied to.
    Index dimension() const { return dimension_; }

    /// No room for another block, or nothing left beside the space.
    bool exhausted() const { return exhausted_; }

    /// Whether nothing is left beside the space: its Ritz values are all eigenvalues.
    bool isWhole() const { return exhausted_ && coupling_.rows() == 0; }

    auto T() const { return T_.topLeftCorner(dimension_, dimension_); }

    /// |M y - theta y| of every Ritz pair.
    /// @param Z  eigenvectors of T.
    Eigen::VectorXd residuals(const Eigen::MatrixXd& Z) const;

  private:
    void begin();
    void removeKnown(Eigen::Ref<Eigen::MatrixXd> U) const;
    Eigen::MatrixXd orthonormalized(Eigen::MatrixXd U, const Eigen::VectorXd& tiny);
    void propagate();
    void restore();
    bool removeOverlap(const Eigen::Ref<const Eigen::MatrixXd>& others);

    const Operator& apply_;
    const Eigen::VectorXd& D_;
    const KnownPairs& known_;
    Index width_;
    Eigen::MatrixXd& Q_;
    std::mt19937 random_;

    Eigen::MatrixXd T_;         // block tridiagonal
    Eigen::MatrixXd coupling_;  // R
    // The block before the last one, the last one, and the next one begin here; Q ends at end_.
    Index before_ = 0, last_ = 0, dimension_ = 0, end_ = 0;
    bool exhausted_ = false;

    // Estimates of the inner products of the last block and of the next one with the columns of Q
    // before the last block, and with the known vectors.
    Eigen::MatrixXd lossOfLast_, lossOfNext_, knownInLast_, knownInNext_;
    double noise_ = 0.0;  // round-off in products of columns of Q and M Q
};

}  // namespace spectral
