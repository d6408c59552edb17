#pragma once

#include <QtGlobal>
#include <string>
#include <vector>

// What a filter says in words. pymeshlab passes no strings of a report on.

/// Keeps the words of the filter run of this thread that has ended or begun last: none for a run
/// that is at work or has failed.
void keepLastWords(const std::string& summary, const std::vector<std::string>& warnings);

// For Python, which finds these by name in the plugin's library. UTF-8, kept by the calling thread,
// valid until a filter of this plugin runs in it again.

/// The warnings, with a newline after each; empty without any.
extern "C" Q_DECL_EXPORT const char* meshlab_spectral_warnings();

/// What was found and done, in one line; empty if the numbers of the report say it all.
extern "C" Q_DECL_EXPORT const char* meshlab_spectral_summary();
