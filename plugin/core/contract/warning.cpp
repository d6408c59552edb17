#include "core/contract/warning.h"

#include <iterator>

namespace spectral {

WarningKind kindOf(WarningCode code) {
    using W = WarningCode;
    switch (code) {
        case W::Selection: return {"selection", "only the selection was filtered"};
        case W::AllFixed: return {"all_fixed", "no vertex can change: all are fixed"};
        case W::NothingRemoved:
            return {"nothing_removed", "there is no noise, or it could not be removed"};
        case W::HighNoise: return {"high_noise", "the noise hides details"};
        case W::NearlyJoined: return {"nearly_joined", "vertices nearly coincide at a seam"};
        case W::FlatComponents: return {"flat_components", "components without area"};
        case W::PeriodicCell: return {"periodic_cell", "opposite sides do not match any more"};
        case W::FarVertices: return {"far_vertices", "vertices without faces enlarge percentages"};
        case W::MissingData: return {"missing_data", "one coordinate may stand for missing data"};
        case W::PartedComponents:
            return {"parted_components", "components that touched came apart"};
        case W::BelowEdges: return {"below_edges", "the feature size is below the mean edge"};
        case W::ThinParts: return {"thin_parts", "parts shrink to lines or points"};
        case W::WholeScaled: return {"whole_scaled", "the gain scales the whole object"};
        case W::FoldedFaces: return {"folded_faces", "faces have folded over"};
        case W::VolumeNotKept: return {"volume_not_kept", "components whose volume is not kept"};
        case W::Accuracy: return {"accuracy", "the accuracy was not reached"};
        case W::Tolerance: return {"tolerance", "the tolerance was not reached"};
        case W::FewHarmonics: return {"few_harmonics", "the harmonics end above the feature size"};
        case W::HarmonicResiduals: return {"harmonic_residuals", "harmonics are inaccurate"};
        case W::MixedSizes: return {"mixed_sizes", "energy may belong to other sizes"};
        case W::ConstantValues: return {"constant_values", "the values are constant"};
        case W::ThinnerThanCutoff:
            return {"thinner_than_cutoff", "parts too thin for the waviness cutoff"};
        case W::LittleMeasured: return {"little_measured", "less than half is measured"};
        case W::SteepTexture: return {"steep_texture", "slopes are too steep for a free shape"};
        case W::OtherHeights: return {"other_heights", "what is left out has other heights"};
        case W::FlatTexture: return {"flat_texture", "part of the area has no texture"};
        case W::UnusedOption: break;
    }
    return {"unused_option", "an option has no effect with the others"};
}

std::vector<WarningKind> allWarnings() {
    std::vector<WarningKind> all;
    for (int code = 0; code <= static_cast<int>(WarningCode::UnusedOption); ++code)
        all.push_back(kindOf(static_cast<WarningCode>(code)));
    return all;
}

void append(Warnings more, Warnings& warnings) {
    warnings.insert(warnings.end(), std::make_move_iterator(more.begin()),
                    std::make_move_iterator(more.end()));
}

}  // namespace spectral
