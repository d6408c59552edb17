#pragma once

#include <vector>

#include "support/ply.h"

namespace spectral::testing {

/// Unit sphere: an icosahedron whose triangles are split in four `levels` times; 10 4^levels + 2
/// vertices.
Mesh icosphere(int levels);

/// Flat rectangle [0, width] x [0, height] of nx x ny cells, each cut into two right triangles.
Mesh rectangle(double width, double height, int nx, int ny);

/// Upper half of the unit sphere: a pole, and `rings` circles of 6, 12, 18, ... vertices.
Mesh hemisphere(int rings);

/// Axis-parallel box [-1, 1]^3, every face a grid of cells x cells squares of two triangles;
/// closed.
Mesh cube(int cells);

/// The border of a ball of voxels, 2 radius of them across, with a smaller ball taken out: marching
/// tetrahedra of a mask of zeros and ones, as the segmentation of a scan is. Closed; all its
/// corners are midpoints of lattice edges.
Mesh segmentedBall(int radius);

/// Torus with these radii, n x m vertices; closed, genus 1.
Mesh torus(double major, double minor, int n, int m);

/// Both meshes as one, without a common vertex.
Mesh joined(const Mesh& a, const Mesh& b);

/// The mesh with every coordinate displaced by uniform noise in [-amplitude, amplitude].
Mesh withNoise(Mesh mesh, double amplitude, unsigned seed);

/// Meshes of several classes, without symmetry: closed, with a boundary, of two components.
std::vector<Mesh> classesOfMeshes();

/// Longest distance between corresponding vertices.
double largestDifference(const Vertices& A, const Vertices& B);

/// A closed surface without symmetry, 642 vertices: a bumpy, stretched sphere. All eigenvalues
/// differ, and all sizes of details are present.
Mesh blob();

}  // namespace spectral::testing
