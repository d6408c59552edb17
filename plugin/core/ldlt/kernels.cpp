#include "core/ldlt/kernels.h"

#if defined(SPECTRAL_AVX2) && defined(_WIN32)
#include <windows.h>
#endif

namespace spectral {

// Defined once for each instruction set (frontal_elimination.cpp, triangular_solves.cpp).
#define SPECTRAL_DECLARE_KERNELS(instructions)                                      \
    namespace instructions {                                                        \
    bool eliminateFront(const FrontalMatrix& front);                                \
    void forward(const LdltFactor&, double*, int, std::ptrdiff_t, std::ptrdiff_t);  \
    void backward(const LdltFactor&, double*, int, std::ptrdiff_t, std::ptrdiff_t); \
    constexpr Kernels kernels{eliminateFront, forward, backward};                   \
    }

SPECTRAL_DECLARE_KERNELS(baseline)
#ifdef SPECTRAL_AVX2
SPECTRAL_DECLARE_KERNELS(avx2)
#endif

namespace {

#ifdef SPECTRAL_AVX2
/// Whether the processor has AVX2 and FMA, and the system saves their registers.
bool hasAvx2() {
#ifdef _WIN32  // MSVC has no such builtin, and treats FMA as part of AVX2
    return IsProcessorFeaturePresent(PF_AVX2_INSTRUCTIONS_AVAILABLE) != 0;
#else
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#endif
}
#endif

}  // namespace

const std::vector<Kernels>& availableKernels() {
    static const std::vector<Kernels> available = [] {
        std::vector<Kernels> sets;
#ifdef SPECTRAL_AVX2
        if (hasAvx2()) sets.push_back(avx2::kernels);
#endif
        sets.push_back(baseline::kernels);
        return sets;
    }();
    return available;
}

}  // namespace spectral
