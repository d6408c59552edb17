#pragma once

#include <functional>
#include <initializer_list>
#include <vector>

#include "core/contract/filter.h"
#include "core/contract/value.h"

namespace spectral {

/// An entry of a report, and where it is in a result.
template <class Result>
struct Entry : ReportEntry {
    std::function<Value(const Result&)> get;
    bool (*isThere)(const Result&) = nullptr;  ///< Null: always.

    /// @param from  a member of Result, or a function of one.
    template <class From>
    Entry(const char* entry, const char* what, From from, bool (*when)(const Result&) = nullptr)
        : ReportEntry{entry, what, when == nullptr},
          get([from](const Result& result) -> Value { return std::invoke(from, result); }),
          isThere(when) {}
};

template <class Result>
using Entries = std::vector<Entry<Result>>;

template <class Result>
Entries<Result> joined(std::initializer_list<Entries<Result>> parts) {
    Entries<Result> all;
    for (const Entries<Result>& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
}

template <class Result>
Values reportOf(const Entries<Result>& entries, const Result& result) {
    Values report;
    for (const Entry<Result>& one : entries)
        if (one.isThere == nullptr || one.isThere(result)) report[one.name] = one.get(result);
    return report;
}

template <class Result>
std::vector<ReportEntry> describedBy(const Entries<Result>& entries) {
    return {entries.begin(), entries.end()};
}

}  // namespace spectral
