#pragma once

#include <QtGlobal>

/// Gains of a custom transfer function, for Python, which finds the function by name in the
/// plugin's library: figures draw what the filter applies.
///
/// @param text         as the filter's parameter transfer_function.
/// @param featureSize  length units, > 0; `diagonal` and `meanEdge` likewise, for sizes in % and e.
/// @param sizes        `count` feature sizes, length units, > 0.
/// @param gains        `count` results, >= 0.
/// @return  what is wrong with the text, as UTF-8, until the next call in this thread; null if
///          nothing is.
extern "C" Q_DECL_EXPORT const char* meshlab_spectral_gains(const char* text, double featureSize,
                                                            double diagonal, double meanEdge,
                                                            const double* sizes, int count,
                                                            double* gains);
