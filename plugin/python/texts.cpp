#include "texts.h"

#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.h"
#include "running.h"
#include "shapes.h"
#include "text_numbers.h"
#include "xml_elements.h"

namespace spectral::python {

namespace {

using namespace nb::literals;
using Places = nb::ndarray<const std::int64_t, nb::numpy, nb::shape<-1>, nb::c_contig>;
using Counts = nb::ndarray<const std::int32_t, nb::numpy, nb::shape<-1>, nb::c_contig>;

std::string_view viewOf(const nb::bytes& text) { return {text.c_str(), text.size()}; }

/// Runs something without the GIL.
template <class Run>
auto released(const Run& run) {
    const Running running;
    return run();
}

nb::tuple lines(const nb::bytes& text, std::size_t begin, std::size_t limit,
                const std::vector<std::string>& keywords, bool hasComments, bool isAnyCase,
                int continued) {
    const std::string_view view = viewOf(text);
    Lines found = released([&] {
        return findLines(view, begin, limit, keywords, {hasComments, isAnyCase, continued});
    });
    return nb::make_tuple(givenRows(std::move(found.starts)), givenRows(std::move(found.words)),
                          givenRows(std::move(found.kinds)));
}

/// The numbers, the lists, the bad row and its column.
nb::tuple tupleOf(NumberTable&& table, std::size_t properties) {
    nb::list lists;
    for (NumberLists& one : table.lists)
        lists.append(
            nb::make_tuple(givenRows(std::move(one.sizes)), givenRows(std::move(one.items))));
    const std::size_t columns = properties - table.lists.size();
    return nb::make_tuple(givenRows(std::move(table.single), columns), lists, table.bad,
                          table.column);
}

nb::tuple numbers(const nb::bytes& text, const Places& starts, const Counts& words, int first,
                  const std::vector<bool>& areLists, bool hasComments, int continued,
                  bool isWhole) {
    const std::string_view view = viewOf(text);
    NumberTable found = released([&] {
        return readNumbers(view, {starts.data(), words.data(), starts.shape(0)},
                           {first, areLists, isWhole}, {hasComments, false, continued});
    });
    return tupleOf(std::move(found), areLists.size());
}

nb::tuple binaryNumbers(const nb::bytes& data, std::size_t begin, std::size_t count,
                        const std::vector<std::tuple<std::string, std::string>>& types,
                        bool isBigEndian) {
    const std::string_view view = viewOf(data);
    std::vector<BinaryProperty> properties;
    for (const auto& [sizeType, type] : types) properties.push_back({sizeType, type});
    if (begin > view.size()) throw nb::value_error("rows begin within the data");
    NumberTable found =
        released([&] { return readBinary(view, begin, count, properties, isBigEndian); });
    return nb::make_tuple(tupleOf(std::move(found), properties.size()), begin);
}

nb::tuple corners(const nb::bytes& text, const Places& starts, const Counts& words) {
    const std::string_view view = viewOf(text);
    Corners found =
        released([&] { return readCorners(view, {starts.data(), words.data(), starts.shape(0)}); });
    return nb::make_tuple(givenRows(std::move(found.numbers), 2), found.bad);
}

using Replacement = std::tuple<Places, int, Table, Table, int>;

void writePatched(const nb::bytes& text, std::size_t begin,
                  const std::vector<Replacement>& replacements, const nb::callable& write) {
    const std::string_view view = viewOf(text);
    std::vector<Change> changes;
    for (const auto& [places, first, before, after, digits] : replacements) {
        const std::size_t n = places.shape(0), k = before.shape(1);
        if (before.shape(0) != n || after.shape(0) != n || after.shape(1) != k)
            throw nb::value_error("a change needs a place and two rows of numbers each");
        const auto isWithin = [&](std::int64_t place) {
            return place >= 0 && static_cast<std::size_t>(place) < view.size();
        };
        if (!std::all_of(places.data(), places.data() + n, isWithin))
            throw nb::value_error("a number is not within the text");
        changes.push_back({places.data(), n, k, first, before.data(), after.data(), digits});
    }
    if (begin > view.size()) throw nb::value_error("a text is written from within it");
    const Running running;
    replaceNumbers(view, begin, changes, [&write](std::string_view piece) {
        const nb::gil_scoped_acquire gil;
        const auto size = static_cast<Py_ssize_t>(piece.size());
        constexpr int kReadable = 0x100;  // PyBUF_READ, not declared in 3.10's stable ABI
        write(nb::steal(PyMemoryView_FromMemory(const_cast<char*>(piece.data()), size, kReadable)));
    });
}

nb::tuple elements(const nb::bytes& text,
                   const std::vector<std::tuple<std::string, std::array<std::string, 3>>>& names) {
    const std::string_view view = viewOf(text);
    std::vector<XmlKind> kinds;
    for (const auto& [name, attributes] : names) kinds.push_back({name, attributes});
    SplitXml split = released([&] { return takeElements(view, kinds); });
    nb::list taken;
    for (XmlElements& one : split.elements)
        taken.append(nb::make_tuple(givenRows(std::move(one.values), 3),
                                    givenRows(std::move(one.places), 3)));
    return nb::make_tuple(taken, nb::bytes(split.text.data(), split.text.size()));
}

using IndexTable = nb::ndarray<const std::int64_t, nb::numpy, nb::shape<-1, 3>, nb::c_contig>;

template <class Array>
auto rowsOf(const Array& array) {
    using Scalar = std::remove_const_t<typename Array::Scalar>;
    return Rows<Scalar>(array.data(), static_cast<Eigen::Index>(array.shape(0)),
                        static_cast<Eigen::Index>(array.shape(1)));
}

nb::object firstRows(const Table& rows) {
    std::vector<std::int64_t> first = released([&] { return firstEqualRows(rowsOf(rows)); });
    return givenRows(std::move(first));
}

nb::object normals(const Positions& before, const Positions& after, const IndexTable& faces,
                   const Positions& given, const IndexTable& which) {
    Table3 result = released([&] {
        return followingNormals(rowsOf(before), rowsOf(after), rowsOf(faces), rowsOf(given),
                                rowsOf(which));
    });
    return givenByRows(result);
}

nb::object faceNormals(const Positions& before, const Positions& after, const IndexTable& faces,
                       const Positions& given, const Places& owners) {
    Table3 result = released([&] {
        return followingFaceNormals(rowsOf(before), rowsOf(after), rowsOf(faces), rowsOf(given),
                                    owners.data());
    });
    return givenByRows(result);
}

}  // namespace

void addTexts(nb::module_& m) {
    m.def("text_lines", lines, "text"_a, "begin"_a, "limit"_a, "keywords"_a, "comments"_a,
          "any_case"_a, "continued"_a);
    m.def("text_numbers", numbers, "text"_a, "starts"_a, "words"_a, "first"_a, "are_lists"_a,
          "comments"_a, "continued"_a, "is_whole"_a);
    m.def("binary_numbers", binaryNumbers, "data"_a, "begin"_a, "count"_a, "types"_a,
          "big_endian"_a);
    m.def("text_corners", corners, "text"_a, "starts"_a, "words"_a);
    m.def("write_patched", writePatched, "text"_a, "begin"_a, "changes"_a, "write"_a);
    m.def("first_equal_rows", firstRows, "rows"_a);
    m.def("following_normals", normals, "before"_a, "after"_a, "faces"_a, "normals"_a, "which"_a);
    m.def("following_face_normals", faceNormals, "before"_a, "after"_a, "faces"_a, "normals"_a,
          "owners"_a);
    m.def("xml_elements", elements, "text"_a, "kinds"_a);
}

}  // namespace spectral::python
