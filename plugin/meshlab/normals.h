#pragma once

#include <common/ml_document/mesh_model.h>

/// MeshLab's normals, to the last bit, on all threads: unit face normals, and vertex normals that
/// sum those of the faces around, each times its angle there. Vertices without faces keep theirs.
void updateNormals(CMeshO& mesh);
