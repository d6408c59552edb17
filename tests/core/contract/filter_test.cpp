#include "core/contract/filter.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "core/contract/fractional_report.h"
#include "core/contract/length.h"
#include "core/contract/parameter.h"
#include "core/contract/presets.h"
#include "core/filter/fractional_filter.h"
#include "core/support/errors.h"
#include "support/shapes.h"

namespace spectral {
namespace {

const char* const kFractional = "apply_coord_spectral_filter_fractional";

std::vector<std::string> textsOf(const Warnings& warnings) {
    std::vector<std::string> texts;
    for (const Warning& one : warnings) texts.push_back(one.text);
    return texts;
}

FilterInput sphere() {
    static const testing::Mesh mesh = testing::icosphere(3);
    FilterInput input{mesh.V, mesh.F};
    input.values = Eigen::VectorXd::LinSpaced(mesh.V.rows(), 0.0, 1.0);
    return input;
}

FilterInput inputFor(const Filter& filter) {
    FilterInput input = sphere();
    if (filter.pythonName.find("color") != std::string::npos)
        input.values = (100.0 * input.V.array() + 120.0).matrix();
    return input;
}

TEST(Filters, HaveUniqueNamesAndCompleteDescriptions) {
    std::set<std::string> names, pythonNames;
    for (const Filter& filter : allFilters()) {
        EXPECT_TRUE(names.insert(filter.name).second);
        EXPECT_TRUE(pythonNames.insert(filter.pythonName).second);
        EXPECT_FALSE(filter.help.empty());
        std::set<std::string> parameters;
        for (const Parameter& one : filter.parameters) {
            EXPECT_TRUE(parameters.insert(one.name).second) << one.name;
            EXPECT_FALSE(one.label.empty() || one.help.empty()) << one.name;
            EXPECT_EQ(one.kind == Parameter::Kind::Choice, !one.choices.empty()) << one.name;
            const bool isNumber = one.kind == Parameter::Kind::Integer ||
                                  one.kind == Parameter::Kind::Number ||
                                  one.kind == Parameter::Kind::Length;
            EXPECT_EQ(isNumber, !one.unit.empty()) << one.name;
        }
        EXPECT_EQ(&filterNamed(filter.pythonName), &filter);
    }
    EXPECT_THROW(filterNamed("apply_nothing"), std::out_of_range);
}

TEST(Presets, AreValidOptionsOfTheirFilters) {
    std::set<std::string> names;
    for (const Preset& preset : allPresets()) {
        EXPECT_TRUE(names.insert(preset.name).second) << preset.name;
        EXPECT_FALSE(preset.purpose.empty()) << preset.name;
        EXPECT_NO_THROW(apply(filterNamed(preset.filter), sphere(), preset.options)) << preset.name;
    }
}

TEST(Filters, ReportOnlyWhatTheyDescribe) {
    for (const Filter& filter : allFilters()) {
        std::set<std::string> described;
        for (const ReportEntry& entry : filter.report)
            EXPECT_TRUE(described.insert(entry.name).second) << entry.name;
        const FilterOutput output = apply(filter, inputFor(filter), {});
        EXPECT_FALSE(output.report.empty());
        for (const auto& [name, value] : output.report)
            EXPECT_EQ(described.count(name), 1U) << name;
        EXPECT_FALSE(output.text.empty()) << filter.name;
    }
}

TEST(Filters, TakeEveryParameterAtItsDefault) {
    for (const Filter& filter : allFilters()) {
        Values given;
        for (const Parameter& one : filter.parameters) given[one.name] = one.usual;
        const FilterInput input = inputFor(filter);
        const FilterOutput one = apply(filter, input, {}), other = apply(filter, input, given);
        EXPECT_EQ(one.V, other.V);
        EXPECT_EQ(one.values, other.values);
        EXPECT_EQ(textsOf(other.warnings), textsOf(one.warnings)) << filter.name;
    }
}

TEST(Filters, AreThoseOfTheCore) {
    const FilterInput input = sphere();
    const MeshLengths mesh = lengthsOf(input.V, input.F);
    FilterOptions options;
    options.featureSize = inSinglePrecision(0.3);
    options.steps = 2;
    const FilterOutput output =
        apply(filterNamed(kFractional), input, {{"feature_size", 0.3}, {"steps", 2}});
    EXPECT_EQ(output.V, fractionalFilter(input.V, input.F, options).V);
    EXPECT_GT(mesh.diagonal, 0.0);
}

TEST(Filters, RefuseUnknownAndWrongValuesByName) {
    const Filter& filter = filterNamed(kFractional);
    const auto reason = [&](const Values& given) -> std::string {
        try {
            apply(filter, sphere(), given);
        } catch (const InvalidOption& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_NE(reason({{"stepz", 1}}).find("there is no option stepz"), std::string::npos);
    EXPECT_EQ(reason({{"steps", 1.5}}), "steps = 1.5: must be an integer, 0 to 1000");
    EXPECT_EQ(reason({{"power", 1.5}}), "power = 1.5: must be above 0, at most 1");
    EXPECT_EQ(reason({{"pass_gain", -1}}), "pass_gain = -1: must be at least 0");
    EXPECT_EQ(reason({{"power", 1e39}}), "power = 1e+39: must be above 0, at most 1");
    EXPECT_EQ(reason({{"power", 1e-50}}),
              "power = 1e-50: must be above 0, at most 1, at least 1.17549e-38");
    const std::string forms = std::string(": give ") + kLengthForms;
    const std::string most = forms + ", at most 3.40282e+38";
    EXPECT_EQ(reason({{"feature_size", 1e39}}), "feature_size = 1e+39: must be above 0" + most);
    EXPECT_EQ(reason({{"feature_size", std::string("1e39")}}), "feature_size = 1e39" + most);
    EXPECT_EQ(reason({{"feature_size", std::string("1e-50%")}}),
              "feature_size = 1e-50%" + forms + ", at least 1.17549e-38");
    EXPECT_EQ(reason({{"feature_size", std::string("0")}}),
              "feature_size = 0" + forms + ", above zero");
    EXPECT_EQ(reason({{"boundary", std::string("open")}}), "boundary = open: choose free, fixed");
    EXPECT_EQ(reason({{"boundary", 2}}), "boundary = 2: choose 0 (free), 1 (fixed)");
    EXPECT_NE(reason({{"feature_size", std::string("5 m")}}).find("feature_size = '5 m'"),
              std::string::npos);
    EXPECT_NE(reason({{"weight", 1}, {"steps", true}}).find("steps = true"), std::string::npos);
}

TEST(Filters, AdviseWithoutChangingTheClassOfAnError) {
    const Filter& filter = filterNamed(kFractional);
    const Faces none(0, 3);
    const FilterInput points{sphere().V, none};
    try {
        apply(filter, points, {});
        FAIL();
    } catch (const InvalidMesh& error) {
        EXPECT_EQ(error.code(), ErrorCode::NoFaces);
        EXPECT_NE(std::string(error.what()).find("reconstruct one first"), std::string::npos);
    }
}

TEST(Filters, OfValuesRefuseAMeshWithoutAny) {
    FilterInput input = sphere();
    input.values.resize(0, 0);
    for (const char* const name :
         {"apply_scalar_spectral_filter_per_vertex", "apply_color_spectral_filter_per_vertex"})
        EXPECT_THROW(apply(filterNamed(name), input, {}), InvalidMesh);
}

TEST(Filters, WarnOfParametersWithoutEffect) {
    const FilterOutput output =
        apply(filterNamed(kFractional), sphere(), {{"order", 3}, {"steps", 1}, {"passes", 2}});
    const std::vector<std::string> expected{"order has no effect without response = butterworth",
                                            "passes has no effect without steps = 0"};
    EXPECT_EQ(textsOf(output.warnings), expected);
    for (const Warning& one : output.warnings) EXPECT_EQ(one.code, WarningCode::UnusedOption);
}

TEST(FractionalText, GivesTheRoundingOfCreasesInPercentOfTheDiagonal) {
    FilterResult result;
    result.roundedCreases = {12, 0.5};
    const std::string text = fractionalText({}, result, 10.0, "", "");
    EXPECT_NE(text.find("12 vertices along sharp edges moved by up to 0.5 (5 % of the diagonal)"),
              std::string::npos)
        << text;
}

TEST(Warnings, HaveCodesOfTheirOwn) {
    std::set<std::string> names;
    for (const WarningKind& one : allWarnings()) {
        EXPECT_TRUE(names.insert(one.name).second) << one.name;
        EXPECT_EQ(std::string(one.name).find(' '), std::string::npos);  // the plugin's lines
    }
}

TEST(Length, IsReadInAllUnits) {
    const MeshLengths mesh{200.0, 0.5, 100.0};
    EXPECT_EQ(Length::parse(" 5% ").in(mesh, 1.0), 10.0);
    EXPECT_EQ(Length::parse("100%").in(mesh, 1.0), 200.0);
    EXPECT_EQ(Length::parse("6e").in(mesh, 1.0), 3.0);
    EXPECT_EQ(Length::parse("0.25").in(mesh, 1.0), 0.25);
    EXPECT_EQ(Length::parse("1e-3").in(mesh, 1.0), inSinglePrecision(1e-3));
    EXPECT_EQ(Length::parse("auto").in(mesh, 1.0), 1.0);
    for (const char* const wrong : {"", "%", "e", "5 m", "5%%", "101%", "five", "1 2"})
        EXPECT_THROW(Length::parse(wrong), InvalidOption) << wrong;
}

std::string messageOf(const Parameter& parameter, const Value& value, const MeshLengths& mesh) {
    try {
        converted(parameter, value, mesh);
        return "";
    } catch (const InvalidOption& error) {
        return error.what();
    }
}

TEST(Length, OutOfProportionToTheMeshIsRefusedForEveryLengthOfEveryFilter) {
    const MeshLengths mesh{1.25, 0.01, 1.25};
    for (const Filter& filter : allFilters())
        for (const Parameter& one : filter.parameters) {
            if (one.kind != Parameter::Kind::Length) continue;
            const double largest = one.largestShare * mesh.diagonal;
            EXPECT_EQ(messageOf(one, largest, mesh), "") << one.name;
            EXPECT_EQ(messageOf(one, std::string("auto"), mesh), "") << one.name;
            EXPECT_EQ(messageOf(one, 100.0, MeshLengths{}), "") << one.name;  // of no mesh
            for (const Value& meant : {Value(2.0), Value(2), Value(std::string("2"))}) {
                const std::string text = messageOf(one, meant, mesh);
                EXPECT_NE(text.find("160 % of the diagonal"), std::string::npos) << text;
                EXPECT_NE(text.find("did you mean 2%?"), std::string::npos) << text;
            }
            for (const Value& large : {Value(2000.0), Value(std::string("1999"))}) {
                const std::string text = messageOf(one, large, mesh);
                EXPECT_NE(text.find("give at most"), std::string::npos) << text;
            }
        }
}

TEST(Length, StaysInRangeWhereSinglePrecisionDoesNot) {
    EXPECT_EQ(inSinglePrecision(1e-60), 1e-60);
    EXPECT_EQ(inSinglePrecision(1e60), 1e60);
    EXPECT_EQ(Length::parse("50%").in({1e60, 0.0, 1e60}, 0.0), 5e59);
}

}  // namespace
}  // namespace spectral
