#include "meshlab/gains.h"

#include <string>

#include "core/support/errors.h"
#include "core/support/frequency.h"
#include "core/transfer/custom_gain.h"
#include "core/transfer/transfer_function.h"

const char* meshlab_spectral_gains(int type, int response, const double* shape, const char* text,
                                   const double* lengths, const double* frequencies, int count,
                                   double* gains) {
    thread_local std::string mistake;
    try {
        spectral::TransferFunctionOptions options;
        options.type = static_cast<spectral::FilterType>(type);
        options.response = static_cast<spectral::Response>(response);
        options.order = static_cast<int>(shape[0]);
        options.bandWidth = shape[1];
        options.passGain = shape[2];
        options.stopGain = shape[3];
        options.power = shape[4];
        const double unit = spectral::cutoffFrequency(lengths[0]);
        double cutoff = unit;
        if (options.type == spectral::FilterType::Custom) {
            const spectral::CustomGain custom =
                spectral::parseGain(text, cutoff, {lengths[1], lengths[2]});
            options.custom = custom.gain;
            cutoff = custom.cutoff;
        }
        const spectral::TransferFunction F(options, cutoff);
        for (int i = 0; i < count; ++i) gains[i] = F(frequencies[i] * unit);
        return nullptr;
    } catch (const spectral::Error& error) {
        mistake = error.what();
        return mistake.c_str();
    }
}
