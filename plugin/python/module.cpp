// meshlab_spectral._core: the core on NumPy arrays. The package checks and converts what users
// pass.

#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.h"
#include "core/contract/filter.h"
#include "core/contract/gains.h"
#include "core/laplacian/laplacian.h"
#include "core/laplacian/laplacian_builder.h"
#include "core/mesh/contacts.h"
#include "core/mesh/measures.h"
#include "core/mesh/surface.h"
#include "core/support/memory.h"
#include "core/support/steady_progress.h"
#include "core/support/threads.h"
#include "core/transfer/expression.h"
#include "errors.h"
#include "running.h"
#include "texts.h"
#include "values.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace spectral::python {

namespace {

/// The core reads a row for each vertex.
/// @throws nb::value_error  unless there are so many.
template <class Array>
void requireRows(const Array& array, const Positions& vertices) {
    if (array.shape(0) != vertices.shape(0)) throw nb::value_error("one row for each vertex");
}

/// Members of TiledSurface: diagonal, mean edge and diagonal of the surface, and so on.
using TiledTuple = std::tuple<double, double, double, bool, Flags>;

nb::dict applyFilter(const std::string& name, const Positions& vertices, const Indices& faces,
                     const nb::dict& options, const std::optional<Flags>& selected,
                     const std::optional<Table>& values, const std::optional<Pairs>& gain,
                     const std::optional<TiledTuple>& whole, nb::handle progress, int threads,
                     const std::string& moreMemory, bool isShell) {
    FilterInput input{viewOfRows(vertices.data(), static_cast<Eigen::Index>(vertices.shape(0))),
                      viewOfRows(faces.data(), static_cast<Eigen::Index>(faces.shape(0)))};
    if (selected) {
        requireRows(*selected, vertices);
        input.selected.assign(selected->data(), selected->data() + selected->shape(0));
    }
    if (values) {
        requireRows(*values, vertices);
        input.values = mapOf(*values, static_cast<Eigen::Index>(values->shape(1)));
    }
    if (gain) input.gain = mapOf(*gain, 2);
    if (whole) {
        const auto& [diagonal, meanEdge, surfaceDiagonal, hasThinParts, inner] = *whole;
        requireRows(inner, vertices);
        const std::vector<bool> flags(inner.data(), inner.data() + inner.shape(0));
        input.whole = {{diagonal, meanEdge, surfaceDiagonal}, hasThinParts, flags};
    }
    if (!moreMemory.empty()) input.words.moreMemory = moreMemory;
    if (isShell) input.words.names = Words::Names::Options;
    const Values given = valuesOf(options);
    FilterOutput output = [&] {
        const Running running;
        return apply(filterNamed(name), input, given, progressOf(progress), threads);
    }();
    nb::dict result;
    if (output.V.rows() > 0) result["vertices"] = givenByRows(output.V);
    if (output.details.rows() > 0) result["details"] = givenByRows(output.details);
    if (output.values.rows() > 0) result["values"] = givenByRows(output.values);
    if (output.basis.rows() > 0) result["basis"] = python::given(std::move(output.basis));
    result["report"] = dictOf(std::move(output.report));
    result["text"] = output.text;
    result["summary"] = output.summary;
    result["warnings"] = listOf(output.warnings);
    if (output.columns.empty()) return result;
    nb::list columns;
    for (FilterOutput& column : output.columns)
        columns.append(nb::make_tuple(dictOf(std::move(column.report)), listOf(column.warnings)));
    result["columns"] = columns;
    return result;
}

nb::object gains(const nb::dict& options, double featureSize, double diagonal, double meanEdge,
                 const Numbers& frequencies) {
    const auto w = mapOf(frequencies, 1);
    return python::given(
        gainsAt(valuesOf(options), featureSize, {diagonal, meanEdge, diagonal}, w.col(0)));
}

/// (data, column indices, row offsets) of W, D, and the vertex of each row.
nb::tuple laplacian(const Positions& vertices, const Indices& faces, int kind, nb::handle progress,
                    int threads) {
    if (kind < 0 || kind > static_cast<int>(LaplacianKind::Uniform))
        throw nb::value_error("no such kind of Laplacian");
    const Vertices V = mapOf(vertices, 3);
    const Faces F = mapOf(faces, 3);
    MeshLaplacian mesh = [&] {
        const Running running;
        return withSteadyProgress(progressOf(progress), [&](const Progress& steady) {
            const ThreadTeam team(threads, steady);
            return meshLaplacian(V, F, static_cast<LaplacianKind>(kind));
        });
    }();
    SparseMatrix& W = mesh.laplacian.W;
    W.makeCompressed();
    using Integers = Eigen::VectorXi;
    using Doubles = Eigen::VectorXd;
    const std::vector<Index>& rows = mesh.surface.vertex;
    return nb::make_tuple(
        python::given(Doubles(Doubles::Map(W.valuePtr(), W.nonZeros()))),
        python::given(Integers(Integers::Map(W.innerIndexPtr(), W.nonZeros()))),
        python::given(Integers(Integers::Map(W.outerIndexPtr(), W.outerSize() + 1))),
        python::given(std::move(mesh.laplacian.D)),
        python::given(
            Eigen::Matrix<Index, Eigen::Dynamic, 1>(Eigen::Matrix<Index, Eigen::Dynamic, 1>::Map(
                rows.data(), static_cast<Index>(rows.size())))));
}

/// For each vertex the first one it is joined to at a seam, often itself.
nb::object joinedVertices(const Positions& vertices, const Indices& faces) {
    const Vertices V = mapOf(vertices, 3);
    const Faces F = mapOf(faces, 3);
    std::vector<std::int64_t> first(static_cast<std::size_t>(V.rows()));
    {
        const Running running;
        std::iota(first.begin(), first.end(), 0);
        const Surface surface = joinedSurface(V, F);
        for (const auto& [vertex, row] : surface.copies) first[vertex] = surface.vertex[row];
    }
    return givenRows(std::move(first));
}

/// For each vertex its connected component, from 0; -1: no face uses it.
nb::object components(const Positions& vertices, const Indices& faces) {
    const Vertices V = mapOf(vertices, 3);
    const Faces F = mapOf(faces, 3);
    std::vector<int> labels(static_cast<std::size_t>(V.rows()), -1);
    {
        const Running running;
        const Surface surface = joinedSurface(V, F);
        const Components found = connectedComponents(surface.F, surface.X.rows());
        for (Index row = 0; row < surface.X.rows(); ++row)
            labels[surface.vertex[row]] = found.label[row];
        for (const auto& [vertex, row] : surface.copies) labels[vertex] = found.label[row];
    }
    return givenRows(std::move(labels));
}

/// Displacements of vertices, those where different components touch alike (contacts.h).
nb::object movedAlike(const Positions& vertices, const Indices& faces,
                      const Positions& displacement) {
    requireRows(displacement, vertices);
    const Vertices V = mapOf(vertices, 3);
    const Faces F = mapOf(faces, 3);
    Vertices moved = mapOf(displacement, 3);
    {
        const Running running;
        const Surface surface = joinedSurface(V, F);
        Vertices rows = moved(surface.vertex, Eigen::indexing::all);
        moveContactsAlike(surface, connectedComponents(surface.F, surface.X.rows()), rows);
        // A copy may belong to a mesh that stays.
        const Vertices before = moved;
        const auto follow = [&](Index vertex, Index row) {
            if (before.row(vertex) == before.row(surface.vertex[row]))
                moved.row(vertex) = rows.row(row);
        };
        for (Index row = 0; row < rows.rows(); ++row) follow(surface.vertex[row], row);
        for (const auto& [vertex, row] : surface.copies) follow(vertex, row);
    }
    return python::given(std::move(moved));
}

/// The values of an expression where its variables have those in each row of a table.
nb::object evaluated(const std::string& option, const std::string& text,
                     const std::string& examples, const std::vector<std::string>& variables,
                     const Table& values) {
    if (variables.empty() || values.shape(1) != variables.size())
        throw nb::value_error("one column for each variable");
    Expression expression({option, text, examples}, variables);
    std::vector<double> result(values.shape(0)), row(variables.size());
    for (std::size_t i = 0; i < result.size(); ++i) {
        std::copy_n(values.data() + i * row.size(), row.size(), row.begin());
        result[i] = expression(row);
    }
    return givenRows(std::move(result));
}

/// Diagonal, mean edge and diagonal of the surface: what sizes refer to.
nb::tuple lengths(const Positions& vertices, const Indices& faces) {
    const MeshLengths found = [&] {
        const Running running;
        return lengthsOf(mapOf(vertices, 3), mapOf(faces, 3));
    }();
    return nb::make_tuple(found.diagonal, found.meanEdge, found.surfaceDiagonal);
}

/// A third of the areas of the triangles at each vertex.
nb::object vertexAreas(const Positions& vertices, const Indices& faces) {
    Eigen::VectorXd areas;
    {
        const Running running;
        areas = lumpedMass(mapOf(vertices, 3), mapOf(faces, 3));
    }
    return python::given(std::move(areas));
}

}  // namespace

}  // namespace spectral::python

