// How long a caller waits from one report of progress to the next.
//   bench_progress MESH.ply...
// For every mesh and setting: seconds in all, then the longest time without a report in
// milliseconds, of the core alone and as the plugin runs it (steady_progress.h), and the stage
// before it.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "core/analysis/artefacts.h"
#include "core/analysis/geometry_spectrum.h"
#include "core/analysis/manifold_harmonics.h"
#include "core/filter/fractional_filter.h"
#include "core/filter/signal_filter.h"
#include "core/mesh/measures.h"
#include "core/support/steady_progress.h"
#include "support/ply.h"

using namespace spectral;

namespace {

using Clock = std::chrono::steady_clock;

double milliseconds(Clock::duration time) {
    return std::chrono::duration<double, std::milli>(time).count();
}

/// The times between the calls of a progress callback, from its construction on.
class Gaps {
  public:
    Progress progress() {
        return Progress([this](double, const std::string& stage) {
            note();
            stage_ = stage;
            return true;
        });
    }

    /// From the last report, or from the beginning, to now.
    void note() {
        const Clock::time_point now = Clock::now();
        if (now - last_ > longest_) {
            longest_ = now - last_;
            before_ = stage_;
        }
        last_ = now;
    }

    double longest() const { return milliseconds(longest_); }
    const std::string& before() const { return before_; }

  private:
    Clock::time_point last_ = Clock::now();
    Clock::duration longest_{0};
    std::string stage_ = "(start)", before_;
};

struct Setting {
    const char* name;
    std::function<void(const testing::Mesh&, double diagonal, const Progress&)> run;
};

FilterOptions lowPass(double featureSize) {
    FilterOptions options;
    options.featureSize = featureSize;
    return options;
}

const std::vector<Setting> kSettings{
    {"low-pass 5 %, automatic steps",
     [](const testing::Mesh& mesh, double diagonal, const Progress& progress) {
         FilterOptions options = lowPass(0.05 * diagonal);
         options.tolerance = 5e-4 * diagonal;
         fractionalFilter(mesh.V, mesh.F, options, progress);
     }},
    {"low-pass 5 %, one step",
     [](const testing::Mesh& mesh, double diagonal, const Progress& progress) {
         FilterOptions options = lowPass(0.05 * diagonal);
         options.steps = 1;
         fractionalFilter(mesh.V, mesh.F, options, progress);
     }},
    {"low-pass 5 %, truncated, two steps",
     [](const testing::Mesh& mesh, double diagonal, const Progress& progress) {
         FilterOptions options = lowPass(0.05 * diagonal);
         options.steps = 2;
         options.evaluation.spectrum = Spectrum::Truncated;
         fractionalFilter(mesh.V, mesh.F, options, progress);
     }},
    {"Vertex Quality, low-pass 5 %",
     [](const testing::Mesh& mesh, double diagonal, const Progress& progress) {
         SignalFilterOptions options;
         options.featureSize = 0.05 * diagonal;
         filterSignal(mesh.V, mesh.F, mesh.V.col(2), options, progress);
     }},
    {"Manifold Harmonics",
     [](const testing::Mesh& mesh, double, const Progress& progress) {
         manifoldHarmonics(mesh.V, mesh.F, {}, progress);
     }},
    {"Geometry Spectrum",
     [](const testing::Mesh& mesh, double, const Progress& progress) {
         geometrySpectrum(mesh.V, mesh.F, {}, progress);
     }},
    {"Spectral Artefacts",
     [](const testing::Mesh& mesh, double diagonal, const Progress& progress) {
         ArtefactOptions options;
         options.featureSize = 0.05 * diagonal;
         measureArtefacts(mesh.V, mesh.F, options, progress);
     }},
};

void measure(const char* file) {
    const testing::Mesh mesh = testing::readPly(file);
    const double diagonal = boundingBoxDiagonal(mesh.V);
    for (const Setting& setting : kSettings) {
        const Clock::time_point start = Clock::now();
        Gaps core;
        setting.run(mesh, diagonal, core.progress());
        core.note();
        const double seconds = 1e-3 * milliseconds(Clock::now() - start);
        Gaps plugin;
        runInBackground(plugin.progress(),
                        [&](const Progress& steady) { setting.run(mesh, diagonal, steady); });
        plugin.note();
        std::printf("| %s | %s | %.1f | %.0f (%s) | %.0f |\n", file, setting.name, seconds,
                    core.longest(), core.before().c_str(), plugin.longest());
        std::fflush(stdout);
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        std::fprintf(stderr, "usage: %s MESH.ply...\n", argv[0]);
        return 2;
    }
    std::printf("| mesh | run | seconds | longest silence of the core, ms | of the plugin, ms |\n");
    for (int i = 1; i < argc; ++i) measure(argv[i]);
    return EXIT_SUCCESS;
}
