#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace spectral {

/// A text that a user has given for an option.
struct GivenText {
    std::string option;    ///< Name of the option.
    std::string text;      ///< What was given.
    std::string examples;  ///< What may be given, for errors.

    /// @param position  index of the character, from 0.
    /// @throws InvalidOption
    [[noreturn]] void reject(std::size_t position, const std::string& why) const;
};

/// An expression of some variables in the language of muParser: `1/(1 + w^4)`, `z > 3 && x < 1`.
/// Not thread-safe.
class Expression {
  public:
    /// @throws InvalidOption  when the text is wrong; the message says at which character.
    Expression(const GivenText& given, const std::vector<std::string>& variables);

    /// @param values  one for each variable.
    double operator()(const std::vector<double>& values);

  private:
    struct Release {
        void operator()(void* parser) const;
    };
    std::vector<double> values_;
    std::unique_ptr<void, Release> parser_;
};

}  // namespace spectral
