// Kirsanov's MMP in C++ (mojocorp/geodesic).

#include "session.hpp"

#include <memory>

#include <geodesic/geodesic_algorithm_exact.h>

struct Solver {
    geodesic::Mesh mesh;
    std::unique_ptr<geodesic::GeodesicAlgorithmExact> algorithm;

    explicit Solver(const peer::Model& model) {
        mesh.initialize_mesh_data(model.points, model.faces);
        algorithm = std::make_unique<geodesic::GeodesicAlgorithmExact>(&mesh);
    }

    void solve(unsigned source) {
        const std::vector<geodesic::SurfacePoint> sources(1, geodesic::SurfacePoint(&mesh.vertices()[source]));
        algorithm->propagate(sources);
    }

    double distance(std::size_t vertex) {
        geodesic::SurfacePoint point(&mesh.vertices()[vertex]);
        double distance = -1;
        algorithm->best_source(point, distance);
        return distance;
    }
};

int main() { return peer::serve<Solver>(); }
