#include "core/transfer/equalizer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "core/filter/fractional_filter.h"
#include "core/support/errors.h"
#include "core/support/types.h"
#include "support/shapes.h"

namespace spectral {
namespace {

using testing::Mesh;

/// Frequency of details of the given size.
double frequency(double size) { return 2.0 * kPi / size; }

TEST(Equalizer, PassesThroughItsPointsInAnyOrder) {
    const Equalizer equalizer({{0.1, 0.25}, {2.0, 1.0}, {0.6, 3.0}});
    EXPECT_NEAR(equalizer(frequency(2.0)), 1.0, 1e-14);
    EXPECT_NEAR(equalizer(frequency(0.6)), 3.0, 1e-14);
    EXPECT_NEAR(equalizer(frequency(0.1)), 0.25, 1e-14);
    EXPECT_NEAR(equalizer.middle(), frequency(std::sqrt(0.2)), 1e-12);
    EXPECT_NEAR(equalizer.middleSize(), std::sqrt(0.2), 1e-14);
}

TEST(Equalizer, IsConstantBeyondItsPoints) {
    const Equalizer equalizer({{4.0, 0.5}, {1.0, 2.0}});
    EXPECT_EQ(equalizer(0.0), 0.5);
    EXPECT_EQ(equalizer(frequency(4.01)), 0.5);
    EXPECT_EQ(equalizer(frequency(0.99)), 2.0);
    EXPECT_EQ(equalizer(std::numeric_limits<double>::infinity()), 2.0);
}

TEST(Equalizer, IsMonotoneAndSmoothBetweenPoints) {
    const std::vector<SizedGain> points{{32, 1}, {16, 2}, {8, 4}, {4, 3.9}, {2, 0}, {1, 0.5}};
    const Equalizer equalizer(points);
    constexpr double kOctave = 1e-4;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        const double rise = points[i + 1].gain - points[i].gain;
        double before = equalizer(frequency(points[i].size)), slopeBefore = 0.0;
        for (double octave = kOctave; octave < 1.0; octave += kOctave) {
            const double now = equalizer(frequency(points[i].size) * std::exp2(octave));
            EXPECT_GE((now - before) * rise, -1e-13) << octave << " beyond " << points[i].size;
            const double slope = std::log2(now / before) / kOctave;
            if (octave > 1.5 * kOctave) {
                EXPECT_NEAR(slope, slopeBefore, 0.02) << octave << " beyond " << points[i].size;
            }
            slopeBefore = slope;
            before = now;
        }
    }
}

TEST(Equalizer, IsExactlyConstantForEqualGains) {
    const Equalizer one = octaveEqualizer(0.3, {1, 1, 1, 1, 1, 1});
    for (double size = 0.01; size < 100.0; size *= 1.01) EXPECT_EQ(one(frequency(size)), 1.0);
}

TEST(Equalizer, RejectsInvalidPoints) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    for (const double gain : {-1.0, kNan, kInfinity})
        EXPECT_THROW(Equalizer({{1.0, 1.0}, {2.0, gain}}), InvalidOption) << gain;
    for (const double size : {0.0, -1.0, kNan, kInfinity}) {
        EXPECT_THROW(Equalizer({{size, 1.0}}), InvalidOption) << size;
        EXPECT_THROW(octaveEqualizer(size, {1.0}), InvalidOption) << size;
    }
    EXPECT_THROW(Equalizer({{2.0, 1.0}, {1.0, 1.0}, {2.0, 3.0}}), InvalidOption);
}

