// Calls the entry points of the core with meshes and options made from seeds, and checks what the
// headers promise (contract.h).
//
// usage: fuzz_core [--cases N] [--first-seed S] [--seconds T] [--seeds FILE] [--limit SECONDS]
//                  [--errors yes] [--compare no] [--solver factorization|products]
//        fuzz_core --seed S    one seed, in this process, with its full outcome
//
// Cases have seeds S, S + 64, ...: closer ones share bytes. Seeds below 1e12 make meshes of any
// size, larger ones mostly small meshes, which allow more cases per hour; those from 1e15 on
// also give filters custom gains, parts of the mesh, creases and volumes; those from 2e15 denoise,
// those from 3e15 have meshes of needles.
// --limit is for one case; --errors prints the errors that are allowed, too; --compare no leaves
// out the dense solver, for sanitizers; --solver makes filters use it whatever it costs, and with
// products spectra have no harmonics.
//
// A file of seeds has one in each line, with a remark after it. Seeds mean the same on every
// platform, but not after a change of meshes.cpp or cases.cpp.

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iostream>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "fuzz/contract.h"
#include "fuzz/worker.h"

namespace {

using namespace spectral::fuzz;

/// Seeds from here on make mostly small meshes.
constexpr std::uint64_t kFirstOfSmall = 1000000000000;

/// Seeds from here on call `addPart`, with a stream of its own: the others keep their meaning.
constexpr std::uint64_t kFirstOfParts = 1000000000000000;
constexpr std::uint64_t kStreamOfParts = 1ULL << 62;

/// Seeds from here on denoise.
constexpr std::uint64_t kFirstOfDenoise = 2000000000000000;

/// Seeds from here on make meshes of needles.
constexpr std::uint64_t kFirstOfNeedles = 3000000000000000;

struct Arguments {
    std::uint64_t cases = 1000, firstSeed = kFirstOfSmall;
    double seconds = std::numeric_limits<double>::infinity(), limit = 60.0;
    std::optional<std::vector<std::uint64_t>> seeds;  ///< Replaces the range.
    bool isVerbose = false, showsErrors = false, compares = true;
    spectral::Solver solver = spectral::Solver::Cheapest;
};

std::vector<std::uint64_t> seedsOf(const std::string& path) {
    std::ifstream file(path);
    if (!file) throw std::runtime_error("cannot read " + path);
    std::vector<std::uint64_t> seeds;
    for (std::string line; std::getline(file, line);)
        if (!line.empty() && line[0] != '#') seeds.push_back(std::stoull(line));
    return seeds;
}

spectral::Solver solverOf(const std::string& name) {
    if (name == "factorization") return spectral::Solver::Factorization;
    if (name == "products") return spectral::Solver::Products;
    throw std::runtime_error("unknown solver " + name);
}

Arguments argumentsOf(int count, char** values) {
    Arguments arguments;
    for (int i = 1; i < count; i += 2) {
        const std::string name = values[i];
        if (i + 1 == count) throw std::runtime_error(name + " needs a value");
        const char* value = values[i + 1];
        if (name == "--cases")
            arguments.cases = std::stoull(value);
        else if (name == "--first-seed")
            arguments.firstSeed = std::stoull(value);
        else if (name == "--seconds")
            arguments.seconds = std::stod(value);
        else if (name == "--limit")
            arguments.limit = std::stod(value);
        else if (name == "--errors")
            arguments.showsErrors = std::string(value) == "yes";
        else if (name == "--compare")
            arguments.compares = std::string(value) == "yes";
        else if (name == "--solver")
            arguments.solver = solverOf(value);
        else if (name == "--seeds")
            arguments.seeds = seedsOf(value);
        else if (name == "--seed") {
            arguments.seeds = std::vector<std::uint64_t>{std::stoull(value)};
            arguments.isVerbose = true;
        } else
            throw std::runtime_error("unknown option " + name);
    }
    return arguments;
}

Case caseOf(std::uint64_t seed, spectral::Solver solver) {
    const std::vector<std::uint8_t> bytes = bytesOf(seed);
    Choices choices(bytes.data(), bytes.size());
    if (seed >= kFirstOfNeedles) return makeCase(choices, Sizes::Needles);
    if (seed >= kFirstOfDenoise) return makeDenoiseCase(choices);
    Case made = makeCase(choices, seed < kFirstOfSmall ? Sizes::Any : Sizes::MostlySmall);
    if (seed >= kFirstOfParts) {
        const std::vector<std::uint8_t> more = bytesOf(seed + kStreamOfParts);
        Choices parts(more.data(), more.size());
        addPart(parts, made);
    }
    if (auto* filter = std::get_if<spectral::FilterOptions>(&made.options))
        filter->evaluation.solver = solver;
    auto* spectrum = std::get_if<spectral::SpectrumOptions>(&made.options);
    if (spectrum != nullptr && solver == spectral::Solver::Products) spectrum->basisSize = 0;
    return made;
}

/// Counters, in memory that all processes share.
struct Counts {
    static constexpr int kCodes = static_cast<int>(spectral::ErrorCode::Cancelled) + 1;
    static constexpr int kKinds = 64, kName = 32;
    long cases, results, compared, excused, failed;
    long errors[kCodes];
    char kinds[kKinds][kName];
    long failures[kKinds];

