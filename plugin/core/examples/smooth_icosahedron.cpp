// Smooths an icosahedron in the paper's scheme: details below twice its diameter go.
#include <cmath>
#include <exception>
#include <iostream>

#include "core/filter/fractional_filter.h"

int main() {
    const double g = (1.0 + std::sqrt(5.0)) / 2.0;  // the golden ratio
    spectral::Vertices V(12, 3);
    V << -1, g, 0, 1, g, 0, -1, -g, 0, 1, -g, 0,  //
        0, -1, g, 0, 1, g, 0, -1, -g, 0, 1, -g,   //
        g, 0, -1, g, 0, 1, -g, 0, -1, -g, 0, 1;
    spectral::Faces F(20, 3);
    F << 0, 11, 5, 0, 5, 1, 0, 1, 7, 0, 7, 10, 0, 10, 11,  //
        1, 5, 9, 5, 11, 4, 11, 10, 2, 10, 7, 6, 7, 1, 8,   //
        3, 9, 4, 3, 4, 2, 3, 2, 6, 3, 6, 8, 3, 8, 9,       //
        4, 9, 5, 2, 4, 11, 6, 2, 10, 8, 6, 7, 9, 8, 1;
    V.row(0) *= 1.5;  // a spike

    spectral::FilterOptions options;
    options.featureSize = 4.0;  // in the units of V
    options.steps = 10;
    options.basisUpdate = spectral::BasisUpdate::Full;
    try {
        const spectral::FilterResult result = spectral::fractionalFilter(V, F, options);
        for (const int vertex : {0, 3})
            std::cout << (vertex == 0 ? "spike: " : "others: ") << V.row(vertex).norm() << " -> "
                      << result.V.row(vertex).norm() << '\n';
    } catch (const std::exception& error) {
        std::cerr << error.what() << '\n';
        return 1;
    }
}
