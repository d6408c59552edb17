#include "block_lanczos.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "mass_products.h"

namespace spectral {

namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Orthogonality that is kept: the square root of kEpsilon.
constexpr double kSemiOrthogonal = 1e-8;

/// Round-off by which known vectors differ from eigenvectors, relative to the operator: more than
/// in columns of Q.
constexpr double kKnownError = 1e-12;

/// Overlap after whose removal a block is no longer orthonormal within.
constexpr double kSevere = 1e-6;
constexpr int kMaxPasses = 3;

/// Length of what is left of a vector that depends on others, beside the vector's own: within a
/// block, and beside columns that are orthogonal to each other only to kSemiOrthogonal.
constexpr double kTiny = 1e-13, kTinyBeside = 1e-6;

double largest(const Eigen::MatrixXd& E) { return E.size() > 0 ? E.cwiseAbs().maxCoeff() : 0.0; }

/// Moves all entries away from zero.
void enlarge(Eigen::MatrixXd& E, double by) {
    E = E.unaryExpr([by](double e) { return e + std::copysign(by, e); });
}

}  // namespace

BlockLanczos::BlockLanczos(const Operator& apply, const Eigen::VectorXd& D, const KnownPairs& known,
                           Index width, unsigned seed, Eigen::MatrixXd& Q)
    : apply_(apply),
      D_(D),
      known_(known),
      width_(std::min(width, Q.cols())),
      Q_(Q),
      random_(seed),
      T_(Eigen::MatrixXd::Zero(Q.cols(), Q.cols())) {
    begin();
}

void BlockLanczos::begin() {
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    Eigen::MatrixXd U(Q_.rows(), std::min(width_, Q_.cols() - end_));
    for (Index j = 0; j < U.cols(); ++j)
        for (Index i = 0; i < U.rows(); ++i) U(i, j) = uniform(random_);
    U = apply_(U);
    const Eigen::VectorXd scale = innerProducts(U, D_, U).diagonal().cwiseSqrt();
    for (int pass = 0; pass < 2; ++pass) {
        const auto Q = Q_.leftCols(end_);
        subtractProduct(Q, innerProducts(Q, D_, U), U);
        removeKnown(U);
    }
    orthonormalized(U, kTiny * scale);
    exhausted_ = end_ == dimension_;
    const Index width = end_ - dimension_;
    lossOfNext_ = Eigen::MatrixXd::Constant(dimension_, width, kEpsilon);
    knownInNext_ = Eigen::MatrixXd::Constant(known_.values.size(), width, kEpsilon);
}

void BlockLanczos::extend() {
    const Index first = dimension_, width = end_ - first;
    const auto block = Q_.middleCols(first, width);
    Eigen::MatrixXd U = apply_(block);
    const Eigen::VectorXd scale = innerProducts(U, D_, U).diagonal().cwiseSqrt();
    // The recurrence, and once more for what round-off has let in.
    const auto beside = Q_.middleCols(last_, end_ - last_);
    const Eigen::MatrixXd product = innerProducts(beside, D_, U);
    subtractProduct(beside, product, U);
    subtractProduct(beside, innerProducts(beside, D_, U), U);
    const Eigen::MatrixXd A = product.bottomRows(width);
    T_.block(first, first, width, width) = 0.5 * (A + A.transpose());
    // M is self-adjoint but for round-off.
    const auto above = T_.block(last_, first, first - last_, width);
    noise_ = std::max({noise_, kEpsilon * scale.maxCoeff(), largest(A - A.transpose()),
                       largest(product.topRows(first - last_) - above)});

    before_ = last_;
    last_ = first;
    dimension_ = end_;
    if (end_ + width > Q_.cols()) {
        exhausted_ = true;
        const Eigen::HouseholderQR<Eigen::MatrixXd> qr(D_.cwiseSqrt().asDiagonal() * U);
        coupling_ = qr.matrixQR().topRows(width).triangularView<Eigen::Upper>();
        return;
    }
    coupling_ = orthonormalized(std::move(U), kTiny * scale);
    propagate();
    restore();
    const Index next = end_ - dimension_;
    T_.block(dimension_, first, next, width) = coupling_;
    T_.block(first, dimension_, width, next) = coupling_.transpose();
    if (next == 0) begin();
}

Eigen::VectorXd BlockLanczos::residuals(const Eigen::MatrixXd& Z) const {
    return (coupling_ * Z.bottomRows(dimension_ - last_)).colwise().norm();
}

void BlockLanczos::removeKnown(Eigen::Ref<Eigen::MatrixXd> U) const {
    subtractProduct(known_.vectors, innerProducts(known_.vectors, D_, U), U);
}

