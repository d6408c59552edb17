#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace spectral::python {

/// How a text format divides its lines into words.
struct Syntax {
    bool hasComments = false;  ///< The rest of a line from # on is no word.
    bool isAnyCase = false;    ///< Keywords may be in capitals.
    int continued = 0;         ///< Lines of so many of the keywords go on after a final backslash.
};

/// The lines of a text that have words, in order.
struct Lines {
    std::vector<std::int64_t> starts;  ///< Byte offsets of their first words.
    std::vector<std::int32_t> words;   ///< How many words they have.
    std::vector<std::uint8_t> kinds;   ///< Their keywords' indices; keywords.size() for others.
};

/// Finds the first `limit` lines with words from offset `begin` on.
///
/// @param keywords  first words to be told apart; in small letters if case does not matter.
Lines findLines(std::string_view text, std::size_t begin, std::size_t limit,
                const std::vector<std::string>& keywords, const Syntax& syntax);

/// Some of the lines that `findLines` found.
struct ChosenLines {
    const std::int64_t* starts;
    const std::int32_t* words;
    std::size_t n;
};

/// A list in each of n lines, such as the corners of polygons.
struct NumberLists {
    std::vector<std::int64_t> sizes;  ///< n.
    std::vector<double> items;        ///< Of all lists, one after the other.
};

/// The numbers of n lines.
struct NumberTable {
    std::vector<double> single;      ///< n x k by rows: those that are in no list.
    std::vector<NumberLists> lists;  ///< For each list of the layout.
    std::int64_t bad = -1;           ///< The first line that is otherwise, or -1.
    std::size_t column = 0;          ///< Which of its numbers or lists; how many if more follows.
};

/// What a line holds.
struct Layout {
    int first;                   ///< The word at which the numbers begin.
    std::vector<bool> areLists;  ///< For each, whether it is the size of a list that follows.
    bool isWhole;                ///< Whether no other words may follow.
};

/// Reads numbers as Python's float does, but for underscores.
NumberTable readNumbers(std::string_view text, const ChosenLines& lines, const Layout& layout,
                        const Syntax& syntax);

/// A number of a binary row, or a list of them.
struct BinaryProperty {
    std::string sizeType;  ///< Of a list's size; empty if it is a number.
    std::string type;      ///< As in NumPy: i1, u1, i2, u2, i4, u4, f4, f8.
};

/// Reads `count` binary rows from byte `begin` on, which is moved to their end.
/// @return  with `bad`, the row in which the data end.
NumberTable readBinary(std::string_view data, std::size_t& begin, std::size_t count,
                       const std::vector<BinaryProperty>& properties, bool isBigEndian);

/// The corners of faces in OBJ files: words such as 7, 7/1, 7//3 and 7/1/3.
struct Corners {
    std::vector<std::int64_t>
        numbers;            ///< m x 2 by rows: vertex and normal; 0 where there is none.
    std::int64_t bad = -1;  ///< Byte offset of the first word that is none, or -1.
};
Corners readCorners(std::string_view text, const ChosenLines& lines);

/// New values of the numbers at n places, k one after the other at each.
struct Change {
    const std::int64_t* places;  ///< Ascending byte offsets.
    std::size_t n, k;
    int first;             ///< Words from a place to its first number.
    const double* before;  ///< n x k by rows: what the text has.
    const double* after;   ///< n x k by rows.
    int digits;            ///< Significant ones, as in %.*g.
};

/// Writes a text from byte `begin` on, with the numbers that have changed replaced.
///
/// A number ends at a blank or #; one after a quotation mark at the next of its kind.
/// @param changes  whose numbers may alternate, but not overlap.
/// @param write    called with one piece after the other.
void replaceNumbers(std::string_view text, std::size_t begin, const std::vector<Change>& changes,
                    const std::function<void(std::string_view)>& write);

/// Reads a word, from `begin` on, as Python's float does, but for underscores.
/// @return  its end; nullptr if it begins with no number.
const char* readNumber(const char* begin, const char* end, double& value);

}  // namespace spectral::python
