#include "core/kernels/kernels.h"

namespace spectral {

namespace baseline {
extern const Kernels kernels;
}

#ifdef SPECTRAL_AVX2
namespace avx2 {
extern const Kernels kernels;
}
#endif

#ifdef SPECTRAL_AVX512
namespace avx512 {
extern const Kernels kernels;
}
#endif

const std::vector<Kernels>& availableKernels() {
    static const std::vector<Kernels> available = [] {
        std::vector<Kernels> sets;
#ifdef SPECTRAL_AVX512
        if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq"))
            sets.push_back(avx512::kernels);
#endif
#ifdef SPECTRAL_AVX2
        if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
            sets.push_back(avx2::kernels);
#endif
        sets.push_back(baseline::kernels);
        return sets;
    }();
    return available;
}

const FrontElimination& frontElimination() {
    static const FrontElimination& widest = availableKernels().front().fronts;
    return widest;
}

const TriangularSolves& triangularSolves() {
    static const TriangularSolves& widest = availableKernels().front().triangular;
    return widest;
}

}  // namespace spectral