TEST(OctaveEqualizer, HasItsGainsAnOctaveApartAndFixedEnds) {
    const Equalizer equalizer = octaveEqualizer(0.5, {0.25, 2.0, 3.0});
    EXPECT_NEAR(equalizer(frequency(0.5)), 0.25, 1e-14);
    EXPECT_NEAR(equalizer(frequency(1.0)), 2.0, 1e-14);
    EXPECT_NEAR(equalizer(frequency(2.0)), 3.0, 1e-14);
    EXPECT_EQ(equalizer(frequency(0.1)), 0.25);  // finer details follow the first gain
    EXPECT_EQ(equalizer(frequency(4.0)), 1.0);   // the overall shape stays
    EXPECT_EQ(equalizer(frequency(50.0)), 1.0);
    EXPECT_NEAR(equalizer.middleSize(), std::sqrt(0.5 * 4.0), 1e-14);
}

/// The unit sphere with small ripples along its normals: a spherical harmonic of a degree at which
/// none has the symmetry of the icosphere, hence of its discretization.
struct RippledSphere {
    static constexpr int kDegree = 14;
    static constexpr double kHeight = 3e-4;

    RippledSphere() : mesh(testing::icosphere(5)), harmonic(mesh.V.rows()) {
        for (Index i = 0; i < mesh.V.rows(); ++i)
            harmonic[i] =
                std::pow(std::complex<double>(mesh.V(i, 0), mesh.V(i, 1)), kDegree).real();
        mesh.V.array().colwise() *= 1.0 + kHeight * harmonic.array();
    }

    /// Wavelength of the ripples: the eigenvalue is l (l + 1).
    static double size() { return frequency(std::sqrt(kDegree * (kDegree + 1.0))); }

    /// Height of the ripples after an equalizer of six octaves, relative to that before.
    double heightAfter(double smallestSize, const std::vector<double>& gains) const {
        const Equalizer equalizer = octaveEqualizer(smallestSize, gains);
        FilterOptions options;
        options.transferFunction.type = FilterType::Custom;
        options.transferFunction.custom = equalizer;
        options.featureSize = equalizer.middleSize();
        options.tolerance = 1e-3 * kHeight;
        options.evaluation.accuracy = 1e-8;
        const FilterResult result = fractionalFilter(mesh.V, mesh.F, options);
        EXPECT_TRUE(result.toleranceReached);
        const Eigen::VectorXd radius = result.V.rowwise().norm();
        const double height =
            (radius.array() - radius.mean()).matrix().dot(harmonic) / harmonic.squaredNorm();
        return height / kHeight;
    }

    Mesh mesh;
    Eigen::VectorXd harmonic;
};

/// The power of the gain by which the height of the ripples changes. To first order in the height,
/// the ripples Y n (n: the normal) have coordinates of degree l - 1 and l + 1, with shares
/// l / (2 l + 1) and (l + 1) / (2 l + 1); and the change of the Laplacian with the shape multiplies
/// the flow of degree j by 1 - 4 / (j (j + 1) - 2).
double powerOfTheGain(int l) {
    const double below = (l - 1.0) * l - 2.0, above = (l + 1.0) * (l + 2.0) - 2.0;
    return 1.0 - 4.0 * (l / below + (l + 1.0) / above) / (2.0 * l + 1.0);
}

TEST(OctaveEqualizer, ScalesRipplesByTheGainOfTheirSize) {
    const RippledSphere sphere;
    const double power = powerOfTheGain(RippledSphere::kDegree);
    ASSERT_GT(power, 0.97);
    for (const double gain : {0.25, 0.5, 2.0, 4.0}) {
        const double expected = std::pow(gain, power);
        EXPECT_NEAR(sphere.heightAfter(RippledSphere::size() / 8, {1, 1, 1, gain, 1, 1}), expected,
                    0.01 * expected);
    }
    EXPECT_LT(sphere.heightAfter(RippledSphere::size() / 8, {1, 1, 1, 0, 1, 1}), 0.003);
}

TEST(OctaveEqualizer, KeepsRipplesBetweenTwoGainsOfOne) {
    const RippledSphere sphere;
    EXPECT_NEAR(sphere.heightAfter(RippledSphere::size() / 8, {0, 2, 1, 1, 1, 3}), 1.0, 0.01);
}

}  // namespace
}  // namespace spectral
