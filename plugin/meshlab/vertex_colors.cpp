#include "meshlab/vertex_colors.h"

#include <algorithm>
#include <cmath>

namespace {

using Rgb = Eigen::Array3d;

vcg::Color4b colorBetween(const Rgb& from, const Rgb& to, double t) {
    const Rgb color = from + t * (to - from);
    const auto level = [&](int c) { return static_cast<unsigned char>(std::lround(color[c])); };
    return {level(0), level(1), level(2), 255};
}

const Rgb& white() {
    static const Rgb color(255, 255, 255);
    return color;
}

/// @param t  in [-1, 1].
vcg::Color4b signedColor(double t) {
    static const Rgb blue(0, 0, 255), red(255, 0, 0);
    return colorBetween(white(), t < 0.0 ? blue : red, std::abs(t));
}

/// @param t  in [0, 1].
vcg::Color4b sizeColor(double t) {
    static const Rgb orange(253, 141, 60), darkRed(128, 0, 38);
    return t < 0.5 ? colorBetween(white(), orange, 2.0 * t)
                   : colorBetween(orange, darkRed, 2.0 * t - 1.0);
}

template <class Map>
void setColors(const std::vector<std::size_t>& vertexIndex, const Eigen::VectorXd& values,
               double extent, MeshModel& mesh, Map map) {
    mesh.updateDataMask(MeshModel::MM_VERTCOLOR);
    for (std::size_t i = 0; i < vertexIndex.size(); ++i)
        mesh.cm.vert[vertexIndex[i]].C() =
            map(std::clamp(values[static_cast<Eigen::Index>(i)] / extent, -1.0, 1.0));
}

}  // namespace

void setSignedColors(const std::vector<std::size_t>& vertexIndex, const Eigen::VectorXd& values,
                     double extent, MeshModel& mesh) {
    setColors(vertexIndex, values, extent, mesh, signedColor);
}

void setSizeColors(const std::vector<std::size_t>& vertexIndex, const Eigen::VectorXd& values,
                   double extent, MeshModel& mesh) {
    setColors(vertexIndex, values.cwiseMax(0.0), extent, mesh, sizeColor);
}
