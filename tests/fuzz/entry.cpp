// The entry point of fuzzing engines such as libFuzzer, which stop at the first failure.

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "fuzz/contract.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace spectral::fuzz;
    Choices choices(data, size);
    const Case made = makeCase(choices);
    const Verdict verdict = check(made);
    for (const Failure& failure : verdict.failures)
        std::fprintf(stderr, "%s: %s; %s\n", failure.kind.c_str(), failure.text.c_str(),
                     describe(made).c_str());
    if (!verdict.failures.empty()) std::abort();
    return 0;
}
