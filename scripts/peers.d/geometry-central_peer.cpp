// MMP of geometry-central (nmwsharp/geometry-central), Kirsanov's program over its mesh. A solve
// includes the queries of all distances.

#include "session.hpp"

#include <memory>
#include <tuple>

#include "geometrycentral/surface/exact_geodesics.h"
#include "geometrycentral/surface/surface_mesh_factories.h"

// The parts of the library that it needs, without those that read files.
#include "surface/barycentric_vector.cpp"
#include "surface/base_geometry_interface.cpp"
#include "surface/edge_length_geometry.cpp"
#include "surface/embedded_geometry_interface.cpp"
#include "surface/exact_geodesic_helpers.cpp"
#include "surface/exact_geodesics.cpp"
#include "surface/extrinsic_geometry_interface.cpp"
#include "surface/halfedge_factories.cpp"
#include "surface/intrinsic_geometry_interface.cpp"
#include "surface/manifold_surface_mesh.cpp"
#include "surface/polygon_mesh_helpers.cpp"
#include "surface/surface_mesh.cpp"
#include "surface/surface_mesh_factories.cpp"
#include "surface/surface_point.cpp"
#include "surface/vertex_position_geometry.cpp"
#include "utilities/disjoint_sets.cpp"
#include "utilities/elementary_geometry.cpp"
#include "utilities/utilities.cpp"

using namespace geometrycentral;
using namespace geometrycentral::surface;

struct Solver {
    std::unique_ptr<SurfaceMesh> mesh;
    std::unique_ptr<VertexPositionGeometry> geometry;
    std::unique_ptr<GeodesicAlgorithmExact> algorithm;
    VertexData<double> distances;

    explicit Solver(const peer::Model& model) {
        std::vector<std::vector<size_t>> faces;
        for (std::size_t face = 0; face < model.faces.size(); face += 3)
            faces.push_back({model.faces[face], model.faces[face + 1], model.faces[face + 2]});
        std::vector<Vector3> points;
        for (std::size_t vertex = 0; vertex < model.points.size(); vertex += 3)
            points.push_back({model.points[vertex], model.points[vertex + 1], model.points[vertex + 2]});
        std::tie(mesh, geometry) = makeSurfaceMeshAndGeometry(faces, points);
        algorithm.reset(new GeodesicAlgorithmExact(*mesh, *geometry));
    }

    void solve(unsigned source) {
        algorithm->propagate(mesh->vertex(source));
        distances = algorithm->getDistanceFunction();
    }

    double distance(std::size_t vertex) { return distances[vertex]; }
};

int main() { return peer::serve<Solver>(); }
