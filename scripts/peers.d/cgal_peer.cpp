// CGAL's Surface_mesh_shortest_path: Chen and Han's sequence tree with Xin and Wang's filter. A solve
// builds the tree; its answers are asked for afterwards.

#include "session.hpp"

#include <cstdlib>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_shortest_path.h>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Traits = CGAL::Surface_mesh_shortest_path_traits<Kernel, Mesh>;

// The mesh; ends the program where CGAL's cannot hold a face.
static Mesh build(const peer::Model& model) {
    Mesh mesh;
    for (std::size_t i = 0; i < model.points.size(); i += 3)
        mesh.add_vertex({model.points[i], model.points[i + 1], model.points[i + 2]});
    for (std::size_t i = 0; i < model.faces.size(); i += 3) {
        const auto face = mesh.add_face(Mesh::Vertex_index(model.faces[i]), Mesh::Vertex_index(model.faces[i + 1]),
                                        Mesh::Vertex_index(model.faces[i + 2]));
        if (face == Mesh::null_face()) {
            std::printf("{\"refused\": \"CGAL's Surface_mesh cannot hold all faces\"}\n");
            std::exit(0);
        }
    }
    return mesh;
}

struct Solver {
    Mesh mesh;
    CGAL::Surface_mesh_shortest_path<Traits> paths;

    explicit Solver(const peer::Model& model) : mesh(build(model)), paths(mesh) {}

    void solve(unsigned source) {
        paths.add_source_point(Mesh::Vertex_index(source));
        paths.build_sequence_tree();
    }

    double distance(std::size_t vertex) {
        return paths.shortest_distance_to_source_points(Mesh::Vertex_index(vertex)).first;
    }
};

int main() { return peer::serve<Solver>(); }