NB_MODULE(_core, m) {
    using namespace spectral;
    python::translateErrors();
    python::endRunsAtExit();
    m.def("filters", python::describedFilters);
    m.def("presets", python::describedPresets);
    m.def("length", python::parsedLength, "text"_a);
    m.def("checked", python::checkedOptions, "name"_a, "options"_a);
    m.def("sizes", python::sizesOf, "name"_a, "options"_a, "diagonal"_a, "mean_edge"_a,
          "surface_diagonal"_a);
    m.def("warning_kinds", python::describedWarnings);
    m.def("apply", python::applyFilter, "name"_a, "vertices"_a, "faces"_a, "options"_a,
          nb::kw_only(), "selected"_a = nb::none(), "values"_a = nb::none(), "gain"_a = nb::none(),
          "whole"_a = nb::none(), "progress"_a = nb::none(), "threads"_a = 0, "more_memory"_a = "",
          "is_shell"_a = false);
    m.def("gains", python::gains, "options"_a, "feature_size"_a, "diagonal"_a, "mean_edge"_a,
          "frequencies"_a);
    m.def("laplacian", python::laplacian, "vertices"_a, "faces"_a, "kind"_a, nb::kw_only(),
          "progress"_a = nb::none(), "threads"_a = 0);
    m.def("joined_vertices", python::joinedVertices, "vertices"_a, "faces"_a);
    m.def("components", python::components, "vertices"_a, "faces"_a);
    m.def("moved_alike", python::movedAlike, "vertices"_a, "faces"_a, "displacement"_a);
    m.def("evaluated", python::evaluated, "option"_a, "text"_a, "examples"_a, "variables"_a,
          "values"_a);
    m.def("lengths", python::lengths, "vertices"_a, "faces"_a);
    m.def("vertex_areas", python::vertexAreas, "vertices"_a, "faces"_a);
    python::addTexts(m);
    m.def("set_memory_limit", setMemoryLimit, "limit"_a);
    m.def("available_memory", availableMemory);
}
