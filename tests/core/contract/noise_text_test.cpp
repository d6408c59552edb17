#include "core/contract/noise_text.h"

#include <gtest/gtest.h>

namespace spectral {
namespace {

Diagnosis shapeWith(double heightInEdges, double size) {
    Diagnosis diagnosis;
    diagnosis.kind = NoiseKind::Shape;
    diagnosis.noise.meanEdge = 2.0;
    diagnosis.noise.height = 2.0 * heightInEdges;
    diagnosis.noise.size = size;
    return diagnosis;
}

std::string remedyOf(const Diagnosis& diagnosis) {
    const std::string text = noiseText(diagnosis);
    return text.substr(text.find("coordinates. ") + 13);
}

TEST(NoiseText, SuggestsTheMeasuredDetailWhereItMayBeNoise) {
    EXPECT_EQ(remedyOf(shapeWith(0.085, 1.0)),
              "If its finest detail is noise, try noise height 0.17 (0.085 edges), or Spectral "
              "Filter (Fractional)");
    EXPECT_EQ(remedyOf(shapeWith(0.04, 1.5)),
              "If its finest detail is noise, try noise height 0.08 and noise size 3 (0.04 and 1.5 "
              "edges), or Spectral Filter (Fractional)");
}

TEST(NoiseText, SuggestsRipplesWhereThereIsNoDetail) {
    const std::string ripples =
        "For ripples with crests some four edges apart, try noise height 0.2 and noise size 4 (0.1 "
        "and 2 edges); for wider ones, Spectral Filter (Fractional)";
    EXPECT_EQ(remedyOf(shapeWith(0.0, 1.0)), ripples);
    EXPECT_EQ(remedyOf(shapeWith(0.01, 1.0)), ripples);
    Diagnosis none = shapeWith(0.085, 1.0);
    none.kind = NoiseKind::None;
    EXPECT_EQ(remedyOf(none), ripples);
}

TEST(NoiseText, GivesLengthsInEdgesAndInUnits) {
    Diagnosis scan = shapeWith(0.25, 1.5);
    scan.kind = NoiseKind::Correlated;
    EXPECT_EQ(noiseText(scan), "scanner noise: height 0.25 edges (0.5), size 1.5 edges (3)");
}

}  // namespace
}  // namespace spectral
