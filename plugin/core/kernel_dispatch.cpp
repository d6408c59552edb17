#include "dense_products.h"
#include "sparse_products.h"
#include "triangular_solves.h"

namespace spectral {

namespace baseline {
extern const DenseProducts denseProducts;
extern const SparseProducts sparseProducts;
extern const TriangularSolves triangularSolves;
}  // namespace baseline

#ifdef SPECTRAL_AVX2
namespace avx2 {
extern const DenseProducts denseProducts;
extern const SparseProducts sparseProducts;
extern const TriangularSolves triangularSolves;
}  // namespace avx2

namespace {

bool hasAvx2() {
    static const bool has = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    return has;
}

}  // namespace
#endif

const DenseProducts& denseProducts() {
#ifdef SPECTRAL_AVX2
    if (hasAvx2()) return avx2::denseProducts;
#endif
    return baseline::denseProducts;
}

const SparseProducts& sparseProducts() {
#ifdef SPECTRAL_AVX2
    if (hasAvx2()) return avx2::sparseProducts;
#endif
    return baseline::sparseProducts;
}

const TriangularSolves& triangularSolves() {
#ifdef SPECTRAL_AVX2
    if (hasAvx2()) return avx2::triangularSolves;
#endif
    return baseline::triangularSolves;
}

}  // namespace spectral
