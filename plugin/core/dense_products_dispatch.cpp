#include "dense_products.h"

namespace spectral {

extern const DenseProducts baselineProducts;
#ifdef SPECTRAL_AVX2
extern const DenseProducts avx2Products;
#endif

const DenseProducts& denseProducts() {
#ifdef SPECTRAL_AVX2
    static const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    if (avx2) return avx2Products;
#endif
    return baselineProducts;
}

}  // namespace spectral
