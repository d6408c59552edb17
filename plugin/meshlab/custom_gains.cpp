#include "meshlab/custom_gains.h"

#include <string>

#include "core/support/errors.h"
#include "core/support/frequency.h"
#include "core/transfer/custom_gain.h"
#include "core/transfer/transfer_function.h"

const char* meshlab_spectral_gains(const char* text, double featureSize, double diagonal,
                                   double meanEdge, const double* sizes, int count, double* gains) {
    thread_local std::string mistake;
    try {
        const spectral::CustomGain custom =
            spectral::parseGain(text, spectral::cutoffFrequency(featureSize), {diagonal, meanEdge});
        spectral::TransferFunctionOptions options;
        options.type = spectral::FilterType::Custom;
        options.custom = custom.gain;
        const spectral::TransferFunction F(options, custom.cutoff);
        for (int i = 0; i < count; ++i) gains[i] = F(spectral::cutoffFrequency(sizes[i]));
        return nullptr;
    } catch (const spectral::Error& error) {
        mistake = error.what();
        return mistake.c_str();
    }
}
