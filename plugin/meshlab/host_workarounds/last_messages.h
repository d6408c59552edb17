#pragma once

#include <QtGlobal>
#include <string>

#include "core/contract/warning.h"
#include "core/support/errors.h"

// The messages of a filter, as pymeshlab drops the strings of a report.

/// Keeps the messages of the latest filter run in this thread: none while it runs or if it failed.
void keepLastMessages(const std::string& summary, const spectral::Warnings& warnings);

/// Keeps the error of that run; pymeshlab has one class for all.
void keepLastError(const spectral::Error& error);

// For Python, which looks these up by name in the plugin's library. UTF-8, one copy per thread,
// valid until a filter of this plugin runs in the calling thread again.

/// The warnings, each after its code and a blank, and before a newline; empty if there are none.
extern "C" Q_DECL_EXPORT const char* meshlab_spectral_warnings();

/// What was found and done, in one line; empty if the numbers of the report say it all.
extern "C" Q_DECL_EXPORT const char* meshlab_spectral_summary();

/// Class, code and limit of the error, separated by blanks; empty after a run without one, and when
/// it has been read: pymeshlab refuses some runs before they reach the plugin.
extern "C" Q_DECL_EXPORT const char* meshlab_spectral_error();
