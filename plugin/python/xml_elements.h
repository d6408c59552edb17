#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace spectral::python {

/// All elements of one name in an XML document, and the document without them.
struct XmlElements {
    std::vector<double> values;  ///< n x 3 by rows: the attributes; NaN for other texts.
    std::vector<std::int64_t>
        places;        ///< n x 3 by rows: their byte offsets; -1 where there is none.
    std::string rest;  ///< The document with one element for each run of them.
};

/// Takes the elements of a name, with any prefix, out of a document that may hold millions.
///
/// In their place is one element of the same name for each run of empty elements, with the
/// attributes `begin` and `end`: which of the n rows it stands for. What is not well-formed stays
/// for the parser of the rest; comments and character data stay, too.
XmlElements takeElements(std::string_view text, std::string_view name,
                         const std::array<std::string, 3>& attributes);

}  // namespace spectral::python
