#include "core/analysis/autocorrelation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/support/types.h"

namespace spectral {
namespace {

constexpr Index kRows = 200, kColumns = 260;
constexpr double kStep = 0.05, kPeriod = 1.3, kWaves = 2.0 * kPi / kPeriod;
const double kFalls = std::acos(-0.6);  // cos(x) / 2 + 1 / 2 = .2

/// A map of points, and heights above it.
struct Map {
    Vertices X{kRows * kColumns, 3};
    Eigen::VectorXd h{kRows * kColumns};
    std::vector<bool> counts = std::vector<bool>(kRows * kColumns, true);

    template <class Height>
    explicit Map(const Height& height) {
        for (Index i = 0; i < h.size(); ++i) {
            const double x = kStep * static_cast<double>(i % kColumns);
            const double y = kStep * static_cast<double>(i / kColumns);
            h[i] = height(x, y);
            X.row(i) << x, y, h[i];
        }
    }

    TextureLengths lengths() const {
        Vertices reference = X;
        reference.col(2).setZero();
        return textureLengths(h, X, reference, counts);
    }
};

Map waves(double along, double across) {
    return Map([=](double x, double y) {
        return std::sin(along * kWaves * x + 0.3) + std::sin(across * kWaves * y);
    });
}

// The autocorrelation is (cos(x) + cos(y)) / 2.
TEST(TextureLengths, OfCrossedWavesAreTheClosedForm) {
    const TextureLengths same = waves(1.0, 1.0).lengths();
    const double diagonal = std::sqrt(2.0) * std::acos(0.2);
    EXPECT_NEAR(same.Sal * kWaves, diagonal, 0.01 * diagonal);
    EXPECT_NEAR(same.Str, diagonal / kFalls, 0.01);
    const TextureLengths twice = waves(2.0, 1.0).lengths();
    EXPECT_NEAR(twice.Sal * 2.0 * kWaves, kFalls, 0.01 * kFalls);
    EXPECT_NEAR(twice.Str, 0.5, 0.005);
}

TEST(TextureLengths, OfGroovesHaveNoRatio) {
    const TextureLengths grooves =
        Map([](double x, double) { return std::sin(kWaves * x); }).lengths();
    EXPECT_NEAR(grooves.Sal * kWaves, std::acos(0.2), 0.02 * std::acos(0.2));
    EXPECT_EQ(grooves.Str, 0.0);
}

TEST(TextureLengths, DoNotDependOnMissingPointsAxesOrPlaces) {
    const TextureLengths whole = waves(2.0, 1.0).lengths();
    Map map = waves(2.0, 1.0);
    std::mt19937 random(5);
    for (Index i = 0; i < map.h.size(); ++i)
        if (random() % 4 == 0) {
            map.counts[i] = false;
            map.h[i] = 1e3;
        }
    EXPECT_NEAR(map.lengths().Sal, whole.Sal, 0.01 * whole.Sal);
    EXPECT_NEAR(map.lengths().Str, whole.Str, 0.01);
    Map turned = waves(2.0, 1.0);
    turned.X.col(0).swap(turned.X.col(2));
    turned.X.array() += 1e5;
    turned.X = turned.X.cast<float>().cast<double>().eval();
    Vertices plane = turned.X;
    plane.col(0).setZero();
    const TextureLengths there = textureLengths(turned.h, turned.X, plane, turned.counts);
    EXPECT_NEAR(there.Sal, whole.Sal, 1e-3 * whole.Sal);
    EXPECT_NEAR(there.Str, whole.Str, 1e-3);
}

TEST(TextureLengths, AreThoseAlongTheReference) {
    Map map = waves(2.0, 1.0);
    Vertices slope = map.X;
    slope.col(2) = 0.75 * map.X.col(0);
    const TextureLengths lengths = textureLengths(map.h, map.X, slope, map.counts);
    EXPECT_NEAR(lengths.Sal, 1.25 * map.lengths().Sal, 0.005 * lengths.Sal);
}

TEST(TextureLengths, OfWhatIsNoGridAreNone) {
    Map map = waves(2.0, 1.0);
    map.X.row(5000)[0] += 0.3 * kStep;
    EXPECT_EQ(map.lengths().Sal, 0.0);
    Map flat([](double, double) { return 0.0; });
    EXPECT_EQ(flat.lengths().Sal, 0.0);
}

}  // namespace
}  // namespace spectral
