#include "core/laplacian/selection_weight.h"

#include <algorithm>
#include <cmath>

#include "core/laplacian/interior.h"
#include "core/ldlt/shifted_ldlt.h"

namespace spectral {

Eigen::VectorXd selectionWeight(const Laplacian& laplacian, const Components& components,
                                const std::vector<bool>& selected, double width) {
    constexpr double kLengths = 3.0;  // in a width
    const Interior rest(components, selected);
    Eigen::VectorXd m(laplacian.D.size());
    for (Index i = 0; i < m.size(); ++i) m[i] = selected[i] ? 1.0 : 0.0;
    if (rest.size() > 0) {
        const Laplacian around = rest.restricted(laplacian);
        ShiftedLdlt ldlt;
        ldlt.factorizeDefinite(around.W, around.D, std::pow(kLengths / width, 2));
        m += rest.extended(ldlt.solve(-rest.restricted(Eigen::MatrixXd(laplacian.W * m))));
    }
    const double last = std::exp(-kLengths);
    return m.unaryExpr([last](double value) {
        const double t = std::clamp((value - last) / (1.0 - last), 0.0, 1.0);
        return t * t * (3.0 - 2.0 * t);
    });
}

}  // namespace spectral
