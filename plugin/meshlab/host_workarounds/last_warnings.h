#pragma once

#include <QtGlobal>
#include <string>
#include <vector>

/// Keeps the warnings of the filter run of this thread that has ended or begun last: none for a run
/// that is at work or has failed.
void keepLastWarnings(const std::vector<std::string>& warnings);

/// The warnings kept by the calling thread, as UTF-8 with a newline after each; empty without any.
/// Valid until a filter of this plugin runs in that thread again.
///
/// For Python, which finds it by name in the plugin's library: pymeshlab passes no strings of a
/// report on.
extern "C" Q_DECL_EXPORT const char* meshlab_spectral_warnings();
