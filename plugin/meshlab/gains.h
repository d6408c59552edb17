#pragma once

#include <QtGlobal>

/// Evaluates a transfer function, for Python, which looks this function up by name in the plugin's
/// library: figures then draw exactly what the filter applies.
///
/// @param type         number of a spectral::FilterType.
/// @param response     number of a spectral::Response.
/// @param shape        order, band width, pass gain, stop gain and power, as in
///                     spectral::TransferFunctionOptions.
/// @param text         custom transfer function, as in the filter's parameter transfer_function.
/// @param lengths      feature size, diagonal and mean edge, length units, > 0; sizes in the text
///                     refer to the last two.
/// @param frequencies  `count` frequencies relative to that of the feature size, >= 0.
/// @param gains        `count` results, >= 0.
/// @return  null, or what is wrong with the text: UTF-8, until the next call in this thread.
extern "C" Q_DECL_EXPORT const char* meshlab_spectral_gains(int type, int response,
                                                            const double* shape, const char* text,
                                                            const double* lengths,
                                                            const double* frequencies, int count,
                                                            double* gains);
