#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/contract/parameter.h"
#include "core/contract/value.h"
#include "core/contract/warning.h"
#include "core/contract/words.h"
#include "core/mesh/measures.h"
#include "core/mesh/mesh.h"
#include "core/support/errors.h"
#include "core/support/progress.h"

namespace spectral {

/// The surface that a mesh is a tile of: what sizes and defaults refer to.
struct TiledSurface {
    MeshLengths lengths;
    bool hasThinParts = false;  ///< Whether some tile has thin parts (their reports tell).
    std::vector<bool> inner;    ///< n: vertices that are not near where the tile was cut out.
};

/// A mesh, as a host hands it to a filter; the host keeps V and F.
struct FilterInput {
    VerticesView V;                ///< n x 3 positions.
    FacesView F;                   ///< m x 3 vertex indices.
    std::vector<bool> selected{};  ///< n, selected vertices and corners of selected faces, for the
                                   ///< parameter `selected`.
    Eigen::MatrixXd values{};  ///< n x c: the vertex quality (c >= 1), or red, green and blue from
                               ///< 0 to 255 (c = 3); no rows: the mesh has none.
    Eigen::MatrixXd gain{};    ///< p x 2, in place of a transfer function: frequencies
                               ///< w = feature size / wavelength > 0, and a gain >= 0 for each.
    Words words{};             ///< Of the host.
    std::optional<TiledSurface> whole{};  ///< If the mesh is a tile; only for filters of shapes
                                          ///< with fixed sizes (fractional.cpp).
};

/// The result of a filter, for a host to write to its mesh.
struct FilterOutput {
    Vertices V{};              ///< n x 3 filtered positions; no rows: no vertex moves.
    Vertices details{};        ///< n x 3, input minus result, if these are wanted instead.
    Eigen::MatrixXd values{};  ///< n x c new values, like those of the input; no rows: unchanged.
    Eigen::MatrixXd basis{};   ///< n x k harmonics; no rows unless the filter computes some.
    Values report{};
    std::string text{};     ///< The report as lines for a log.
    std::string summary{};  ///< What was found and done, one line; empty if the numbers say it all.
    Warnings warnings{};    ///< Shortcomings that are not errors.
    std::vector<FilterOutput> columns{};  ///< Of several values: report and warnings of each.
};

/// One entry of a filter's report.
struct ReportEntry {
    std::string name;
    std::string meaning;   ///< With its unit.
    bool isAlways = true;  ///< Whether every report has it.
};

/// A filter: all that a host needs to offer it.
struct Filter {
    std::string name;        ///< In menus: unique, must never change.
    std::string pythonName;  ///< In pymeshlab: unique, must never change.
    std::string help;        ///< For the dialog; plain text, *words* stand out.
    std::string source{};    ///< The publication of the method, [its title](its address).
    std::vector<Parameter> parameters;
    std::vector<ReportEntry> report;  ///< Entries that there may be, in no order.

    /// @param mesh  measured already: what sizes in `given` refer to.
    FilterOutput (*run)(const FilterInput& input, const MeshLengths& mesh, const Values& given,
                        const Progress& progress) = nullptr;

    /// A parameter that only chooses from what a run has computed; empty: none.
    std::string choice{};
    /// Makes the output of a run into that of one with another choice; null without.
    void (*choose)(FilterOutput& output, const Values& given) = nullptr;

    /// A draft of the result, while a user moves sliders, with what it keeps for the next one;
    /// null: there is none that is faster than the result.
    FilterOutput (*preview)(const FilterInput& input, const MeshLengths& mesh, const Values& given,
                            std::shared_ptr<void>& kept, const Progress& progress) = nullptr;
    /// The parameter of type bool that makes a run as accurate as the filter can; empty: every run
    /// is.
    std::string accurate{};
};

/// All filters; their positions never change.
const std::vector<Filter>& allFilters();

/// @throws std::out_of_range  when there is no such filter.
const Filter& filterNamed(const std::string& pythonName);

/// Applies a filter. The calling thread reports progress twenty times a second, others compute.
///
/// @param given    values of parameters; the others have their defaults.
/// @param threads  number of threads; 0: threadCount().
/// @throws Error  with what to do about it.
FilterOutput apply(const Filter& filter, const FilterInput& input, const Values& given,
                   const Progress& progress = {}, int threads = 0);

/// The same for a preview; that of a filter without one is its result.
///
/// @param kept  what the last preview of this filter has left; empty at first.
FilterOutput preview(const Filter& filter, const FilterInput& input, const Values& given,
                     std::shared_ptr<void>& kept, const Progress& progress = {});

}  // namespace spectral
