#include "meshlab/filters/vertex_colors.h"

#include <algorithm>
#include <cmath>

namespace {

/// @param t  in [-1, 1].
vcg::Color4b blueWhiteRed(double t) {
    const auto faded =
        static_cast<unsigned char>(std::lround(255.0 * (1.0 - std::min(std::abs(t), 1.0))));
    return t < 0.0 ? vcg::Color4b(faded, faded, 255, 255) : vcg::Color4b(255, faded, faded, 255);
}

}  // namespace

void setDivergingColors(const std::vector<std::size_t>& vertexIndex, const Eigen::VectorXd& values,
                        MeshModel& mesh) {
    mesh.updateDataMask(MeshModel::MM_VERTCOLOR);
    const double extreme = values.cwiseAbs().maxCoeff();
    const double scale = extreme > 0.0 ? 1.0 / extreme : 0.0;
    for (std::size_t i = 0; i < vertexIndex.size(); ++i)
        mesh.cm.vert[vertexIndex[i]].C() =
            blueWhiteRed(scale * values[static_cast<Eigen::Index>(i)]);
}
