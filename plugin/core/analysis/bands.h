#pragma once

#include "core/support/types.h"

namespace spectral {

/// Smooth windows of one octave each, or of an equal part of one, a partition of unity over all
/// frequencies.
///
/// Of p bands an octave, band j has the feature size diagonal 2^-((first + j) / p) in its middle:
/// the bands of two meshes are the same in parts of the diagonal. From one to the next it is half
/// an octave, or a band where that is less, over which one window falls as cos^2 while the other
/// rises; the first takes all lower frequencies, the last all higher ones. A hard edge would need
/// the frequencies of single harmonics, which quadrature does not give.
class Bands {
  public:
    /// @param diagonal  length unit of the feature sizes, > 0.
    /// @param lowest, highest  frequencies that the bands have to hold, 0 < lowest <= highest.
    /// @param perOctave  p >= 1.
    Bands(double diagonal, double lowest, double highest, int perOctave = 1);

    int count() const { return count_; }

    /// Feature size in the middle of band j, length units: from large to small.
    double featureSize(int j) const;

    /// Feature size at the edge of bands j and j + 1, where both windows are 1/2.
    double edge(int j) const;

    /// Band whose middle is nearest to this feature size, by its ratio to it.
    int nearest(double featureSize) const;

    /// Value of window j, in [0, 1], at a frequency >= 0; infinity is allowed.
    double window(int j, double omega) const;

    /// Frequency from which on window j is 0; infinity for the last.
    double end(int j) const;

  private:
    double below(int edge, double omega) const;

    double diagonal_;
    int perOctave_;
    double transition_;  // octaves over which a window gives way to the next
    int first_, count_;
};

}  // namespace spectral
