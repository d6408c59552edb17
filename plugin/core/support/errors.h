#pragma once

#include <cstddef>
#include <sstream>
#include <stdexcept>
#include <string>

namespace spectral {

/// What is wrong, for a program that knows the remedy in its own user's words.
enum class ErrorCode {
    OptionOutOfRange,     ///< The text names the option and its range.
    EmptyMesh,            ///< No vertices.
    NoFaces,              ///< A point cloud.
    BadIndex,             ///< A triangle refers to a vertex that does not exist.
    NotFinite,            ///< Coordinates that are NaN or infinite.
    ValueNotFinite,       ///< A value of a signal is infinite.
    NoData,               ///< No triangle has values at all of its corners.
    NoArea,               ///< No triangle has an area.
    DegenerateTriangles,  ///< Some triangles have no area, or too little for their cotangents.
    ShapeCollapsed,       ///< The same, in the course of the filter.
    NoDelaunay,           ///< The intrinsic Delaunay flips did not terminate.
    SingularMatrix,       ///< W - sigma D is singular, not definite where it must be, or so
                          ///< ill-conditioned that a result would be useless.
    ShrinksToNothing,     ///< The filter leaves nothing of the surface.
    TooManyVertices,      ///< The sparse factor has more entries than an int can count.
    OutOfMemory,          ///< The factor or a Krylov space; limit(): vertices that would do.
    BasisOutOfMemory,     ///< limit(): the largest basis size that there is memory for.
    BasisTooLarge,        ///< limit(): the largest basis size possible.
    BasisTooSmall,        ///< limit(): the least basis size that makes sense.
    BasisIncomplete,      ///< Eigenvectors could not be computed, or not all of them.
    TooManyHarmonics,     ///< A discontinuous gain needs more of them; limit(): the most.
    BoundaryFixesAll,     ///< A fixed boundary leaves nothing.
    TooSteep,             ///< The gain is too steep for a rational Krylov space.
    SolverFailed,         ///< A numerical method failed; the text says which.
    Cancelled,
};

/// A number in the text of an error: 1e-09 where std::to_string has 0.000000.
inline std::string textOf(double number) {
    std::ostringstream text;
    text << number;
    return text.str();
}

/// Base of everything that the core throws. The text says what is wrong and where, with numbers.
class Error : public std::runtime_error {
  public:
    Error(ErrorCode code, const std::string& text, std::ptrdiff_t limit = 0)
        : std::runtime_error(text), code_(code), limit_(limit) {}

    ErrorCode code() const { return code_; }
    std::ptrdiff_t limit() const { return limit_; }  ///< As the code says; else 0.

  private:
    ErrorCode code_;
    std::ptrdiff_t limit_;
};

/// The mesh cannot be filtered: no triangles, coordinates that are not finite, ...
class InvalidMesh : public Error {
  public:
    using Error::Error;
};

/// An option is out of its range, or does not fit the mesh.
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
