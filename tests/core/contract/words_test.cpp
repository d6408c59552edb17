#include "core/contract/words.h"

#include <gtest/gtest.h>

#include <regex>
#include <string>

#include "core/contract/advice.h"
#include "core/contract/filter.h"
#include "core/support/errors.h"

namespace spectral {
namespace {

using Names = Words::Names;

TEST(Words, NameParametersAsTheUsersOfAHostKnowThem) {
    const Filter& filter = filterNamed("apply_coord_spectral_filter_fractional");
    const std::string text =
        "choose a smaller |stop_gain|, |laplacian = intrinsic delaunay| or "
        "{apply 'Merge Close Vertices'|merge close vertices} first";
    EXPECT_EQ(inWords(text, filter, {}),
              "choose a smaller stop_gain, laplacian = intrinsic delaunay or merge close vertices "
              "first");
    EXPECT_EQ(inWords(text, filter, {Names::Options}),
              "choose a smaller --stop-gain, --laplacian 'intrinsic delaunay' or merge close "
              "vertices first");
    EXPECT_EQ(inWords(text, filter, {Names::Labels, true}),
              "choose a smaller Stop gain, Laplacian = intrinsic delaunay or apply 'Merge Close "
              "Vertices' first");
    EXPECT_EQ(inWords("{memory}, |5", filter, {Names::Python, false, "buy some"}), "buy some, |5");
}

TEST(Words, OfAnyAdviceAreOnlyThoseOfTheHost) {
    const std::regex markup("[|{}]"), ofMeshLab("'[A-Z]"), ofPython("[a-z]_[a-z]");
    const Filter& filter = filterNamed("apply_coord_spectral_filter_fractional");
    for (int code = 0; code <= static_cast<int>(ErrorCode::Cancelled); ++code) {
        const Error error(static_cast<ErrorCode>(code), "it failed", 5);
        for (const Values& given : {Values{}, Values{{"laplacian", 1}}, Values{{"boundary", 1}},
                                    Values{{"stop_gain", 1000.0}}, Values{{"filter_type", 1}}}) {
            const std::string text = advice(error, filter, given);
            const std::string inShell = inWords(text, filter, {Names::Options});
            EXPECT_FALSE(std::regex_search(inShell, markup)) << inShell;
            EXPECT_FALSE(std::regex_search(inShell, ofMeshLab)) << inShell;
            EXPECT_FALSE(std::regex_search(inShell, ofPython)) << inShell;
            const std::string inDialog = inWords(text, filter, {Names::Labels, true});
            EXPECT_FALSE(std::regex_search(inDialog, markup)) << inDialog;
            EXPECT_FALSE(std::regex_search(inDialog, ofPython)) << inDialog;
        }
    }
}

}  // namespace
}  // namespace spectral
