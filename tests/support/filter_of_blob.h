#pragma once

#include "core/filter/step_evaluator.h"
#include "core/laplacian/interior.h"
#include "core/laplacian/laplacian_builder.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/transfer/transfer_function.h"

namespace spectral::testing {

/// Everything that the steps of a filter of `blob` need.
struct FilterOfBlob {
    Surface surface;
    Interior interior;
    TransferFunction F;
    EvaluationOptions evaluation;         ///< With accuracy 1e-9.
    mutable LaplacianBuilder laplacians;  ///< Keeps `surface` by reference.

    /// @param featureSize  length units; the blob's own size is about 2.
    FilterOfBlob(const TransferFunctionOptions& options, double featureSize, BasisUpdate update);
    FilterOfBlob(const FilterOfBlob&) = delete;
    FilterOfBlob& operator=(const FilterOfBlob&) = delete;
};

/// A band-pass that doubles one octave and keeps all others.
TransferFunctionOptions boost();

}  // namespace spectral::testing
