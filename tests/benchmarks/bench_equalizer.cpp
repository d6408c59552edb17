// What a preview of Spectral Equalizer costs on a mesh, and how near it is: bench_equalizer
// MESH.ply Times are of the processor.

#include <cstdio>
#include <ctime>
#include <memory>

#include "core/contract/filter.h"
#include "support/ply.h"

using namespace spectral;

namespace {

template <class Work>
double secondsOf(const Work& work) {
    const std::clock_t start = std::clock();
    work();
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

void timePreviews(const FilterInput& input) {
    const Filter& filter = filterNamed("apply_coord_spectral_equalizer");
    std::shared_ptr<void> kept;
    Vertices draft, sum;
    std::printf("%ld vertices, processor seconds:\n", static_cast<long>(input.V.rows()));
    for (const char* const gain : {"gain_8x", "gain_4x", "gain_2x", "gain_1x"}) {
        const Values given{{gain, 2.0}};
        Values accurate = given;
        accurate["accurate"] = true;
        Vertices exact;
        const double before = secondsOf([&] { draft = apply(filter, input, given).V; });
        const double after = secondsOf([&] { sum = preview(filter, input, given, kept).V; });
        const double again = secondsOf([&] { preview(filter, input, given, kept); });
        exact = apply(filter, input, accurate).V;
        const double moved = (exact - input.V).norm();
        std::printf(
            "  %s x 2: a run %.2f, error %.3f of the displacement; preview %.2f, then %.3f, error "
            "%.3f\n",
            gain, before, (draft - exact).norm() / moved, after, again,
            (sum - exact).norm() / moved);
        std::fflush(stdout);
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        std::fprintf(stderr, "usage: bench_equalizer MESH.ply\n");
        return 2;
    }
    const testing::Mesh mesh = testing::readPly(argv[1]);
    timePreviews({mesh.V, mesh.F});
}
