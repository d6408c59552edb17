#pragma once

#include <string>
#include <vector>

#include "core/contract/value.h"

namespace spectral {

/// Options of a filter for a purpose; of all others the defaults hold.
struct Preset {
    std::string name;     ///< In dialogs, commands and scripts: unique, must never change.
    std::string filter;   ///< The filter's pythonName.
    std::string purpose;  ///< Plain text.
    Values options;       ///< As users write them: choices by name, lengths as texts.
};

/// All presets.
const std::vector<Preset>& allPresets();

}  // namespace spectral
