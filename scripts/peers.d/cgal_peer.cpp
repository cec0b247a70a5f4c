// CGAL's Surface_mesh_shortest_path: Chen and Han's sequence tree with Xin and Wang's filter. A solve
// builds the tree; its answers are asked for afterwards. The protocol is that of
// bench-configs/PEERS.md.

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_shortest_path.h>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Traits = CGAL::Surface_mesh_shortest_path_traits<Kernel, Mesh>;
using ShortestPath = CGAL::Surface_mesh_shortest_path<Traits>;

// Reads `v x y z` and `f a b c`, as geobench writes them; false where the mesh cannot hold a face.
static bool load(const char* path, Mesh& mesh) {
    std::ifstream file(path);
    std::string line;
    while (std::getline(file, line)) {
        std::istringstream words(line);
        std::string kind;
        words >> kind;
        if (kind == "v") {
            double x, y, z;
            words >> x >> y >> z;
            mesh.add_vertex({x, y, z});
        } else if (kind == "f") {
            unsigned a, b, c;
            words >> a >> b >> c;
            const auto face = mesh.add_face(Mesh::Vertex_index(a - 1), Mesh::Vertex_index(b - 1),
                                            Mesh::Vertex_index(c - 1));
            if (face == Mesh::null_face()) return false;
        }
    }
    return true;
}

// Lets the system forget the peak of memory until now; false where it cannot.
static bool reset_peak() {
    std::ofstream file("/proc/self/clear_refs");
    file << "5" << std::flush;
    return file.good();
}

static std::string peak() {
    std::ifstream file("/proc/self/status");
    std::string line;
    while (std::getline(file, line))
        if (line.rfind("VmHWM:", 0) == 0) return std::to_string(1024 * std::stoll(line.substr(6)));
    return "null";
}

int main(int argc, char** argv) {
    if (argc != 4) {
        std::cerr << "usage: cgal_peer MODEL SOURCE OUTPUT\n";
        return 2;
    }
    Mesh mesh;
    if (!load(argv[1], mesh)) {
        std::cout << R"({"refused": "CGAL's Surface_mesh cannot hold all faces"})" << std::endl;
        return 0;
    }
    const Mesh::Vertex_index source(std::strtoul(argv[2], nullptr, 10));
    std::cout << R"({"ready": true})" << std::endl;
    std::string request;
    while (std::getline(std::cin, request)) {
        // Its tree stays after a solve, so that each has a solver of its own.
        ShortestPath solver(mesh);
        const bool known = reset_peak();
        const auto start = std::chrono::steady_clock::now();
        solver.add_source_point(source);
        solver.build_sequence_tree();
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
        const std::string bytes = known ? peak() : "null";
        std::FILE* output = std::fopen(argv[3], "w");
        if (output == nullptr) return 1;
        std::fputs("vertex,distance\n", output);
        for (const auto vertex : mesh.vertices()) {
            const double distance = solver.shortest_distance_to_source_points(vertex).first;
            if (distance < 0) // It reaches no source.
                std::fprintf(output, "%u,inf\n", unsigned(vertex));
            else
                std::fprintf(output, "%u,%.17g\n", unsigned(vertex), distance);
        }
        std::fclose(output);
        std::printf("{\"seconds\": %.9f, \"rss_peak_bytes\": %s}\n", seconds.count(), bytes.c_str());
        std::fflush(stdout);
    }
}
