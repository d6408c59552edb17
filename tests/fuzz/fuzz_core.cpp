// Calls the entry points of the core with meshes and options made from seeds, and checks what the
// headers promise (contract.h).
//
// usage: fuzz_core [--cases N] [--first-seed S] [--seeds FILE] [--limit SECONDS]
//                  [--errors yes] [--compare no] [--solver factorization|products]
//
// Cases have seeds S, S + 64, ...: closer ones share bytes. Seeds below 1e12 make meshes of any
// size, larger ones mostly small meshes, which allow more cases per hour; those from 1e15 on
// also give filters custom gains, parts of the mesh, creases and volumes; those from 2e15 denoise,
// those from 3e15 have meshes of needles.
// --limit is for one case, which fails above it; --errors prints the errors that are allowed, too;
// --cases 1 --first-seed S repeats one. --compare no leaves
// out the dense solver, for sanitizers; --solver makes filters use it whatever it costs, and with
// products spectra have no harmonics.
//
// A file of seeds has one in each line, with a remark after it. Seeds mean the same on every
// platform, but not after a change of meshes.cpp or cases.cpp.

#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iostream>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "fuzz/contract.h"

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
    double limit = 60.0;
    std::optional<std::vector<std::uint64_t>> seeds;  ///< Replaces the range.
    bool showsErrors = false, compares = true;
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
        else
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

/// What happened so far.
struct Counts {
    long cases = 0, results = 0, compared = 0, excused = 0, failed = 0;
    std::map<std::string, long> failures;

    void add(const Verdict& verdict) {
        ++cases;
        results += verdict.outcome.result.has_value();
        compared += verdict.isCompared;
        excused += verdict.isExcused;
        failed += !verdict.failures.empty();
        for (const Failure& failure : verdict.failures) ++failures[failure.kind];
    }
};

void print(const Counts& counts) {
    std::cout << counts.cases << " cases, " << counts.results << " results, " << counts.compared
              << " compared with a dense reference, " << counts.excused
              << " of them differ by round-off of the input, " << counts.failed
              << " cases failed\n";
    for (const auto& [kind, count] : counts.failures)
        std::cout << "  FAILURE " << kind << ": " << count << "\n";
}

/// The seed of this moment, for the message of a crash or of an interruption.
volatile std::uint64_t presentSeed = 0;

void tellSeed(int signal) {
    std::fprintf(stderr, "signal %d at seed %llu\n", signal,
                 static_cast<unsigned long long>(presentSeed));
    std::signal(signal, SIG_DFL);
    std::raise(signal);
}

int run(const Arguments& arguments) {
    using Clock = std::chrono::steady_clock;
    for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGINT, SIGTERM})
        std::signal(signal, tellSeed);
    Counts counts;
    const std::uint64_t count = arguments.seeds ? arguments.seeds->size() : arguments.cases;
    for (std::uint64_t i = 0; i < count; ++i) {
        const std::uint64_t seed =
            arguments.seeds ? (*arguments.seeds)[i] : arguments.firstSeed + i * kSeedDistance;
        presentSeed = seed;
        const auto begin = Clock::now();
        const Case made = caseOf(seed, arguments.solver);
        Verdict verdict = check(made, arguments.compares);
        const std::chrono::duration<double> took = Clock::now() - begin;
        if (took.count() > arguments.limit)
            verdict.failures.push_back(
                {"takes too long", std::to_string(took.count()) + " seconds"});
        counts.add(verdict);
        const auto print = [&](const char* what, const std::string& kind, const std::string& text) {
            std::cout << what << " seed " << seed << " [" << kind << "] " << text << " | "
                      << describe(made) << std::endl;
        };
        for (const auto& [kind, text] : verdict.failures) print("FAILED", kind, text);
        if (arguments.showsErrors && !verdict.outcome.result)
            print("ERROR", "allowed", verdict.outcome.text);
    }
    print(counts);
    return counts.failed == 0 ? 0 : 1;
}

}  // namespace

int main(int count, char** values) {
    try {
        return run(argumentsOf(count, values));
    } catch (const std::exception& error) {
        std::cerr << "fuzz_core: " << error.what() << "\n";
        return 2;
    }
}
