#include "core/denoise/normal_filter.h"

#include <array>
#include <cmath>

#include "core/support/threads.h"

namespace spectral {

namespace {

/// Lower bound of a face's area relative to the mean; bounds the condition number of the system.
constexpr double kMinArea = 0.05;

/// How strongly noise tilts blurred normals.
constexpr double kTilt = 0.5;
/// Inverse of the relative local area below which the tilt matters: half of the mean.
constexpr double kShort = 2.0;

/// Smoothed area around each face, relative to the mean: square roots of the areas, repeatedly
/// averaged with the neighbours to suppress noise.
Eigen::VectorXd localAreas(const FaceGraph& graph, const Eigen::VectorXd& area) {
    constexpr int kAreaBlurs = 6;
    constexpr double kOwn = 0.25;
    Eigen::VectorXd length = (area / area.mean()).cwiseSqrt(), next = length;
    for (int k = 0; k < kAreaBlurs; ++k) {
        parallelRows(area.size(), [&](Index begin, Index end) {
            for (Index f = begin; f < end; ++f) {
                double sum = 0.0, count = 0.0;
                for (int c = 0; c < 3; ++c) {
                    if (graph.neighbours(f, c) < 0) continue;
                    sum += length[graph.neighbours(f, c)];
                    count += 1.0;
                }
                next[f] = count > 0.0 ? kOwn * length[f] + (1.0 - kOwn) * sum / count : length[f];
            }
        });
        length.swap(next);
    }
    return length.cwiseAbs2();
}

/// Distance of normals below which total variation is smooth.
constexpr double kSmooth = 0.05;

/// Distance of the guide's normals above which a part is not flat.
constexpr double kFlat = 0.02;

Points unitNormals(Points N) {
    normalizeRows(N);
    return N;
}

/// The matrix A = M + t L.
class System {
  public:
    using Columns = Eigen::Array<double, 1, 3>;

    /// @param N            face normals with length twice the area.
    /// @param q            unit normals that define the weights.
    /// @param isVariation  whether these are those of normalsOfLeastVariation.
    System(const FaceGraph& graph, const Points& X, const Points& N, const Points& q,
           const NormalFilterOptions& options, bool isVariation = false)
        : neighbours_(graph.neighbours),
          weight_(N.rows(), 3),
          mass_(N.rows()),
          diagonal_(N.rows()) {
        Eigen::VectorXd area(N.rows());
        parallelRows(N.rows(), [&](Index begin, Index end) {
            for (Index f = begin; f < end; ++f) area[f] = N.row(f).norm();
        });
        const double mean = area.mean();
        const Eigen::VectorXd local = options.noise ? localAreas(graph, area) : Eigen::VectorXd();
        const double squaredScale = options.edgeScale * options.edgeScale;
        const double lengths = parallelSum(N.rows(), 0.0, [&](Index begin, Index end) {
            double sum = 0.0;
            for (Index f = begin; f < end; ++f) {
                mass_[f] = std::max(area[f] / mean, kMinArea);
                if (!isVariation) mass_[f] = std::sqrt(mass_[f]);
                for (int c = 0; c < 3; ++c) {
                    const Eigen::RowVector3d side =
                        X.row(graph.F(f, (c + 1) % 3)) - X.row(graph.F(f, (c + 2) % 3));
                    sum += side.norm();
                    const int other = neighbours_(f, c);
                    weight_(f, c) = 0.0;
                    if (other < 0) continue;
                    const double distance = (q.row(f) - q.row(other)).squaredNorm();
                    double squaredTilt = 0.0, factor = 1.0;
                    if (const FacesInNoise* noise = options.noise) {
                        const double shortness =
                            std::max(0.0, 1.0 / std::sqrt(local[f] * local[other]) - kShort);
                        squaredTilt =
                            kTilt * kTilt * noise->height[f] * noise->height[other] * shortness;
                        factor = std::sqrt(noise->time[f] * noise->time[other]);
                    }
                    weight_(f, c) =
                        factor * side.norm() *
                        (isVariation
                             ? options.edgeScale / std::sqrt(distance + kSmooth * kSmooth)
                             : std::exp(-0.5 * distance / (squaredScale + squaredTilt)) +
                                   options.flatness * kFlat * kFlat / (distance + kFlat * kFlat));
                }
            }
            return sum;
        });
        weight_ *= options.time * 3.0 * static_cast<double>(N.rows()) / lengths;
        diagonal_ = mass_ + weight_.rowwise().sum();
    }

    const Eigen::VectorXd& mass() const { return mass_; }

