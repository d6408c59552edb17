#include "text_numbers.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <limits>
#include <stdexcept>

namespace spectral::python {

namespace {

constexpr std::size_t pieceSize = 1 << 18;  // bytes; calls into Python must not count

bool isEnd(char c) { return c == '\n' || c == '\r'; }
bool isBlank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

/// A position in a text.
struct Cursor {
    const char* at;
    const char* end;
    bool hasComments;
    bool isContinued = false;  // whether lines go on after a final backslash

    bool isWithin() const { return at != end; }
    bool isAtWord() const {
        return isWithin() && !isBlank(*at) && !(hasComments && *at == '#') && !isAtBackslash();
    }
    /// Whether here is a backslash that ends a line which goes on.
    bool isAtBackslash() const {
        if (!isContinued || !isWithin() || *at != '\\') return false;
        const char* next = at + 1;
        while (next != end && isBlank(*next) && !isEnd(*next)) ++next;
        return next == end || isEnd(*next) || (hasComments && *next == '#');
    }
    void skipWord() {
        while (isAtWord()) ++at;
    }
    void skipBlanks() {
        while (isWithin() && isBlank(*at)) ++at;
    }
    void skipBlanksOfLine() {
        while (isWithin() && isBlank(*at) && !isEnd(*at)) ++at;
    }
    void skipLine() {
        while (isWithin() && !isEnd(*at)) ++at;
    }
    /// To the next word, of this line or another.
    void findWord() {
        for (skipBlanks(); isWithin() && !isAtWord(); skipBlanks()) skipLine();
    }
    /// To the beginning of the next line.
    void skipEnd() {
        skipLine();
        if (end - at > 1 && at[0] == '\r' && at[1] == '\n') ++at;
        if (isWithin()) ++at;
    }
};

std::size_t kindOf(std::string_view word, const std::vector<std::string>& keywords, bool anyCase) {
    const auto same = [anyCase](char given, char keyword) {
        return given == keyword ||
               (anyCase && given >= 'A' && given <= 'Z' && given + 32 == keyword);
    };
    std::size_t kind = 0;
    while (kind < keywords.size() && !std::equal(word.begin(), word.end(), keywords[kind].begin(),
                                                 keywords[kind].end(), same))
        ++kind;
    return kind;
}

/// Goes to the end of a line, and counts its words.
std::int32_t countWords(Cursor& line) {
    std::int32_t words = 0;
    while (line.isAtWord()) {
        line.skipWord();
        ++words;
        line.skipBlanksOfLine();
        while (line.isAtBackslash()) {
            line.skipEnd();
            line.skipBlanksOfLine();
        }
    }
    return words;
}

/// Infinity or zero, for what no double can hold.
double beyondRange(const char* at, const char* end) {
    const double sign = *at == '-' ? -1.0 : 1.0;
    bool isAfterPoint = false, hasDigits = false;
    long order = 0;  // of the first digit but 0
    for (; at != end && *at != 'e' && *at != 'E'; ++at) {
        isAfterPoint |= *at == '.';
        hasDigits |= *at >= '1' && *at <= '9';
        if (*at < '0' || *at > '9' || hasDigits == isAfterPoint) continue;
        order += hasDigits ? 1 : isAfterPoint ? -1 : 0;
    }
    int exponent = 0;
    if (at != end) {
        at += end - at > 1 && at[1] == '+' ? 2 : 1;
        const std::from_chars_result result = std::from_chars(at, end, exponent);
        if (result.ec != std::errc{}) exponent = *at == '-' ? -1'000'000'000 : 1'000'000'000;
    }
    return sign * (order + exponent > 0 ? std::numeric_limits<double>::infinity() : 0.0);
}

/// Reads a number that is a word; false if it is none.
bool readWord(Cursor& word, double& value) {
    const char* const end = readNumber(word.at, word.end, value);
    if (end == nullptr) return false;
    word.at = end;
    return !word.isAtWord();
}

/// Whether `value` is the size of a list in a line with so many words left.
bool isSize(double value, std::int64_t left) {
    return value >= 0.0 && value <= static_cast<double>(left) &&
           value == static_cast<double>(static_cast<std::int64_t>(value));
}

bool readLine(Cursor line, std::int64_t left, const Layout& layout, NumberTable& numbers) {
    double value = 0.0;
    const auto next = [&] {
        if (--left < 0) return false;
        line.findWord();
        return readWord(line, value);
    };
    std::size_t list = 0;
    for (numbers.column = 0; numbers.column < layout.areLists.size(); ++numbers.column) {
        if (!next()) return false;
        if (!layout.areLists[numbers.column]) {
            numbers.single.push_back(value);
            continue;
        }
        if (!isSize(value, left)) return false;
        const auto size = static_cast<std::int64_t>(value);
        NumberLists& lists = numbers.lists[list++];
        lists.sizes.push_back(size);
        for (std::int64_t k = 0; k < size; ++k) {
            if (!next()) return false;
            lists.items.push_back(value);
        }
    }
    return left == 0 || !layout.isWhole;
}

bool readInteger(const char*& at, const char* end, std::int64_t& value) {
    if (end - at > 1 && at[0] == '+' && at[1] != '-') ++at;
    const std::from_chars_result result = std::from_chars(at, end, value);
    at = result.ptr;
    return result.ec == std::errc{};
}

/// Vertex and normal of a corner; false if the word is none.
bool readCorner(std::string_view word, std::int64_t& vertex, std::int64_t& normal) {
    const char* at = word.data();
    const char* const end = at + word.size();
    normal = 0;
    if (!readInteger(at, end, vertex) || (at != end && *at != '/')) return false;
    const char* const texture = std::find(at, end, '/');
    if (texture == end) return true;
    at = std::find(texture + 1, end, '/');
    if (at == end || ++at == end || *at == '/') return true;
    return readInteger(at, end, normal) && (at == end || *at == '/');
}

template <class Scalar>
double scalarAt(const char* at, bool isReversed) {
    std::array<char, sizeof(Scalar)> bytes;
    std::copy_n(at, bytes.size(), bytes.begin());
    if (isReversed) std::reverse(bytes.begin(), bytes.end());
    Scalar scalar;
    std::memcpy(&scalar, bytes.data(), bytes.size());
    return static_cast<double>(scalar);
}

struct Decoder {
    std::size_t size;
    double (*read)(const char* at, bool isReversed);
};

Decoder decoderOf(const std::string& type) {
    if (type == "i1") return {1, scalarAt<std::int8_t>};
    if (type == "u1") return {1, scalarAt<std::uint8_t>};
    if (type == "i2") return {2, scalarAt<std::int16_t>};
    if (type == "u2") return {2, scalarAt<std::uint16_t>};
    if (type == "i4") return {4, scalarAt<std::int32_t>};
    if (type == "u4") return {4, scalarAt<std::uint32_t>};
    if (type == "f4") return {4, scalarAt<float>};
    if (type == "f8") return {8, scalarAt<double>};
    throw std::invalid_argument("unknown type " + type);
}

bool isHostBigEndian() {
    const std::uint16_t one = 1;
    char first = 0;
    std::memcpy(&first, &one, 1);
    return first == 0;
}

/// The numbers of a change, one after the other.
struct Replacing {
    const Change* change;
    std::size_t row = 0, column = 0;
    Cursor cursor{};
    bool isQuoted = false;

