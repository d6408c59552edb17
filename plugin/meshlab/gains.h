#pragma once

#include <QtGlobal>

/// Gains of a transfer function, for Python, which finds the function by name in the plugin's
/// library: figures draw what the filter applies.
///
/// @param type         number of a spectral::FilterType.
/// @param response     number of a spectral::Response.
/// @param shape        order, band width, pass gain, stop gain and power, as in
///                     spectral::TransferFunctionOptions.
/// @param text         of a custom one, as the filter's parameter transfer_function.
/// @param lengths      feature size, diagonal and mean edge, length units, > 0; the last two are
///                     what sizes in the text refer to.
/// @param frequencies  `count` of them, relative to that of the feature size, >= 0.
/// @param gains        `count` results, >= 0.
/// @return  what is wrong with the text, as UTF-8, until the next call in this thread; null if
///          nothing is.
extern "C" Q_DECL_EXPORT const char* meshlab_spectral_gains(int type, int response,
                                                            const double* shape, const char* text,
                                                            const double* lengths,
                                                            const double* frequencies, int count,
                                                            double* gains);
