#pragma once

#include <Eigen/Core>
#include <vector>

#include "slice_iteration.h"
#include "types.h"

namespace spectral {

/// Vectors that are iterated together.
struct SliceOfVectors {
    Index first = 0, count = 0;  ///< Their columns.
    Slice slice;
};

/// Cuts vectors into slices so that iterating all of them costs least: those of a slice share one
/// factorization, but the wider it is the more iterations it takes.
///
/// @param quotient  about the vectors' eigenvalues, ascending.
/// @param bound, damping  of every slice.
/// @return the slices, the most expensive ones first: cores that share them then end at about the
///         same time.
std::vector<SliceOfVectors> layOutSlices(const Eigen::VectorXd& quotient, double bound,
                                         double damping);

}  // namespace spectral
