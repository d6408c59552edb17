#pragma once

#include "core/support/types.h"

namespace spectral {

/// Smooth windows, p per octave: a partition of unity over all frequencies.
///
/// The centre of band j is at the feature size diagonal 2^-((first + j) / p), so that bands of
/// different meshes agree relative to the diagonal. Between neighbouring bands one window falls as
/// cos^2 while the other rises, over half an octave or one band, whichever is less; the first band
/// includes all lower frequencies, the last all higher ones. Sharp edges would require the
/// frequencies of single harmonics, which quadrature does not provide.
class Bands {
  public:
    /// @param diagonal  reference length of the feature sizes, > 0.
    /// @param lowest, highest  frequencies to cover, 0 < lowest <= highest.
    /// @param perOctave  p >= 1.
    Bands(double diagonal, double lowest, double highest, int perOctave = 1);

    int count() const { return count_; }

    /// Feature size at the centre of band j, length units, descending.
    double featureSize(int j) const;

    /// Feature size at the edge between bands j and j + 1, where both windows are 1/2.
    double edge(int j) const;

    /// Index of the band whose centre is nearest to this feature size, in octaves.
    int nearest(double featureSize) const;

    /// Value of window j, in [0, 1], at a frequency >= 0; infinity is allowed.
    double window(int j, double omega) const;

    /// Frequency above which window j is 0; infinity for the last window.
    double end(int j) const;

  private:
    double below(int edge, double omega) const;

    double diagonal_;
    int perOctave_;
    double transition_;  // octaves over which neighbouring windows overlap
    int first_, count_;
};

}  // namespace spectral
