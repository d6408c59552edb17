#include "core/denoise/vertex_update.h"

#include <algorithm>
#include <cmath>

#include "core/krylov/chebyshev_series.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

/// Chebyshev coefficients of ((1 + y) / 2)^sweeps, which vanish beyond some 2 sqrt(sweeps).
std::vector<double> coefficientsOf(int sweeps) {
    constexpr double kAccuracy = 3e-4;
    const ChebyshevSeries series([&](double y) { return std::pow(0.5 * (1.0 + y), sweeps); }, -1.0,
                                 1.0, 2 * sweeps + 2);
    const auto first = series.coefficients().begin();
    return {first, first + series.lengthFor(kAccuracy)};
}

/// The sweeps as a polynomial of one of them, G, whose eigenvalues are in [0, 1]: by the Chebyshev
/// recurrence in 2 G - 1, which takes fewer.
/// @param lines  n x 3: along which the vertices move; null: they move freely.
Points follow(const FaceGraph& graph, const Points& X0, const Points& N,
              const std::vector<bool>& mayMove, int sweeps, const Points* lines) {
    const VertexGraph& faces = graph.faces;
    const std::vector<double> c = coefficientsOf(sweeps);
    std::vector<Eigen::Matrix3d> response(mayMove.size());  // mean of n n^T over the faces
    parallelRows(graph.vertexCount(), [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) {
            response[i].setZero();
            for (Index k = faces.first[i]; k < faces.first[i + 1]; ++k)
                response[i] += N.row(faces.at[k]).transpose() * N.row(faces.at[k]);
            response[i] /= static_cast<double>(std::max<Index>(faces.degree(i), 1));
        }
    });
    Points asked(graph.faceCount(), 3);  // n n^T c
    Points before = X0, here = X0, next = X0, sum = X0;
    for (std::size_t j = 1; j < c.size(); ++j) {
        parallelRows(graph.faceCount(), [&](Index begin, Index end) {
            for (Index f = begin; f < end; ++f) {
                const Eigen::RowVector3d corners =
                    here.row(graph.F(f, 0)) + here.row(graph.F(f, 1)) + here.row(graph.F(f, 2));
                asked.row(f) = N.row(f).dot(corners) / 3.0 * N.row(f);
            }
        });
        parallelRows(graph.vertexCount(), [&](Index begin, Index end) {
            for (Index i = begin; i < end; ++i) {
                if (!mayMove[i] || faces.degree(i) == 0) continue;
                const Eigen::RowVector3d x = here.row(i);
                Eigen::RowVector3d step = Eigen::RowVector3d::Zero();
                for (Index k = faces.first[i]; k < faces.first[i + 1]; ++k)
                    step += asked.row(faces.at[k]);
                step = step / static_cast<double>(faces.degree(i)) - x * response[i];
                if (lines) step = step.dot(lines->row(i)) * lines->row(i);
                const Eigen::RowVector3d moved = x + 2.0 * step;
                next.row(i) = j == 1 ? moved : 2.0 * moved - before.row(i);
                sum.row(i) += c[j] * (next.row(i) - X0.row(i));
            }
        });
        before.swap(here);
        here.swap(next);
    }
    return sum;
}

}  // namespace

Points followNormals(const FaceGraph& graph, const Points& X, const Points& N,
                     const std::vector<bool>& mayMove, int sweeps) {
    return follow(graph, X, N, mayMove, sweeps, nullptr);
}

Points followNormalsAlong(const FaceGraph& graph, const Points& X, const Points& N, const Points& D,
                          const std::vector<bool>& mayMove, int sweeps) {
    constexpr double kMinShare = 0.3;  // of the faces, seen along D: grazing rays are held back
    Points lines = D;
    for (Index i = 0; i < X.rows(); ++i) {
        double squares = 0.0;
        for (Index k = graph.faces.first[i]; k < graph.faces.first[i + 1]; ++k)
            squares += std::pow(N.row(graph.faces.at[k]).dot(D.row(i)), 2);
        const double count = static_cast<double>(std::max<Index>(graph.faces.degree(i), 1));
        lines.row(i) /= std::sqrt(std::max(squares / count, kMinShare));
    }
    return follow(graph, X, N, mayMove, sweeps, &lines);
}

}  // namespace spectral
