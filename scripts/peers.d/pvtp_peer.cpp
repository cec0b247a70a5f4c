// Parallel VTP by its authors (djie-0329/PVTP). Its argument is the number of threads.
// `mend_pvtp` of scripts/peers says what is changed.

#include "session.hpp"

#include <cstdlib>
#include <cstring>
#include <memory>

#include <tbb/global_control.h>

#include "stdafx.h"

using std::max;
using std::min;

// It prints its statistics, where geobench reads answers.
#define printf(...) ((void)0)
#include "geodesic_mesh.h"
#include "geodesic_algorithm_parallel_fwp_exact.h"
#undef printf

static unsigned threads = 1;

// The mean anisotropy of the faces, cut to a whole number: the width of a bucket is the mean length
// of an edge by it, as the authors' program has it.
double whole_anisotropy(geodesic::Mesh& mesh) {
    double sum = 0;
    for (auto& face : mesh.faces()) {
        double longest = 0, half = 0, sides[3];
        for (int side = 0; side < 3; ++side) {
            sides[side] = face.adjacent_edges()[side]->length();
            longest = std::max(longest, sides[side]);
            half += sides[side] / 2;
        }
        const double area = std::sqrt(half * (half - sides[0]) * (half - sides[1]) * (half - sides[2]));
        sum += half * longest / (2 * std::sqrt(3.0) * area);
    }
    return std::floor(sum / mesh.faces().size());
}

struct Solver {
    geodesic::Mesh mesh;
    std::vector<double> points;
    std::vector<unsigned> faces;
    std::unique_ptr<geodesic::GeodesicAlgorithmParallelFWPExact> algorithm;

    explicit Solver(const peer::Model& model) : points(model.points), faces(model.faces) {
        mesh.initialize_mesh_data(points, faces);
        algorithm.reset(new geodesic::GeodesicAlgorithmParallelFWPExact(&mesh, threads, threads * 100));
        algorithm->Kmin = 6;
        algorithm->Kmax = 1e9;
        algorithm->step = 1;
        algorithm->binWidth = mesh.avg_edge() / whole_anisotropy(mesh);
    }

    void solve(unsigned source) { algorithm->propagate(source); }

    double distance(std::size_t vertex) { return mesh.vertices()[vertex].geodesic_distance(); }
};

int main(int argc, char** argv) {
    if (argc == 2) threads = std::max(1, std::atoi(argv[1]));
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return peer::serve<Solver>();
}