/// Makes the columns of U orthonormal; they follow those of Q, but for columns that depend on
/// others, what is left of them shorter than `tiny`. Returns R of U = (the new columns) R.
Eigen::MatrixXd BlockLanczos::orthonormalized(Eigen::MatrixXd U, const Eigen::VectorXd& tiny) {
    const Index first = end_;
    Eigen::MatrixXd R = Eigen::MatrixXd::Zero(U.cols(), U.cols());
    for (Index j = 0; j < U.cols(); ++j) {
        const Index count = end_ - first;
        const auto done = Q_.middleCols(first, count);
        for (int pass = 0; pass < 2; ++pass) {
            const Eigen::MatrixXd r = innerProducts(done, D_, U.col(j));
            subtractProduct(done, r, U.col(j));
            R.col(j).head(count) += r;
        }
        const double norm = std::sqrt(U.col(j).cwiseAbs2().dot(D_));
        if (!(norm > tiny[j])) continue;
        R(count, j) = norm;
        Q_.col(end_++) = U.col(j) / norm;
    }
    return R.topRows(end_ - first);
}

/// The recurrence of the inner products of the next block with the columns of Q before the last
/// one, and with the known vectors.
void BlockLanczos::propagate() {
    const Index width = dimension_ - last_, next = end_ - dimension_, known = known_.values.size();
    lossOfLast_.swap(lossOfNext_);
    knownInLast_.swap(knownInNext_);  // what was of the last block is of the one before, in Next_
    if (next < width) {               // columns have been left out: nothing is known of the others
        lossOfNext_ = Eigen::MatrixXd::Ones(dimension_, next);
        knownInNext_ = Eigen::MatrixXd::Ones(known, next);
        return;
    }
    const auto A = T_.block(last_, last_, width, width);
    const auto C = T_.block(before_, last_, last_ - before_, width);
    const auto R = coupling_.triangularView<Eigen::Upper>();

    Eigen::MatrixXd loss = T_.topLeftCorner(last_, last_) * lossOfLast_ - lossOfLast_ * A;
    loss.topRows(before_) -= lossOfNext_ * C;
    enlarge(loss, noise_);
    if (last_ > 0) loss = R.solve<Eigen::OnTheRight>(loss);
    // Next to the diagonal the products have been removed.
    lossOfNext_ = Eigen::MatrixXd::Constant(dimension_, next, kEpsilon);
    lossOfNext_.topRows(before_) = loss.topRows(before_);

    if (known == 0) return;
    Eigen::MatrixXd part = known_.values.asDiagonal() * knownInLast_ - knownInLast_ * A;
    if (last_ > 0) part -= knownInNext_ * C;
    enlarge(part, std::max(noise_, kKnownError * known_.values.cwiseAbs().maxCoeff()));
    knownInNext_ = R.solve<Eigen::OnTheRight>(part);
}

/// Makes the last block and the next one orthogonal to the columns before and to the known vectors,
/// where that is needed.
void BlockLanczos::restore() {
    bool before = !(largest(lossOfNext_) < kSemiOrthogonal);
    bool known = !(largest(knownInNext_) < kSemiOrthogonal);
    for (int pass = 0; pass < kMaxPasses; ++pass) {
        bool severe = before && removeOverlap(Q_.leftCols(last_));
        severe = (known && removeOverlap(known_.vectors)) || severe;
        if (!severe) break;
        before = known = true;  // round-off of either is now much of what little was left
    }
    const Index next = end_ - dimension_;
    if (before) {
        lossOfLast_.setConstant(kEpsilon);
        lossOfNext_ = Eigen::MatrixXd::Constant(dimension_, next, kEpsilon);
    }
    if (known) {
        knownInLast_.setConstant(kEpsilon);
        knownInNext_ = Eigen::MatrixXd::Constant(known_.values.size(), next, kEpsilon);
    }
}

/// Takes others out of the last block and the next one. Returns whether that left so little of the
/// next one that it had to be made orthonormal again.
bool BlockLanczos::removeOverlap(const Eigen::Ref<const Eigen::MatrixXd>& others) {
    auto blocks = Q_.middleCols(last_, end_ - last_);
    const Eigen::MatrixXd overlap = innerProducts(others, D_, blocks);
    subtractProduct(others, overlap, blocks);
    if (largest(overlap) < kSevere) return false;
    const Index next = end_ - dimension_;
    end_ = dimension_;
    const auto last = Q_.middleCols(last_, dimension_ - last_);
    Eigen::MatrixXd U = Q_.middleCols(dimension_, next);
    subtractProduct(last, innerProducts(last, D_, U), U);
    coupling_ =
        orthonormalized(std::move(U), Eigen::VectorXd::Constant(next, kTinyBeside)) * coupling_;
    return true;
}

}  // namespace spectral
