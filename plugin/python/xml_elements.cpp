#include "xml_elements.h"

#include <algorithm>
#include <limits>

#include "text_numbers.h"

namespace spectral::python {

namespace {

using Position = std::string_view::size_type;

bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/// A start tag or the tag of an empty element.
struct Tag {
    Position begin, end;
    std::string_view name;  ///< With its prefix.
    std::array<std::string_view, 3> values;
    bool isEmpty;
};

class Scanner {
  public:
    Scanner(std::string_view text, std::string_view name,
            const std::array<std::string, 3>& attributes)
        : text_(text), name_(name), attributes_(attributes) {}

    /// Finds the next tag of the name from `at` on; false if there is none.
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
    std::string_view text_, name_;
    const std::array<std::string, 3>& attributes_;

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
    bool read(Position begin, Tag& tag) const {
        Position i = endOfName(begin + 1);
        const std::string_view name = text_.substr(begin + 1, i - begin - 1);
        if (name.size() < name_.size() || name.substr(name.size() - name_.size()) != name_ ||
            (name.size() > name_.size() && name[name.size() - name_.size() - 1] != ':'))
            return false;
        tag = {begin, 0, name, {}, false};
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
        for (std::size_t k = 0; k < attributes_.size(); ++k) {
            if (name != attributes_[k]) continue;
            if (tag.values[k].data() != nullptr) return false;
            tag.values[k] = value;
        }
        return true;
    }
};

double numberOf(std::string_view value) {
    double number = 0.0;
    const char* const end = value.data() + value.size();
    const bool isNumber = readNumber(value.data(), end, number) == end;
    return isNumber ? number : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

XmlElements takeElements(std::string_view text, std::string_view name,
                         const std::array<std::string, 3>& attributes) {
    const Scanner scanner(text, name, attributes);
    XmlElements elements;
    Tag tag{}, next{};
    Position copied = 0;
    bool isFound = scanner.find(0, tag);
    while (isFound) {
        const std::size_t begin = elements.values.size() / 3;
        elements.rest.append(text, copied, tag.begin - copied);
        while (true) {
            for (const std::string_view value : tag.values) {
                elements.values.push_back(numberOf(value));
                elements.places.push_back(value.data() == nullptr ? -1
                                                                  : value.data() - text.data());
            }
            isFound = scanner.find(tag.end, next);
            if (!isFound || !tag.isEmpty || next.name != tag.name ||
                scanner.skipBlanks(tag.end) != next.begin)
                break;
            tag = next;
        }
        const std::size_t end = elements.values.size() / 3;
        elements.rest.append("<").append(tag.name);
        elements.rest.append(" begin=\"").append(std::to_string(begin));
        elements.rest.append("\" end=\"").append(std::to_string(end));
        elements.rest.append(tag.isEmpty ? "\"/>" : "\">");
        copied = tag.end;
        tag = next;
    }
    elements.rest.append(text, copied);
    return elements;
}

}  // namespace spectral::python
