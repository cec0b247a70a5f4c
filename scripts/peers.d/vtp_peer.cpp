// VTP by its authors (YipengQin/VTP_source_code). Its vertices hold the state of a solve, so that each
// has a mesh of its own.

#include "session.hpp"

#include <cstring>
#include <memory>

#include "stdafx.h"
#include "geodesic_mesh.h"
#include "geodesic_algorithm_exact.h"

struct Solver {
    geodesic::Mesh mesh;
    std::vector<double> points;
    std::vector<unsigned> faces;
    std::unique_ptr<geodesic::GeodesicAlgorithmExact> algorithm;

    explicit Solver(const peer::Model& model) : points(model.points), faces(model.faces) {
        mesh.initialize_mesh_data(points, faces);
        algorithm.reset(new geodesic::GeodesicAlgorithmExact(&mesh));
    }

    void solve(unsigned source) { algorithm->propagate(source); }

    double distance(std::size_t vertex) { return mesh.vertices()[vertex].geodesic_distance(); }
};

int main() { return peer::serve<Solver>(); }
