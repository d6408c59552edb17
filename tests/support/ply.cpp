#include "support/ply.h"

#include <cstdint>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "core/mesh/mesh.h"

namespace spectral::testing {

namespace {

template <typename T>
T readValue(std::istream& in) {
    T value;
    in.read(reinterpret_cast<char*>(&value), sizeof value);
    return value;
}

}  // namespace

Mesh readPly(const std::string& path) {
    const auto fail = [&](const std::string& what) {
        throw std::runtime_error(path + ": " + what);
    };
    std::ifstream in(path, std::ios::binary);
    if (!in) fail("cannot be opened");

    Index vertices = 0, faces = 0;
    std::vector<std::string> vertexTypes, faceProperties;
    bool littleEndian = false, inVertex = false;
    std::string line;
    while (std::getline(in, line) && line != "end_header") {
        std::istringstream words(line);
        std::string key, word;
        words >> key >> word;
        if (key == "format") littleEndian = word == "binary_little_endian";
        if (key == "element") {
            inVertex = word == "vertex";
            words >> (inVertex ? vertices : faces);
        }
        if (key == "property" && inVertex) vertexTypes.push_back(word);
        if (key == "property" && !inVertex) faceProperties.push_back(line);
    }
    const bool doubles = !vertexTypes.empty() && vertexTypes[0] == "double";
    if (!littleEndian || vertexTypes.size() != 3 || faceProperties.size() != 1)
        fail("not a binary little-endian PLY of x, y, z and triangles alone");

    Mesh mesh{Vertices(vertices, 3), Faces(faces, 3)};
    for (Index i = 0; i < vertices; ++i)
        for (int c = 0; c < 3; ++c)
            mesh.V(i, c) = doubles ? readValue<double>(in) : readValue<float>(in);
    for (Index t = 0; t < faces; ++t) {
        if (readValue<std::uint8_t>(in) != 3) fail("has a face that is no triangle");
        for (int c = 0; c < 3; ++c) mesh.F(t, c) = readValue<std::int32_t>(in);
    }
    if (!in) fail("ends too early");
    return mesh;
}

}  // namespace spectral::testing
