#include "core/laplacian/vertex_weight.h"

#include <algorithm>
#include <string>

#include "core/laplacian/selection_weight.h"
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
            "false, which filters the whole mesh");
    for (Index i = 0; i < options.weight.size(); ++i)
        if (!(options.weight[i] >= 0.0 && options.weight[i] <= 1.0))
            throw InvalidOption(
                "the weight of vertex " + std::to_string(i) + " is " + textOf(options.weight[i]) +
                ": it must be between 0, which leaves a vertex alone, and 1, the whole filter");
}

Eigen::VectorXd vertexWeight(const WeightOptions& options, const Surface& surface,
                             const Interior& interior, const Laplacian& laplacian,
                             double featureSize) {
    Eigen::VectorXd weight = interior.extended(Eigen::VectorXd::Ones(interior.size()));
    if (contains(options.selected, false)) {
        std::vector<bool> onSurface;
        for (const Index i : surface.vertex) onSurface.push_back(options.selected[i]);
        for (const auto& [vertex, row] : surface.copies)
            if (options.selected[vertex]) onSurface[row] = true;
        weight.array() *=
            selectionWeight(laplacian, interior.surfaceComponents(), onSurface, featureSize)
                .array();
    }
    if (options.weight.size() > 0) weight.array() *= restricted(options.weight, surface).array();
    return weight;
}

}  // namespace spectral
