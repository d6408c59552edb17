#include "core/transfer/expression.h"

#include <muParserDLL.h>

#include <algorithm>
#include <cctype>

#include "core/support/errors.h"

// muParser's C interface, as the C++ one differs between versions.
namespace spectral {

namespace {

bool isComparison(const std::string& text, std::size_t at) {
    return text[at] == '<' || text[at] == '>' ||
           (text[at + 1] == '=' && (text[at] == '=' || text[at] == '!'));
}

/// Rejects what muParser accepts but does not read as mathematics: assignments, comparisons that
/// seem to chain, and several results, of which it takes the last.
void rejectMisreadings(const GivenText& given, const std::string& variable) {
    const std::string& text = given.text;
    struct Group {
        bool isCall;      ///< Its commas separate the arguments of a function.
        bool isCompared;  ///< Its current operand of &&, ||, ? or : contains a comparison.
    };
    std::vector<Group> groups{{false, false}};
    char previous = ' ';  // the last character that is not blank
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        Group& group = groups.back();
        if (c == '(') {
            const bool followsName = std::isalnum(static_cast<unsigned char>(previous)) != 0;
            groups.push_back({followsName || previous == '_', false});
        } else if (c == ')') {
            if (groups.size() > 1) groups.pop_back();  // muParser reports one too many
        } else if (c == ',') {
            if (!group.isCall)
                given.reject(i, "a comma; write decimals with a point, 0.5, and one expression");
            group.isCompared = false;
        } else if (c == '&' || c == '|' || c == '?' || c == ':') {
            group.isCompared = false;
        } else if (isComparison(text, i)) {
            if (group.isCompared)
                given.reject(i, "a second comparison; join two by &&, as in 0.5 < " + variable +
                                    " && " + variable + " < 1.5");
            group.isCompared = true;
            if (text[i + 1] == '=') ++i;
        } else if (c == '=') {
            given.reject(i, "= assigns; compare with ==");
        }
        if (text[i] != ' ') previous = text[i];
    }
}

}  // namespace

void GivenText::reject(std::size_t position, const std::string& why) const {
    const std::size_t place = std::min(position, text.size()) + 1;
    throw InvalidOption(option + " = " + text + ": at character " + std::to_string(place) + ", " +
                        why + "; " + examples);
}

void Expression::Release::operator()(void* parser) const { mupRelease(parser); }

Expression::Expression(const GivenText& given, const std::vector<std::string>& variables)
    : values_(variables.size(), 1.0), parser_(mupCreate(muBASETYPE_FLOAT)) {
    rejectMisreadings(given, variables.front());
    for (std::size_t i = 0; i < variables.size(); ++i)
        mupDefineVar(parser_.get(), variables[i].c_str(), &values_[i]);
    mupSetExpr(parser_.get(), given.text.c_str());
    mupEval(parser_.get());
    if (mupError(parser_.get()) == 0) return;
    const int position = std::max(0, mupGetErrorPos(parser_.get()));
    std::string message = mupGetErrorMsg(parser_.get());
    while (!message.empty() && (message.back() == '.' || message.back() == ' ')) message.pop_back();
    given.reject(static_cast<std::size_t>(position), message);
}

double Expression::operator()(const std::vector<double>& values) {
    std::copy(values.begin(), values.end(), values_.begin());
    return mupEval(parser_.get());
}

}  // namespace spectral
