#pragma once

#include <cstddef>
#include <sstream>
#include <stdexcept>
#include <string>

namespace spectral {

/// The cause of an error, for a host that suggests a remedy in its own terms.
enum class ErrorCode {
    OptionOutOfRange,     ///< The text names the option and its range.
    EmptyMesh,            ///< No vertices.
    NoFaces,              ///< No triangles: a point cloud.
    BadIndex,             ///< A triangle refers to a vertex that does not exist.
    NotFinite,            ///< Coordinates are NaN or infinite.
    ValueNotFinite,       ///< A value of a signal is infinite.
    NoData,               ///< No triangle has values at all of its corners.
    NoArea,               ///< All triangles have zero area.
    DegenerateTriangles,  ///< Some triangles have zero area, or too little for their cotangents.
    ShapeCollapsed,       ///< Triangles became degenerate during the filter.
    SingularMatrix,       ///< W - sigma D is singular, not definite where it must be, or so
                          ///< ill-conditioned that a result would be useless.
    ShrinksToNothing,     ///< The filter leaves nothing of the surface.
    TooManyVertices,      ///< The sparse factor has more entries than an int can count.
    OutOfMemory,          ///< A factor or Krylov space does not fit; limit(): vertices that would.
    BasisOutOfMemory,     ///< A basis does not fit; limit(): the largest basis size that would.
    BasisTooLarge,        ///< More harmonics than there are; limit(): the largest basis size.
    BasisTooSmall,        ///< Constant modes only; limit(): the smallest useful basis size.
    BasisIncomplete,      ///< Some or all eigenvectors could not be computed.
    TooManyHarmonics,     ///< A discontinuous gain needs more harmonics than limit().
    BoundaryFixesAll,     ///< A fixed boundary leaves nothing free.
    TooSteep,             ///< The gain is too steep for a rational Krylov space.
    SolverFailed,         ///< A numerical method failed; the text says which.
    Cancelled,
};

/// Formats a number for an error message: 1e-09 instead of std::to_string's 0.000000.
inline std::string textOf(double number) {
    std::ostringstream text;
    text << number;
    return text.str();
}

/// Base class of everything the core throws. The text says what is wrong and where, with numbers.
class Error : public std::runtime_error {
  public:
    Error(ErrorCode code, const std::string& text, std::ptrdiff_t limit = 0)
        : std::runtime_error(text), code_(code), limit_(limit) {}

    ErrorCode code() const { return code_; }
    std::ptrdiff_t limit() const { return limit_; }  ///< Meaning depends on the code; 0 if unused.

  private:
    ErrorCode code_;
    std::ptrdiff_t limit_;
};

/// The mesh cannot be filtered: it has no triangles, or coordinates are not finite, ...
class InvalidMesh : public Error {
  public:
    using Error::Error;
};

/// An option is out of range, or does not fit the mesh.
class InvalidOption : public Error {
  public:
    using Error::Error;
    explicit InvalidOption(const std::string& text) : Error(ErrorCode::OptionOutOfRange, text) {}
};

/// A factorization broke down, or an iteration did not converge.
class SolverFailure : public Error {
  public:
    using Error::Error;
    explicit SolverFailure(const std::string& text) : Error(ErrorCode::SolverFailed, text) {}
};

/// The caller asked to stop; nothing is wrong.
class Cancelled : public Error {
  public:
    Cancelled() : Error(ErrorCode::Cancelled, "cancelled") {}
};

}  // namespace spectral
