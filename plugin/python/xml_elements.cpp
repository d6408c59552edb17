#include "xml_elements.h"

#include <algorithm>
#include <limits>

#include "text_numbers.h"

namespace spectral::python {

namespace {

using Position = std::string_view::size_type;

bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

bool isPlainInName(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}
bool isPlainInValue(char c) { return isBlank(c) || (c >= ' ' && c <= '~' && c != '&'); }

/// A start tag or the tag of an empty element.
struct Tag {
    Position begin, end;
    std::string_view name;  ///< With its prefix.
    std::size_t kind;
    std::array<std::string_view, 3> values;
    bool isEmpty;
    bool isPlain;  ///< Has no characters that the parser of the rest must judge.
};

class Scanner {
  public:
    Scanner(std::string_view text, const std::vector<XmlKind>& kinds)
        : text_(text), kinds_(kinds) {}

    /// Finds the next tag of one of the kinds from `at` on; false if there is none.
    bool find(Position at, Tag& tag) const {
        while ((at = text_.find('<', at)) != std::string_view::npos) {
            if (const Position end = endOfOther(at); end > at) {
                at = end;
            } else if (read(at, tag)) {
                return true;
            } else {
                ++at;
            }
        }
        return false;
    }
    Position skipBlanks(Position at) const {
        while (at < text_.size() && isBlank(text_[at])) ++at;
        return at;
    }

  private:
    std::string_view text_;
    const std::vector<XmlKind>& kinds_;

    char at(Position i) const { return i < text_.size() ? text_[i] : '\0'; }

    /// The end of a comment, of character data or an instruction at `begin`; `begin` if it is none.
    Position endOfOther(Position begin) const {
        constexpr std::array<std::array<std::string_view, 2>, 3> others{
            {{"<!--", "-->"}, {"<![CDATA[", "]]>"}, {"<?", "?>"}}};
        for (const auto& [open, close] : others)
            if (text_.compare(begin, open.size(), open) == 0)
                return std::min(text_.find(close, begin + open.size()), text_.size());
        return begin;
    }
    Position endOfName(Position i) const {
        while (i < text_.size() && !isBlank(text_[i]) && text_[i] != '>' && text_[i] != '/' &&
               text_[i] != '=' && text_[i] != '<')
            ++i;
        return i;
    }
    std::size_t kindOf(std::string_view name) const {
        const Position colon = name.find(':');
        if (colon != std::string_view::npos) name.remove_prefix(colon + 1);
        std::size_t kind = 0;
        while (kind < kinds_.size() && kinds_[kind].name != name) ++kind;
        return kind;
    }
    bool read(Position begin, Tag& tag) const {
        Position i = endOfName(begin + 1);
        const std::string_view name = text_.substr(begin + 1, i - begin - 1);
        tag = {begin, 0, name, kindOf(name), {}, false, true};
        if (tag.kind == kinds_.size()) return false;
        for (Position next = skipBlanks(i); next > i && at(next) != '/' && at(next) != '>';
             next = skipBlanks(i))
            if (!readAttribute(i = next, tag)) return false;
        i = skipBlanks(i);
        tag.isEmpty = at(i) == '/';
        tag.end = i + (tag.isEmpty ? 2 : 1);
        return at(tag.end - 1) == '>';
    }
    bool readAttribute(Position& i, Tag& tag) const {
        const Position begin = i;
        i = endOfName(i);
        const std::string_view name = text_.substr(begin, i - begin);
        i = skipBlanks(i);
        if (at(i) != '=') return false;
        i = skipBlanks(i + 1);
        const char quote = at(i);
        if (quote != '"' && quote != '\'') return false;
        const Position end = text_.find(quote, i + 1);
        if (end == std::string_view::npos) return false;
        const std::string_view value = text_.substr(i + 1, end - i - 1);
        i = end + 1;
        if (value.find('<') != std::string_view::npos) return false;
        tag.isPlain = tag.isPlain && std::all_of(name.begin(), name.end(), isPlainInName) &&
                      std::all_of(value.begin(), value.end(), isPlainInValue);
        const std::array<std::string, 3>& attributes = kinds_[tag.kind].attributes;
        for (std::size_t k = 0; k < attributes.size(); ++k) {
            if (name != attributes[k]) continue;
            if (tag.values[k].data() != nullptr) return false;
            tag.values[k] = value;
        }
        return true;
    }
};

double numberOf(std::string_view value) {
    double number = 0.0;
    const char* const end = value.data() + value.size();
    const bool isNumber = !value.empty() && readNumber(value.data(), end, number) == end;
    return isNumber ? number : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

SplitXml takeElements(std::string_view text, const std::vector<XmlKind>& kinds) {
    constexpr std::size_t shortest = 32;  // bytes of an element with three attributes, about
    const Scanner scanner(text, kinds);
    SplitXml split;
    split.elements.resize(kinds.size());
    for (XmlElements& elements : split.elements) {
        elements.values.reserve(3 * (text.size() / shortest));  // costs nothing until it is used
        elements.places.reserve(3 * (text.size() / shortest));
    }
    Tag tag{}, next{};
    Position copied = 0;
    bool isFound = scanner.find(0, tag);
    while (isFound) {
        XmlElements& elements = split.elements[tag.kind];
        const std::size_t begin = elements.values.size() / 3;
        split.text.append(text, copied, tag.begin - copied);
        while (true) {
            for (const std::string_view value : tag.values) {
                elements.values.push_back(numberOf(value));
                elements.places.push_back(value.data() == nullptr ? -1
                                                                  : value.data() - text.data());
            }
            isFound = scanner.find(tag.end, next);
            if (!isFound || !tag.isEmpty || !tag.isPlain || !next.isPlain ||
                next.name != tag.name || scanner.skipBlanks(tag.end) != next.begin)
                break;
            tag = next;
        }
        split.text.append("<").append(tag.name);
        split.text.append(" begin=\"").append(std::to_string(begin));
        split.text.append("\" end=\"").append(std::to_string(elements.values.size() / 3));
        split.text.append("\"");
        copied = tag.begin + 1 + tag.name.size();
        if (tag.isPlain) {
            split.text.append(tag.isEmpty ? "/>" : ">");
            copied = tag.end;
        }
        tag = next;
    }
    split.text.append(text, copied);
    return split;
}

}  // namespace spectral::python
