#include "core/contract/filter.h"

#include <algorithm>
#include <stdexcept>

#include "core/contract/advice.h"
#include "core/contract/filters.h"
#include "core/contract/surface_report.h"
#include "core/mesh/mesh_check.h"
#include "core/support/steady_progress.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

/// Throws an error of the same class again, with advice.
/// @param mesh  what percentages refer to, if it has been measured: filters that are too strong
///              often come from there.
[[noreturn]] void throwAdvised(const Error& error, const Filter& filter, const Values& given,
                               const MeshLengths& mesh, const Words& words) {
    const std::string help = inWords(advice(error, filter, given), filter, words);
    std::string text = help.empty() ? error.what() : error.what() + (": " + help);
    if (dynamic_cast<const SolverFailure*>(&error) != nullptr)
        for (const Warning& warning : percentageWarnings(mesh))
            text += ". " + inWords(warning.text, filter, words);
    if (dynamic_cast<const Cancelled*>(&error) != nullptr) throw Cancelled();
    if (dynamic_cast<const InvalidMesh*>(&error) != nullptr)
        throw InvalidMesh(error.code(), text, error.limit());
    if (dynamic_cast<const InvalidOption*>(&error) != nullptr)
        throw InvalidOption(error.code(), text, error.limit());
    if (dynamic_cast<const SolverFailure*>(&error) != nullptr)
        throw SolverFailure(error.code(), text, error.limit());
    throw Error(error.code(), text, error.limit());
}

/// Other filters of MeshLab leave selections behind unnoticed; other hosts pass on what was chosen.
void warnOfSelection(const FilterInput& input, const Values& given, FilterOutput& output) {
    const auto selected = given.find("selected");
    if (!input.words.hasMeshLab || selected == given.end() || selected->second != Value(true))
        return;
    const std::string note = selectionText(input.selected);
    if (!note.empty() && output.text.find(note) == std::string::npos)
        output.warnings.insert(output.warnings.begin(), {WarningCode::Selection, note});
}

/// Calls `work(lengths of the mesh, progress)` in a team of threads.
template <class Work>
FilterOutput advised(const Filter& filter, const FilterInput& input, const Values& given,
                     const Progress& progress, int threads, const Work& work) {
    MeshLengths lengths;
    try {
        FilterOutput output = withSteadyProgress(progress, [&](const Progress& steady) {
            const ThreadTeam team(threads > 0 ? threads : threadCount(), steady);
            checkMesh(input.V, input.F);  // before it is measured
            lengths = input.whole ? input.whole->lengths : lengthsOf(input.V, input.F);
            return work(lengths, steady);
        });
        warnOfSelection(input, given, output);
        const auto translate = [&](FilterOutput& part) {
            for (Warning& warning : part.warnings)
                warning.text = inWords(warning.text, filter, input.words);
        };
        translate(output);
        for (FilterOutput& column : output.columns) translate(column);
        return output;
    } catch (const Error& error) {
        throwAdvised(error, filter, given, lengths, input.words);
    }
}

}  // namespace

const std::vector<Filter>& allFilters() {
    static const std::vector<Filter> filters{fractionalFilterContract(),
                                             denoiseContract(),
                                             equalizerContract(),
                                             qualityContract(),
                                             colorContract(),
                                             artefactsContract(),
                                             harmonicsContract(),
                                             geometrySpectrumContract(),
                                             surfaceTextureContract()};
    return filters;
}

const Filter& filterNamed(const std::string& pythonName) {
    const std::vector<Filter>& all = allFilters();
    const auto found = std::find_if(all.begin(), all.end(), [&](const Filter& filter) {
        return filter.pythonName == pythonName;
    });
    if (found == all.end()) throw std::out_of_range("there is no filter " + pythonName);
    return *found;
}

FilterOutput apply(const Filter& filter, const FilterInput& input, const Values& given,
                   const Progress& progress, int threads) {
    return advised(filter, input, given, progress, threads,
                   [&](const MeshLengths& mesh, const Progress& steady) {
                       return filter.run(input, mesh, given, steady);
                   });
}

FilterOutput preview(const Filter& filter, const FilterInput& input, const Values& given,
                     std::shared_ptr<void>& kept, const Progress& progress) {
    if (filter.preview == nullptr) return apply(filter, input, given, progress);
    return advised(filter, input, given, progress, 0,
                   [&](const MeshLengths& mesh, const Progress& steady) {
                       return filter.preview(input, mesh, given, kept, steady);
                   });
}

}  // namespace spectral