    /// Solves A X = B by conjugate gradients with a diagonal preconditioner. Takes few iterations:
    /// the eigenvalues of A exceed those of M by about 6 t at most.
    /// @param X          initial guess.
    /// @param tolerance  squared norms of the columns of the residual.
    void solve(const Points& B, const Columns& tolerance, Points& X) const {
        constexpr int kMaxIterationsOfNormals = 300;
        Points Q(B.rows(), 3), R(B.rows(), 3), D(B.rows(), 3);
        multiply(X, Q);
        Columns squares = Columns::Zero();  // squared norms of the residual
        Columns descent = sumOverRows(B.rows(), squares, [&](Index f) {
            R.row(f) = B.row(f) - Q.row(f);
            D.row(f) = R.row(f) / diagonal_[f];
            return R.row(f);
        });
        for (int k = 0; k < kMaxIterationsOfNormals && (squares > tolerance).any(); ++k) {
            const Columns curvature = multiply(D, Q);
            const Columns step = (curvature > 0.0).select(descent / curvature, 0.0);
            const Columns next = sumOverRows(B.rows(), squares, [&](Index f) {
                X.row(f).array() += step * D.row(f).array();
                R.row(f).array() -= step * Q.row(f).array();
                return R.row(f);
            });
            const Columns turn = (descent > 0.0).select(next / descent, 0.0);
            descent = next;
            parallelRows(B.rows(), [&](Index begin, Index end) {
                for (Index f = begin; f < end; ++f)
                    D.row(f) = (R.row(f) / diagonal_[f]).array() + turn * D.row(f).array();
            });
        }
    }

  private:
    /// Y = A X; returns the inner products of the columns of X and Y.
    Columns multiply(const Points& X, Points& Y) const {
        return parallelSum(X.rows(), Columns(Columns::Zero()), [&](Index begin, Index end) {
            Columns products = Columns::Zero();
            for (Index f = begin; f < end; ++f) {
                Eigen::RowVector3d sum = diagonal_[f] * X.row(f);
                for (int c = 0; c < 3; ++c)
                    if (neighbours_(f, c) >= 0) sum -= weight_(f, c) * X.row(neighbours_(f, c));
                Y.row(f) = sum;
                products += sum.array() * X.row(f).array();
            }
            return products;
        });
    }

    /// Visits every row of a residual; returns the squared norms of its columns in the
    /// preconditioner's norm, and sets `squares` to the Euclidean ones.
    template <class Visit>
    Columns sumOverRows(Index count, Columns& squares, const Visit& visit) const {
        using Sums = Eigen::Array<double, 2, 3>;
        const Sums sums = parallelSum(count, Sums(Sums::Zero()), [&](Index begin, Index end) {
            Sums sum = Sums::Zero();
            for (Index f = begin; f < end; ++f) {
                const Columns square = visit(f).array().square();
                sum.row(0) += square;
                sum.row(1) += square / diagonal_[f];
            }
            return sum;
        });
        squares = sums.row(0);
        return sums.row(1);
    }

    const Faces& neighbours_;
    Points weight_;  // m x 3: for each side, t times the weight in L
    Eigen::VectorXd mass_, diagonal_;
};

}  // namespace

Points filterNormals(const FaceGraph& graph, const Points& X, const NormalFilterOptions& options,
                     const Points& guess) {
    Points N = areaNormals(X, graph.F);
    if (!(N.cwiseAbs().maxCoeff() > 0.0)) return N;  // all faces are degenerate
    const System A(
        graph, X, N,
        options.guide ? *options.guide : unitNormals(blurredNormals(graph, N, options.blurs)),
        options);
    normalizeRows(N);
    const Points B = A.mass().asDiagonal() * N;
    const System::Columns tolerance =
        options.accuracy * options.accuracy * B.colwise().squaredNorm().array();
    Points filtered = guess.rows() == N.rows() ? guess : N;
    A.solve(B, tolerance, filtered);
    if (options.useTwicing) {
        Points again = Points::Zero(N.rows(), 3);
        A.solve(A.mass().asDiagonal() * (N - filtered), tolerance, again);
        filtered += again;
    }
    normalizeRows(filtered);
    return filtered;
}

Points normalsOfLeastVariation(const FaceGraph& graph, const Points& X, double time) {
    constexpr int kIterations = 5, kFirstBlurs = 6;
    NormalFilterOptions options;
    options.accuracy = 1e-3;
    options.time = time;
    options.edgeScale = 0.22;
    const Points N = areaNormals(X, graph.F);
    Points smooth = unitNormals(blurredNormals(graph, N, kFirstBlurs));
    for (int k = 0; k < kIterations; ++k) {
        const System A(graph, X, N, smooth, options, true);
        const Points B = A.mass().asDiagonal() * unitNormals(N);
        A.solve(B, options.accuracy * options.accuracy * B.colwise().squaredNorm().array(), smooth);
        normalizeRows(smooth);
    }
    return smooth;
}

}  // namespace spectral
