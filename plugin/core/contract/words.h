#pragma once

#include <string>

namespace spectral {

struct Filter;

/// In which words the users of a host read advice.
struct Words {
    enum class Names {
        Python,  ///< stop_gain = 1
        Labels,  ///< Stop gain = 1, as in dialogs
        Options  ///< --stop-gain 1, as in a shell
    };
    Names names = Names::Python;
    bool hasMeshLab = false;  ///< Whether MeshLab's own filters are at hand.
    /// What to do where a mesh is too large.
    std::string moreMemory = "give it a machine with more free memory";
};

/// Advice in the words of a host.
///
/// @param text  `|stop_gain|` stands for a parameter, `|stop_gain = 1|` for a value of it, and
///              `{apply 'Merge Close Vertices'|merge close vertices}` for what is to be done in
///              MeshLab, and elsewhere; `{memory}` is `moreMemory`.
std::string inWords(const std::string& text, const Filter& filter, const Words& words);

}  // namespace spectral
