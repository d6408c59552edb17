#pragma once

#include <stdexcept>

namespace spectral {

/// Base of everything that the core throws. The text says what is wrong, where, and what to do.
class Error : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
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
};

/// A factorization broke down, or an iteration did not converge.
class SolverFailure : public Error {
  public:
    using Error::Error;
};

/// The caller asked to stop; nothing is wrong.
class Cancelled : public Error {
  public:
    Cancelled() : Error("cancelled") {}
};

}  // namespace spectral
