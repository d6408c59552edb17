#include "core/laplacian/vertex_weight.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/ldlt/shifted_ldlt.h"
#include "core/support/errors.h"

namespace spectral {

namespace {

bool contains(const std::vector<bool>& values, bool value) {
    return std::find(values.begin(), values.end(), value) != values.end();
}

}  // namespace

void checkWeights(const WeightOptions& options) {
    if (!options.selected.empty() && !contains(options.selected, true))
        throw InvalidOption(
            "nothing is selected: select faces or vertices, or set selected = "
            "false for the whole mesh");
    for (Index i = 0; i < options.weight.size(); ++i)
        if (!(options.weight[i] >= 0.0 && options.weight[i] <= 1.0))
            throw InvalidOption(
                "the weight of vertex " + std::to_string(i) + " is " + textOf(options.weight[i]) +
                ": it must be between 0, which leaves a vertex alone, and 1, the whole filter");
}

std::vector<bool> selectedOn(const Surface& surface, const std::vector<bool>& selected) {
    std::vector<bool> onSurface;
    for (const Index i : surface.vertex) onSurface.push_back(selected[i]);
    for (const auto& [vertex, row] : surface.copies)
        if (selected[vertex]) onSurface[row] = true;
    return onSurface;
}

Eigen::VectorXd selectionWeight(const Laplacian& laplacian, const Components& components,
                                const std::vector<bool>& selected, double width) {
    constexpr double kLengths = 3.0;  // decay lengths in a width
    const Interior unselected(components, selected);
    Eigen::VectorXd m(laplacian.D.size());
    for (Index i = 0; i < m.size(); ++i) m[i] = selected[i] ? 1.0 : 0.0;
    if (unselected.size() > 0) {
        const Laplacian around = unselected.restricted(laplacian);
        ShiftedLdlt ldlt;
        ldlt.factorizeDefinite(around.W, around.D, std::pow(kLengths / width, 2));
        m += unselected.extended(
            ldlt.solve(-unselected.restricted(Eigen::MatrixXd(laplacian.W * m))));
    }
    const double last = std::exp(-kLengths);
    return m.unaryExpr([last](double value) {
        const double t = std::clamp((value - last) / (1.0 - last), 0.0, 1.0);
        return t * t * (3.0 - 2.0 * t);
    });
}

Eigen::VectorXd vertexWeight(const WeightOptions& options, const Surface& surface,
                             const Interior& interior, const Laplacian& laplacian,
                             double featureSize) {
    Eigen::VectorXd weight = interior.extended(Eigen::VectorXd::Ones(interior.size()));
    if (contains(options.selected, false)) {
        weight.array() *= selectionWeight(laplacian, interior.surfaceComponents(),
                                          selectedOn(surface, options.selected), featureSize)
                              .array();
    }
    if (options.weight.size() > 0) weight.array() *= restricted(options.weight, surface).array();
    return weight;
}

}  // namespace spectral
