#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace spectral::python {

/// A kind of elements that a document may hold millions of.
struct XmlKind {
    std::string name;  ///< Without a prefix.
    std::array<std::string, 3> attributes;
};

/// All elements of a kind.
struct XmlElements {
    std::vector<double> values;  ///< n x 3 by rows: the attributes; NaN for other texts.
    std::vector<std::int64_t>
        places;  ///< n x 3 by rows: their byte offsets; -1 where there is none.
};

/// An XML document without the elements of some kinds.
struct SplitXml {
    std::vector<XmlElements> elements;  ///< For each kind.
    std::string text;
};

/// Takes elements, with any prefix, out of a document.
///
/// In their place is one element of the same name for each run of empty elements, with the
/// attributes `begin` and `end`: which of the n rows it stands for. Comments, character data and
/// what is not well-formed are left to the parser of the remaining text, as are unusual characters
/// in attributes.
SplitXml takeElements(std::string_view text, const std::vector<XmlKind>& kinds);

}  // namespace spectral::python