    void addFailure(const std::string& kind) {
        int k = 0;
        while (k < kKinds - 1 && kinds[k][0] != '\0' && kind != kinds[k]) ++k;
        std::snprintf(kinds[k], kName, "%s", kind.c_str());
        ++failures[k];
    }

    void add(const Verdict& verdict) {
        ++cases;
        results += verdict.outcome.result.has_value();
        compared += verdict.isCompared;
        excused += verdict.isExcused;
        failed += !verdict.failures.empty();
        if (verdict.outcome.code) ++errors[static_cast<int>(*verdict.outcome.code)];
        for (const Failure& failure : verdict.failures) addFailure(failure.kind);
    }
};

void print(std::uint64_t seed, const Failure& failure, const Case& of) {
    std::cout << "FAILED seed " << seed << " [" << failure.kind << "] " << failure.text << " | "
              << describe(of) << std::endl;
}

void print(const Counts& counts) {
    std::cout << counts.cases << " cases, " << counts.results << " results, " << counts.compared
              << " compared with a dense reference, " << counts.excused
              << " of them differ by round-off of the input, " << counts.failed
              << " cases failed\n";
    for (int code = 0; code < Counts::kCodes; ++code)
        if (counts.errors[code] > 0)
            std::cout << "  error " << nameOf(static_cast<spectral::ErrorCode>(code)) << ": "
                      << counts.errors[code] << "\n";
    for (int k = 0; k < Counts::kKinds && counts.failures[k] > 0; ++k)
        std::cout << "  FAILURE " << counts.kinds[k] << ": " << counts.failures[k] << "\n";
}

void printOutcome(const Outcome& outcome) {
    if (!outcome.result) {
        std::cout << "  threw " << (outcome.code ? nameOf(*outcome.code) : "what is not ours")
                  << ": " << outcome.text << "\n";
        return;
    }
    if (const auto* filter = std::get_if<spectral::FilterResult>(&*outcome.result))
        std::cout << "  " << filter->steps << " steps, moved by " << filter->maxDisplacement
                  << ", error estimate " << filter->errorEstimate << ", accuracy "
                  << filter->accuracy << (filter->accuracyReached ? "" : " not") << " reached, "
                  << filter->solves << " solves, " << filter->eigenvalues.size() << " harmonics\n";
    if (const auto* artefacts = std::get_if<spectral::Artefacts>(&*outcome.result))
        std::cout << "  maximum " << artefacts->maximum << ", error estimate "
                  << artefacts->errorEstimate << "\n";
    if (const auto* harmonics = std::get_if<spectral::ManifoldHarmonics>(&*outcome.result))
        std::cout << "  lambda " << harmonics->lambda.transpose() << "\n  residuals "
                  << harmonics->residuals.transpose() << "\n";
    if (const auto* spectrum = std::get_if<spectral::GeometrySpectrum>(&*outcome.result))
        std::cout << "  energy " << spectrum->totalEnergy << ", mismatch " << spectrum->mismatch
                  << ", octaves " << spectrum->octaveEnergies.transpose() << "\n";
}

int runOne(std::uint64_t seed, spectral::Solver solver) {
    const Case made = caseOf(seed, solver);
    std::cout << "seed " << seed << ": " << describe(made) << std::endl;
    const Verdict verdict = check(made);
    printOutcome(verdict.outcome);
    std::cout << "  " << (verdict.isCompared ? "" : "not ") << "compared with a dense reference"
              << (verdict.isExcused ? ", differs by round-off of the input" : "") << "\n";
    for (const Failure& failure : verdict.failures)
        std::cout << "  FAILED [" << failure.kind << "] " << failure.text << "\n";
    return verdict.failures.empty() ? 0 : 1;
}

int runAll(const Arguments& arguments) {
    using Clock = std::chrono::steady_clock;
    const auto begin = Clock::now();
    auto* counts = static_cast<Counts*>(sharedMemory(sizeof(Counts)));
    const auto seedOf = [&](std::uint64_t i) {
        return arguments.seeds ? (*arguments.seeds)[i] : arguments.firstSeed + i * kSeedDistance;
    };
    runInChildren(
        0, arguments.seeds ? arguments.seeds->size() : arguments.cases, arguments.limit,
        [&](std::uint64_t i) {
            const Case made = caseOf(seedOf(i), arguments.solver);
            const Verdict verdict = check(made, arguments.compares);
            counts->add(verdict);
            for (const Failure& failure : verdict.failures) print(seedOf(i), failure, made);
            const Outcome& outcome = verdict.outcome;
            if (arguments.showsErrors && outcome.code)
                std::cout << "ERROR seed " << seedOf(i) << " [" << nameOf(*outcome.code) << "] "
                          << outcome.text << " | " << describe(made) << std::endl;
            return std::chrono::duration<double>(Clock::now() - begin).count() < arguments.seconds;
        },
        [&](std::uint64_t i, const std::string& what) {
            ++counts->cases;
            ++counts->failed;
            counts->addFailure(what);
            print(seedOf(i), {what, "no outcome"}, caseOf(seedOf(i), arguments.solver));
        });
    print(*counts);
    return counts->failed == 0 ? 0 : 1;
}

}  // namespace

int main(int count, char** values) {
    try {
        const Arguments arguments = argumentsOf(count, values);
        return arguments.isVerbose ? runOne(arguments.seeds->front(), arguments.solver)
                                   : runAll(arguments);
    } catch (const std::exception& error) {
        std::cerr << "fuzz_core: " << error.what() << "\n";
        return 2;
    }
}
