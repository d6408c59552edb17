#include "core/contract/error_names.h"

namespace spectral {

const char* nameOf(ErrorCode code) {
    switch (code) {
        case ErrorCode::OptionOutOfRange: return "option_out_of_range";
        case ErrorCode::EmptyMesh: return "empty_mesh";
        case ErrorCode::NoFaces: return "no_faces";
        case ErrorCode::BadIndex: return "bad_index";
        case ErrorCode::NotFinite: return "not_finite";
        case ErrorCode::ValueNotFinite: return "value_not_finite";
        case ErrorCode::NoData: return "no_data";
        case ErrorCode::NoArea: return "no_area";
        case ErrorCode::DegenerateTriangles: return "degenerate_triangles";
        case ErrorCode::ShapeCollapsed: return "shape_collapsed";
        case ErrorCode::SingularMatrix: return "singular_matrix";
        case ErrorCode::ShrinksToNothing: return "shrinks_to_nothing";
        case ErrorCode::TooManyVertices: return "too_many_vertices";
        case ErrorCode::OutOfMemory: return "out_of_memory";
        case ErrorCode::BasisOutOfMemory: return "basis_out_of_memory";
        case ErrorCode::BasisTooLarge: return "basis_too_large";
        case ErrorCode::BasisTooSmall: return "basis_too_small";
        case ErrorCode::BasisIncomplete: return "basis_incomplete";
        case ErrorCode::TooManyHarmonics: return "too_many_harmonics";
        case ErrorCode::BoundaryFixesAll: return "boundary_fixes_all";
        case ErrorCode::TooSteep: return "too_steep";
        case ErrorCode::SolverFailed: return "solver_failed";
        case ErrorCode::Cancelled: break;
    }
    return "cancelled";
}

const char* classOf(const Error& error) {
    const ErrorCode code = error.code();
    if (code == ErrorCode::OutOfMemory || code == ErrorCode::BasisOutOfMemory)
        return "MemoryLimitError";
    if (dynamic_cast<const InvalidOption*>(&error) != nullptr) return "OptionError";
    if (dynamic_cast<const InvalidMesh*>(&error) != nullptr) return "MeshError";
    if (dynamic_cast<const Cancelled*>(&error) != nullptr) return "Cancelled";
    return "SolverError";
}

}  // namespace spectral