    void enterRow(std::string_view text) {
        const auto changed = [this](std::size_t i) {
            const double* const before = change->before + i * change->k;
            return !std::equal(before, before + change->k, change->after + i * change->k);
        };
        while (row < change->n && !changed(row)) ++row;
        if (row == change->n) return;
        const char* const begin = text.data();
        cursor = {begin + change->places[row], begin + text.size(), true, true};
        isQuoted = change->places[row] > 0 && (cursor.at[-1] == '"' || cursor.at[-1] == '\'');
        for (int word = 0; word < change->first; ++word) {
            cursor.skipWord();
            cursor.findWord();
        }
    }
    void next(std::string_view text) {
        if (++column < change->k) {
            cursor.findWord();
        } else {
            ++row, column = 0;
            enterRow(text);
        }
    }
    bool isDone() const { return row == change->n; }
    /// Appends what is between `copied` and this number, and the number if it is new.
    void append(std::string& piece, const char*& copied) {
        const double value = change->after[row * change->k + column];
        const char* const begin = cursor.at;
        if (isQuoted)
            cursor.at = std::find(cursor.at, cursor.end, cursor.at[-1]);
        else
            cursor.skipWord();
        if (value == change->before[row * change->k + column] || begin < copied) return;
        std::array<char, 64> digits;
        const std::to_chars_result end =
            std::to_chars(digits.data(), digits.data() + digits.size(), value,
                          std::chars_format::general, change->digits);
        piece.append(copied, begin).append(digits.data(), end.ptr);
        copied = cursor.at;
    }
};

}  // namespace

const char* readNumber(const char* begin, const char* end, double& value) {
    if (end - begin > 1 && *begin == '+' && begin[1] != '-') ++begin;
    const std::from_chars_result result = std::from_chars(begin, end, value);
    if (result.ec == std::errc::invalid_argument || result.ptr[-1] == ')') return nullptr;
    if (result.ec == std::errc::result_out_of_range) value = beyondRange(begin, result.ptr);
    return result.ptr;
}

Lines findLines(std::string_view text, std::size_t begin, std::size_t limit,
                const std::vector<std::string>& keywords, const Syntax& syntax) {
    Lines lines;
    Cursor cursor{text.data() + std::min(begin, text.size()), text.data() + text.size(),
                  syntax.hasComments};
    while (lines.starts.size() < limit) {
        cursor.findWord();
        if (!cursor.isWithin()) break;
        Cursor word = cursor;
        word.skipWord();
        const auto size = static_cast<std::size_t>(word.at - cursor.at);
        const std::size_t kind = kindOf({cursor.at, size}, keywords, syntax.isAnyCase);
        lines.starts.push_back(cursor.at - text.data());
        lines.kinds.push_back(static_cast<std::uint8_t>(kind));
        cursor.isContinued = static_cast<int>(kind) < syntax.continued;
        lines.words.push_back(countWords(cursor));
        cursor.isContinued = false;
        cursor.skipLine();
    }
    return lines;
}

NumberTable readNumbers(std::string_view text, const ChosenLines& lines, const Layout& layout,
                        const Syntax& syntax) {
    const std::vector<bool>& areLists = layout.areLists;
    NumberTable numbers;
    numbers.lists.resize(
        static_cast<std::size_t>(std::count(areLists.begin(), areLists.end(), true)));
    numbers.single.reserve(lines.n * (areLists.size() - numbers.lists.size()));
    for (NumberLists& list : numbers.lists) {
        list.sizes.reserve(lines.n);
        list.items.reserve(3 * lines.n);
    }
    for (std::size_t i = 0; i < lines.n; ++i) {
        Cursor line{text.data() + lines.starts[i], text.data() + text.size(), syntax.hasComments,
                    syntax.continued > 0};
        for (int word = 0; word < std::min(layout.first, lines.words[i]); ++word) {
            line.skipWord();
            line.findWord();
        }
        if (!readLine(line, lines.words[i] - layout.first, layout, numbers)) {
            numbers.bad = static_cast<std::int64_t>(i);
            break;
        }
    }
    return numbers;
}

NumberTable readBinary(std::string_view data, std::size_t& begin, std::size_t count,
                       const std::vector<BinaryProperty>& properties, bool isBigEndian) {
    struct Column {
        bool isList;
        Decoder size, number;
    };
    std::vector<Column> columns;
    NumberTable table;
    for (const auto& [sizeType, type] : properties) {
        const bool isList = !sizeType.empty();
        columns.push_back({isList, decoderOf(isList ? sizeType : type), decoderOf(type)});
        if (isList) table.lists.emplace_back();
    }
    const bool isReversed = isBigEndian != isHostBigEndian();
    std::size_t left = data.size() - begin;
    const auto append = [&](const Decoder& decoder, std::size_t n, std::vector<double>& numbers) {
        if (n > left / decoder.size) return false;
        for (std::size_t k = 0; k < n; ++k, begin += decoder.size)
            numbers.push_back(decoder.read(data.data() + begin, isReversed));
        left -= n * decoder.size;
        return true;
    };
    const auto readRow = [&] {
        std::vector<double> size;
        std::size_t list = 0;
        for (const auto& [isList, sizeDecoder, decoder] : columns) {
            if (!isList) {
                if (!append(decoder, 1, table.single)) return false;
                continue;
            }
            size.clear();
            NumberLists& lists = table.lists[list++];
            if (!append(sizeDecoder, 1, size) || !isSize(size[0], std::int64_t(left))) return false;
            lists.sizes.push_back(static_cast<std::int64_t>(size[0]));
            if (!append(decoder, static_cast<std::size_t>(size[0]), lists.items)) return false;
        }
        return true;
    };
    for (std::size_t i = 0; i < count && table.bad < 0; ++i)
        if (!readRow()) table.bad = static_cast<std::int64_t>(i);
    return table;
}

Corners readCorners(std::string_view text, const ChosenLines& lines) {
    Corners corners;
    corners.numbers.reserve(6 * lines.n);
    for (std::size_t i = 0; i < lines.n; ++i) {
        Cursor cursor{text.data() + lines.starts[i], text.data() + text.size(), true, true};
        cursor.skipWord();
        for (std::int32_t left = lines.words[i] - 1; left > 0; --left) {
            cursor.findWord();
            if (!cursor.isWithin()) break;
            const char* const begin = cursor.at;
            cursor.skipWord();
            const std::string_view word(begin, static_cast<std::size_t>(cursor.at - begin));
            std::int64_t vertex = 0, normal = 0;
            if (!readCorner(word, vertex, normal)) {
                corners.bad = begin - text.data();
                return corners;
            }
            corners.numbers.push_back(vertex);
            corners.numbers.push_back(normal);
        }
    }
    return corners;
}

void replaceNumbers(std::string_view text, std::size_t begin, const std::vector<Change>& changes,
                    const std::function<void(std::string_view)>& write) {
    std::vector<Replacing> waiting;  // a heap
    const auto isLater = [](const Replacing& a, const Replacing& b) {
        return a.cursor.at > b.cursor.at;
    };
    const auto push = [&](const Replacing& one) {
        if (one.isDone()) return;
        waiting.push_back(one);
        std::push_heap(waiting.begin(), waiting.end(), isLater);
    };
    for (const Change& change : changes) {
        Replacing one{&change};
        one.enterRow(text);
        push(one);
    }
    std::string piece;
    const char* copied = text.data() + begin;
    while (!waiting.empty()) {
        std::pop_heap(waiting.begin(), waiting.end(), isLater);
        Replacing one = waiting.back();
        waiting.pop_back();
        do {
            one.append(piece, copied);
            one.next(text);
        } while (!one.isDone() && (waiting.empty() || !isLater(one, waiting.front())) &&
                 piece.size() < pieceSize);
        push(one);
        if (piece.size() < pieceSize) continue;
        write(piece);
        piece.clear();
    }
    write(piece);
    write(text.substr(static_cast<std::size_t>(copied - text.data())));
}

}  // namespace spectral::python
