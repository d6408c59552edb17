#include "core/contract/words.h"

#include <algorithm>

#include "core/contract/filter.h"

namespace spectral {

namespace {

/// A parameter, or one with a value: "stop_gain", "stop_gain = 1".
std::string setting(const std::string& text, const Filter& filter, Words::Names names) {
    if (names == Words::Names::Python) return text;
    constexpr const char* kIs = " = ";
    const std::size_t is = text.find(kIs);
    std::string name = text.substr(0, is);
    std::string value = is == std::string::npos ? "" : text.substr(is + 3);
    if (names == Words::Names::Labels) {
        for (const Parameter& one : filter.parameters)
            if (one.name == name) name = one.label;
        return value.empty() ? name : name + kIs + value;
    }
    std::replace(name.begin(), name.end(), '_', '-');
    if (value.find(' ') != std::string::npos) value = "'" + value + "'";
    return "--" + name + (value.empty() ? "" : " " + value);
}

}  // namespace

std::string inWords(const std::string& text, const Filter& filter, const Words& words) {
    std::string result;
    for (std::size_t at = 0; at < text.size();) {
        const bool isChoice = text[at] == '{';
        const std::size_t end = isChoice || text[at] == '|'
                                    ? text.find(isChoice ? '}' : '|', at + 1)
                                    : std::string::npos;
        if (end == std::string::npos) {
            result += text[at++];
            continue;
        }
        const std::string inner = text.substr(at + 1, end - at - 1);
        const std::size_t other = inner.find('|');
        if (inner == "memory")
            result += words.moreMemory;
        else if (!isChoice)
            result += setting(inner, filter, words.names);
        else
            result += words.hasMeshLab ? inner.substr(0, other) : inner.substr(other + 1);
        at = end + 1;
    }
    return result;
}

}  // namespace spectral
