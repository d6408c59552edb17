#include "meshlab/host_workarounds/given_output.h"

#include <utility>

namespace {

thread_local std::optional<spectral::FilterOutput> givenOutput;

Eigen::MatrixXd copyOf(const double* rows, int n, int columns) {
    if (rows == nullptr) return {};
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    return Eigen::Map<const RowMajor>(rows, n, columns);
}

}  // namespace

void meshlab_spectral_give(int n, const double* V, const double* details, const double* values,
                           const char* text) {
    givenOutput.reset();
    if (n == 0) return;
    givenOutput.emplace();
    givenOutput->V = copyOf(V, n, 3);
    givenOutput->details = copyOf(details, n, 3);
    givenOutput->values = copyOf(values, n, 1);
    givenOutput->text = text;
}

std::optional<spectral::FilterOutput> takeGivenOutput() { return std::exchange(givenOutput, {}); }
